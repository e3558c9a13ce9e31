"""A spring between the encoder of a joint and its link: what names it, and what takes its bias out."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import exoid
from exoid.actuators import SeriesElastic

from .machine import draw
from .population import elastic, inside
from .simulate import simulate

pytestmark = pytest.mark.slow

JOINT, STIFFNESS = 1, 52.4
"""Second joint of machine 19, which has motor currents, and its spring [N·m/rad]."""


@cache
def behind_a_spring():
    machine = draw(19)
    return machine, machine.leg(), elastic(machine, JOINT)


def named(estimate):
    return [one for one in estimate.findings if one.kind == "elastic-joint"]


def test_an_elastic_joint_is_named_with_its_stiffness_and_what_it_moves():
    machine, leg, log = behind_a_spring()
    estimate = exoid.identify(leg, log.recording)
    (finding,) = named(estimate)
    assert finding.joint == machine.names[JOINT]
    assert finding.value == pytest.approx(STIFFNESS, rel=0.1)
    wrong = np.array(leg.parameter_names)[~inside(machine, estimate)]
    assert len(wrong) > 0
    assert {*wrong} <= {*finding.parameters}


def test_a_link_that_rings_on_a_spring_names_it():
    """The second of two joints, of 168 N·m/rad: its ringing is half of the residual, and hardly shows otherwise."""
    log = elastic(draw(43), 1)
    (finding,) = (one for one in named(exoid.identify(draw(43).leg(), log.recording)) if one.joint == "j2")
    assert finding.value == pytest.approx(168.0, rel=0.2)


def test_torque_over_stiffness_is_what_its_angle_lacks():
    machine, leg, log = behind_a_spring()
    (finding,) = named(exoid.identify(leg, log.recording))
    q = log.recording.q.copy()
    q[:, JOINT] -= log.recording.tau[:, JOINT] / finding.value
    estimate = exoid.identify(leg, replace(log.recording, q=q))
    assert not named(estimate)
    assert inside(machine, estimate).all()


def test_two_encoders_and_the_spring_measure_the_torque():
    machine, leg, log = behind_a_spring()
    q, tau, motor = log.recording.q.copy(), log.recording.tau.copy(), np.full(log.truth.q.shape, np.nan)
    motor[:, JOINT], q[:, JOINT], tau[:, JOINT] = q[:, JOINT], log.truth.q[:, JOINT], np.nan
    both = replace(log.recording, q=q, tau=tau, motor_angle=motor)
    estimate = exoid.identify(leg, both, actuators={machine.names[JOINT]: SeriesElastic(STIFFNESS)})
    assert not named(estimate)
    assert inside(machine, estimate).all()


@pytest.mark.parametrize("seed", [19, *(pytest.param(k, marks=pytest.mark.nightly) for k in (8, 59))])
def test_a_rigid_machine_has_no_such_finding(seed):
    machine = draw(seed)
    assert not named(exoid.identify(machine.leg(), simulate(machine, 12.0).recording))
