"""``exoid export`` writes what ``Estimate.to_urdf`` writes, and says so."""

from __future__ import annotations

import json
import sys

import pytest

import exoid
from exoid import Leg
from exoid.cli import main
from exoid.identification import export_to_json


@pytest.fixture
def saved(tmp_path, monkeypatch):
    """An estimate in a file, in an empty folder that is the current one."""
    monkeypatch.chdir(tmp_path)
    data = exoid.datasets.bleex_swing()
    estimate = exoid.identify(data.leg, data.train)
    estimate.save("est.json")
    return estimate


def run(monkeypatch, capsys, *arguments):
    monkeypatch.setattr(sys, "argv", ["exoid", *arguments])
    with pytest.raises(SystemExit) as stop:
        main()
    return int(stop.value.code or 0), *capsys.readouterr()


def test_export_writes_a_urdf_and_a_sidecar_and_says_so(saved, tmp_path, monkeypatch, capsys):
    code, out, err = run(monkeypatch, capsys, "export", "est.json", "-o", "leg.urdf")
    assert (code, err) == (0, "")
    written = (tmp_path / "leg.urdf").read_text(), (tmp_path / "leg.exoid.json").read_text()
    expected = saved.to_urdf("leg.urdf")
    assert out == f"{expected}\n"
    assert written == (expected.urdf.read_text(), expected.sidecar.read_text())
    for word in ("leg.urdf", "leg.exoid.json", "Ia_knee", "offset_hip", "exactly the estimated parameters"):
        assert word in out
    again = Leg.from_urdf("leg.urdf", saved.joint_names)
    assert again.parameters == pytest.approx(saved.leg.parameters, rel=1e-12)


def test_export_as_json_is_the_sidecar(saved, tmp_path, monkeypatch, capsys):
    code, out, err = run(monkeypatch, capsys, "export", "est.json", "-o", "leg.urdf", "--json")
    assert (code, err) == (0, "")
    assert json.loads(out) == json.loads((tmp_path / "leg.exoid.json").read_text())
    assert json.loads(out) == json.loads(json.dumps(export_to_json(saved.to_urdf("leg.urdf"))))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("absent.json", "-o", "leg.urdf"), ("absent.json", "cannot be read")),
        (("est.json", "-o", "nowhere/leg.urdf"), ("nowhere/leg.urdf", "cannot be written")),
    ],
)
def test_bad_input_ends_in_one_line(saved, monkeypatch, capsys, arguments, words):
    code, out, err = run(monkeypatch, capsys, "export", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)
    for word in words:
        assert word in err


def test_the_output_must_be_named(saved, monkeypatch, capsys):
    assert run(monkeypatch, capsys, "export", "est.json")[0] == 2
