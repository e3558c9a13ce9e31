"""Payloads as text, in logs and on the command line."""

from dataclasses import replace

import numpy as np
import pytest

from exoid.leg.payload import Payload
from exoid.signals import Recording, Recordings

PAYLOAD = Payload("knee", 3.0, (0.0, 0.01, -0.3), 0.05)


def recording(**changes):
    t = np.arange(50) / 50.0
    q = np.sin(np.outer(t, [1.0, 2.0]))
    return Recording(t, q, tau=np.cos(q), joint_names=("hip", "knee"), **changes)


@pytest.mark.parametrize("payload", [PAYLOAD, Payload("a:b@c", 0.1 + 0.2, (1e-3, -0.0, 1 / 3)), Payload("hip", 0.0)])
def test_text_and_payload_say_the_same(payload):
    assert Payload.from_text(str(payload)) == payload


def test_a_csv_file_and_parts_of_a_recording_keep_the_payloads(tmp_path):
    saved = recording(payloads=(PAYLOAD, Payload("hip", 1.0)))
    saved.to_csv(tmp_path / "heavy.csv")
    read = Recording.from_csv(tmp_path / "heavy.csv")
    assert read.payloads == saved.payloads
    assert np.array_equal(read.tau, saved.tau)
    assert Recording.from_file(tmp_path / "heavy.csv").payloads == saved.payloads
    assert "payloads: knee:3.0@0.0,0.01,-0.3:0.05, hip:1.0@0.0,0.0,0.0" in repr(read)
    (folder,) = Recordings.from_folder(tmp_path)
    parts = (folder, saved.slice(0, 20), saved.select(("hip",)), saved.segments([(0.0, 0.5)]))
    assert all(part.payloads == saved.payloads for part in parts)


@pytest.mark.parametrize("line", [str(PAYLOAD), "three kilograms"])
def test_given_payloads_go_before_a_line_of_the_file(line, tmp_path):
    path = tmp_path / "log.csv"
    recording().to_csv(path)
    path.write_text(f"# payload: {line}\n" + path.read_text())
    for payloads in ((replace(PAYLOAD, mass=2.0),), ()):
        assert Recording.from_csv(path, payloads=payloads).payloads == payloads
