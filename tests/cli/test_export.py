"""``exoid export`` writes what ``Estimate.to_urdf`` writes, and says so."""

from __future__ import annotations

import json
import sys

import pytest

import exoid
from exoid import Leg
from exoid.cli import main


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
    assert json.loads(out) == json.loads(json.dumps(saved.to_urdf("leg.urdf").to_json()))


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


def test_export_prints_masses_beside_those_of_the_urdf(saved, monkeypatch, capsys):
    _, out, _ = run(monkeypatch, capsys, "export", "est.json", "-o", "leg.urdf")
    export = saved.to_urdf("again.urdf")
    for mass in export.masses:
        assert f"{mass.before:.4g}" in out
        assert f"{mass.after:.4g}" in out


def test_export_refuses_masses_beyond_a_factor_and_allows_them_by_one(saved, tmp_path, monkeypatch, capsys):
    tight = ("--mass-factor", "1.0001")
    code, out, err = run(monkeypatch, capsys, "export", "est.json", "-o", "leg.urdf", *tight)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "would weigh" in err
    assert "--mass-factor" in err
    assert [path.name for path in tmp_path.iterdir()] == ["est.json"]
    wide = ("--mass-factor", "inf", "--pull", "10")
    assert run(monkeypatch, capsys, "export", "est.json", "-o", "leg.urdf", *wide)[0] == 0
    lifted = json.loads((tmp_path / "leg.exoid.json").read_text())["lift"]
    assert (lifted["mass_factor"], lifted["pull"]) == (None, 10.0)


def test_the_output_must_be_named(saved, monkeypatch, capsys):
    assert run(monkeypatch, capsys, "export", "est.json")[0] == 2


def test_export_writes_c_and_says_so(saved, tmp_path, monkeypatch, capsys):
    code, out, err = run(monkeypatch, capsys, "export", "est.json", "--c", "leg.c")
    assert (code, err) == (0, "")
    text = (tmp_path / "leg.c").read_text()
    expected = saved.to_c("leg.c")
    assert (text, out) == (expected.text, f"{expected}\n")
    assert "double leg_real" in text
    assert not (tmp_path / "leg.urdf").exists()


def test_export_of_c_in_single_precision_as_json(saved, tmp_path, monkeypatch, capsys):
    code, out, err = run(monkeypatch, capsys, "export", "est.json", "--c", "leg.c", "--precision", "float", "--json")
    assert (code, err) == (0, "")
    assert json.loads(out) == json.loads(json.dumps(saved.to_c("leg.c", precision="float").to_json()))
    assert "float leg_real" in (tmp_path / "leg.c").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("-o", "leg.urdf", "--c", "leg.c"), ("one file", "give one of -o LEG.URDF, --c LEG.C and --mjcf LEG.XML")),
        (("-o", "leg.urdf", "--precision", "float"), ("--precision has no effect",)),
        (("--c", "leg.c", "--mass-factor", "3"), ("--mass-factor and --pull have no effect",)),
        (("--c", "leg.c", "--pull", "3"), ("--mass-factor and --pull have no effect",)),
        (("-o", "leg.urdf", "--mass-factor", "0.5"), ("mass factor 0.5", "out of range")),
        (("-o", "leg.urdf", "--pull", "-1"), ("pull -1.0", "out of range")),
        (("--c", "leg.c", "--precision", "half"), ("no precision 'half'", "double or float")),
        (("--c", "nowhere/leg.c"), ("nowhere/leg.c", "cannot be written")),
    ],
)
def test_options_that_make_no_sense_together_write_nothing(saved, tmp_path, monkeypatch, capsys, arguments, words):
    code, out, err = run(monkeypatch, capsys, "export", "est.json", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)
    for word in words:
        assert word in err
    assert [path.name for path in tmp_path.iterdir()] == ["est.json"]
