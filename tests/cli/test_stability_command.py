"""``exoid stability`` prints what exoid.lab.stability finds, draws it, and refuses what it cannot judge."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import numpy as np
import pytest
from controlled_legs import estimate_of
from doc_pages import Page

import exoid
from exoid import Coulomb, Offset, Stiffness, Viscous
from exoid.torques import TorqueModel

PAGE = Page.read("docs/stability.md")
QUICK = ("--duration", "0.5")

needs_page = pytest.mark.skipif(not PAGE.python, reason="needs the source tree")


@pytest.mark.slow
@needs_page
def test_the_tables_of_the_page_are_those_of_its_command(exoid_, tmp_path):
    """But for the regulation, whose runs are cut short here, and which is tested by itself."""
    (command,) = PAGE.commands
    assert shlex.split(command)[:3] == ["exoid", "stability", "cuhk"]
    regulation, margins, _ = PAGE.shown
    code, out, err = exoid_("stability", *shlex.split(command)[2:], *QUICK)
    assert code == 0
    assert "wrote stability.png" in err
    assert Path("stability.png").read_bytes().startswith(b"\x89PNG")
    assert margins in out
    assert regulation.splitlines()[1] in out


@pytest.mark.slow
@needs_page
def test_the_python_of_the_page_prints_what_it_shows(tmp_path):
    assert PAGE.run_python(tmp_path).endswith(PAGE.shown[-1])


def saved(path, **changes):
    """Write an estimate of CUHK-EXO with given values of its terms."""
    leg = exoid.load_leg("cuhk")
    model = TorqueModel(leg, (Coulomb(), Viscous(), Stiffness(degree=1, joints=("knee",)), Offset(joints=("hip",))))
    given = {"c0_hip": 1.445, "c0_knee": 0.593, "d_hip": 0.1, "d_knee": 0.2, "b1_knee": 0.5, "b0_knee": 0.1}
    own = dict(zip(leg.parameter_names, leg.parameters, strict=True))
    estimate_of(model, {**own, **given, "offset_hip": 0.3, **changes}).save(path)


def test_an_estimate_is_judged_with_its_own_friction_springs_and_offsets(exoid_, tmp_path):
    saved(tmp_path / "est.json")
    code, out, _ = exoid_("stability", str(tmp_path / "est.json"), *QUICK, "--kp", "40,50", "--json")
    data = json.loads(out)
    assert code == 0
    assert data["regulation"]["kd"] == pytest.approx([4.0, 5.0])
    band = np.deg2rad(data["regulation"]["runs"]["× 1"]["band_deg"])
    np.testing.assert_allclose(band, [1.445 / 40.0, 0.593 / 50.0], rtol=1e-6)
    assert data["regulation"]["runs"]["no friction"]["band_deg"] == [0.0, 0.0]
    assert np.shape(data["gain_margins"]["margins"]) == (8, 2)


def test_friction_that_is_negative_by_chance_is_taken_as_zero_and_said_to_be(exoid_, tmp_path):
    saved(tmp_path / "est.json", d_hip=-0.001)
    code, out, err = exoid_("stability", str(tmp_path / "est.json"), *QUICK, "--json")
    assert code == 0
    assert "d_hip = -0.001 ± 0.001 is taken as zero" in err
    assert json.loads(out)["regulation"]["runs"]["× 1"]["band_deg"][0] == pytest.approx(np.rad2deg(1.445 / 22.1))
