"""Protocols, plans and predictions print what they are in a few lines, not their arrays."""

import numpy as np
import pytest

import exoid
from exoid.experiments import Approach, Hold, bleex, healthy_gait
from exoid.experiments.excitation import MotionLimits, assess, plan_excitation
from exoid.experiments.excitation.limits import Clearance

LEG = exoid.load_leg("cuhk")


@pytest.fixture(scope="module")
def plan():
    return plan_excitation(LEG, noise=0.3, duration=10.0, tilts_deg=(-20.0, 20.0), poses=3, starts=1, criterion="d")


@pytest.mark.parametrize(
    ("thing", "text"),
    [
        (Hold(np.zeros((3, 1))), "Hold(3 joints, 1 rig)"),
        (Approach(np.zeros((2, 40)), np.ones((2, 40)), 4.0), "Approach(2 joints, 40 rigs in 4 s)"),
        (healthy_gait(period=10.0), "Harmonics(2 joints, 1 rig: 6 sinusoids up to 0.6 Hz)"),
        (
            bleex.static_sets(np.random.default_rng(0), 80),
            "StaticSets(ankle: 27 poses, knee: 23 poses, pairs: 42 poses, random: 80 poses)",
        ),
        (Clearance(np.zeros((2, 2)), ground=-0.9), "Clearance(2 points, ground -0.9 m, distance 0.05 m)"),
        (
            MotionLimits.of(LEG, margin=0.0, velocity=2.0, torque=(60.0, 25.0)),
            "MotionLimits(angle -30 to 110, -15 to 120 deg; velocity 2, 2 rad/s; acceleration inf, inf rad/s²; "
            "torque 60, 25 N·m; clearance None)",
        ),
    ],
)
def test_data_with_arrays_represent_themselves_in_one_line(thing, text):
    assert repr(thing) == text


@pytest.mark.slow
def test_a_plan_represents_itself_by_duration_poses_and_worst_parameter(plan):
    worst = int(np.argmax(plan.precision.relative))
    said = f"{100.0 * plan.precision.relative[worst]:.2g} % ({plan.precision.names[worst]})"
    assert repr(plan).startswith("Plan(cuhk.urdf: 10 s of motion and 6 poses; Precision(13 parameters after 10 s: ")
    for thing in (plan, plan.precision):
        assert said in repr(thing)
    assert repr(plan.motions[0]).endswith("5 s, torso -20°)")
    assert repr(plan.precision.scales).startswith("Scales(13 parameters, typical torque ")
    for thing in (plan, plan.precision, plan.precision.scales, *plan.motions):
        assert "array" not in repr(thing)
        assert "\n" not in repr(thing)
    assert len(str(plan).splitlines()) < 30


def test_an_assessment_counts_the_experiments_to_add(plan):
    found = assess(LEG, plan.recordings, noise=0.3)
    assert repr(found) == f"Assessment({found.precision!r}, {len(found.advice)} experiments to add)"
