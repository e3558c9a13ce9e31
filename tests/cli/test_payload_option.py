"""``--payload`` and unknown torque constants on the command line."""

from dataclasses import replace

import numpy as np
import pytest
from swings import harmonics, with_payloads

import exoid
from exoid.leg.payload import Payload
from exoid.signals import Recording

LEG = exoid.load_leg("cuhk")
PAYLOAD = Payload("knee", 3.0, (0.0, 0.0, -0.3))
OPTION = "shank:3.0@0,0,-0.3"
DRIVES = "".join(
    f'[{joint}]\ntype = "motor"\ntorque_constant = "unknown"\nratio = 50.0\n\n' for joint in ("left_hip", "left_knee")
)


def write(path, seed, payloads, named=()):
    """Write a log of currents of a leg with payloads, which the file may name."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, 20.0, 0.01)
    w, phase = 2.0 * np.pi * rng.uniform(0.2, 1.2, (4, 2)), rng.uniform(0.0, 6.3, (4, 2))
    q, v, a = harmonics(t, 0.2, w.T, phase.T)
    tau = with_payloads(LEG, payloads).inverse_dynamics(q, v, a) + 0.8 * np.tanh(v / 0.01)
    current = tau / (50.0 * np.array([0.07, 0.05])) + 0.02 * rng.standard_normal(q.shape)
    log = Recording(t, q, current=current, joint_names=LEG.joint_names, payloads=named)
    log.to_csv(path)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write("light.csv", 1, ())
    write("heavy.csv", 2, (PAYLOAD,))
    write("named.csv", 2, (PAYLOAD,), (PAYLOAD,))
    (tmp_path / "drives.toml").write_text(DRIVES)
    return tmp_path


def identify(exoid_, *args):
    return exoid_("identify", "cuhk", *args, "--actuators", "drives.toml", "--no-check", "--json").data


@pytest.mark.parametrize("heavy", [("heavy.csv", "--payload", f"heavy.csv={OPTION}"), ("named.csv",)])
def test_a_payload_is_named_by_an_option_or_by_the_file(exoid_, folder, heavy):
    data = identify(exoid_, "light.csv", *heavy)
    assert data["shapes"]["values"]["kt_hip"] == pytest.approx(0.07, rel=0.01)
    assert data["shapes"]["values"]["kt_knee"] == pytest.approx(0.05, rel=0.01)
    assert data["values"]["X2"] == pytest.approx(LEG.parameters[3], rel=0.02)
    assert data["inputs"][1]["payloads"] == [str(replace(PAYLOAD, joint="shank" if "=" in heavy[-1] else "knee"))]
    assert "payloads" not in data["inputs"][0]


def test_without_a_payload_the_command_says_what_to_do(exoid_, folder):
    line = exoid_("identify", "cuhk", "light.csv", "--actuators", "drives.toml").refusal
    assert "nothing is known in N·m, so that kt_hip, kt_knee cannot be found" in line
    assert "--payload LOG=SEGMENT:KG@X,Y,Z" in line
