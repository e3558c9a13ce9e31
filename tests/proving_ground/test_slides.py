"""Prismatic joints among others: friction that is sharp in m/s is found as that in rad/s is, seeds to report."""

from __future__ import annotations

from dataclasses import replace

import pytest

import exoid

from .friction import Friction
from .machine import draw, with_slides
from .simulate import simulate


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1003, *(pytest.param(k, marks=pytest.mark.nightly) for k in (1000, 1004, 1007))])
def test_dry_friction_of_slides_is_that_of_mujoco(seed):
    machine = draw(seed).with_sensing(torque="current", rate=500, bits=20, noise=0.005, colour="white", delay=0.0)
    sharp = [Friction("sharp", "sharp", j.friction.c0, j.friction.d) for j in machine.joints]
    joints = [replace(j, friction=f, spring=0.0) for j, f in zip(machine.joints, sharp, strict=True)]
    machine = with_slides(replace(machine, joints=tuple(joints), floating=False))
    log = simulate(machine, 8.0).recording
    estimate = exoid.identify(machine.leg(), log)
    assert {*estimate.model.torque_unit.split(" or ")} == {"N" if j.slides else "N·m" for j in machine.joints}
    for joint in machine.joints:
        if joint.slides and not joint.passive:
            assert estimate[f"c0_{joint.name}"].value == pytest.approx(joint.friction.c0, rel=0.15), str(machine)
