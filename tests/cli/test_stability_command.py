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


@pytest.mark.slow
@pytest.mark.skipif(not PAGE.commands, reason="needs the source tree")
def test_the_table_of_the_page_is_that_of_its_command(exoid_, tmp_path):
    (command,) = PAGE.commands
    (margins,) = PAGE.shown
    code, out, err = exoid_(*shlex.split(command)[1:])
    assert code == 0
    assert "wrote stability.png" in err
    assert Path("stability.png").read_bytes().startswith(b"\x89PNG")
    assert margins in out


def saved(path, **changes):
    """Write an estimate of CUHK-EXO with given values of its terms."""
    leg = exoid.load_leg("cuhk")
    model = TorqueModel(leg, (Coulomb(), Viscous(), Stiffness(degree=1, joints=("knee",)), Offset(joints=("hip",))))
    given = {"c0_hip": 1.445, "c0_knee": 0.593, "d_hip": 0.1, "d_knee": 0.2, "b1_knee": 0.5, "b0_knee": 0.1}
    own = dict(zip(leg.parameter_names, leg.parameters, strict=True))
    estimate_of(model, {**own, **given, "offset_hip": 0.3, **changes}).save(path)


def test_an_estimate_is_judged_with_friction_that_is_negative_by_chance_as_zero(exoid_, tmp_path):
    saved(tmp_path / "est.json", d_hip=-0.001)
    code, out, err = exoid_("stability", str(tmp_path / "est.json"), "--kp", "40,50", "--json")
    assert code == 0
    assert np.shape(json.loads(out)["gain_margins"]["margins"]) == (8, 2)
    assert "d_hip = -0.001 ± 0.001 is taken as zero" in err
