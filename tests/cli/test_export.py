"""``exoid export`` writes what ``Estimate.to_urdf`` writes, and says so."""

import json
from dataclasses import replace

import pytest

from exoid import Leg
from exoid.estimate.finding import Finding


def test_export_writes_a_urdf_and_says_so(saved, tmp_path, exoid_):
    code, out, err = exoid_("export", "est.json", "-o", "leg.urdf")
    assert (code, err) == (0, "")
    written = (tmp_path / "leg.urdf").read_text()
    expected = saved.to_urdf("leg.urdf")
    assert out == f"{expected}\n"
    assert written == expected.urdf.read_text()
    for word in ("leg.urdf", "Ia_knee", "offset_hip", "exactly the estimated parameters"):
        assert word in out
    again = Leg.from_urdf("leg.urdf", saved.joint_names)
    assert again.parameters == pytest.approx(saved.leg.parameters, rel=1e-12)


def test_errors_of_an_estimate_are_repeated_by_what_uses_it(saved, exoid_):
    wrong = Finding("torque-sign", saved.joint_names[1], -1.0, "1", "error", "the other sign fits", "negate it")
    replace(saved, findings=(wrong,)).save("wrong.json")
    for verb in (("export", "wrong.json", "--c", "leg.c"), ("compare", "wrong.json", "est.json")):
        _, _, err = exoid_(*verb)
        assert f"wrong.json: {wrong}" in err


def test_export_as_json_says_what_is_in_the_file(saved, exoid_):
    done = exoid_("export", "est.json", "-o", "leg.urdf", "--json")
    assert (done.data, done.err) == (json.loads(json.dumps(saved.to_urdf("leg.urdf").to_json())), "")


def test_export_refuses_masses_beyond_a_factor_and_allows_them_by_one(saved, tmp_path, exoid_):
    tight = ("--mass-factor", "1.0001")
    line = exoid_("export", "est.json", "-o", "leg.urdf", *tight).refusal
    assert "would weigh" in line
    assert "--mass-factor" in line
    assert [path.name for path in tmp_path.iterdir()] == ["est.json"]
    wide = ("--mass-factor", "inf", "--pull", "10")
    assert exoid_("export", "est.json", "-o", "leg.urdf", *wide)[0] == 0


def test_export_writes_c_and_says_so(saved, tmp_path, exoid_):
    code, out, err = exoid_("export", "est.json", "--c", "leg.c")
    assert (code, err) == (0, "")
    text = (tmp_path / "leg.c").read_text()
    expected = saved.to_c("leg.c")
    assert (text, out) == (expected.text, f"{expected}\n")
    assert "double leg_real" in text
    assert not (tmp_path / "leg.urdf").exists()
