"""Scenarios on the ground: each run obeys the equation of motion, and moves as its name says."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from ground_machines import inverse_dynamics_residual, residual
from scipy.interpolate import CubicSpline

import exoid
from exoid.experiments.ground import bleex_machine, single_support, squats_and_shifts, swing, walking
from exoid.experiments.ground.planned_motion import Bearing, planned_motion
from exoid.experiments.ground.posture import planar_legs
from exoid.rig.ground import JointGains, simulate_on_ground

EXO, LEG = bleex_machine(), bleex_machine("left")
WEIGHT = 9.81 * sum(body.mass for body in EXO.leg.model.inertias)

RUNS = {
    "squats_and_shifts of one leg": lambda: squats_and_shifts(LEG, 3.0),
    "squats_and_shifts": lambda: squats_and_shifts(EXO, 3.0),
    "single_support": lambda: single_support(EXO, 3.0),
    "single_support of the right leg": lambda: single_support(EXO, 2.0, standing=1, seed=1),
    "swing": lambda: swing(EXO, 3.0),
    "walking": lambda: walking(EXO, 6.0),
}


@cache
def run_of(name):
    return RUNS[name]()


@pytest.fixture(scope="module", params=RUNS)
def named(request):
    return request.param, run_of(request.param)


@pytest.mark.nightly
def test_every_scenario_obeys_the_equation(named):
    name, run = named
    assert np.abs(residual(run)).max() < 1e-6, name  # of forces of up to 1000 N
    assert np.abs(inverse_dynamics_residual(run)).max() < 1e-6
    assert np.abs(run.v).max() > 0.2


@pytest.mark.slow
def test_forces_are_within_the_friction_cone_and_the_sole(named):
    _, run = named
    for link, foot in run.feet.items():
        loaded = foot.force[:, 2] > 1.0
        tangential = np.hypot(foot.force[:, 0], foot.force[:, 1])
        assert (tangential <= 0.8 * foot.force[:, 2] + 1e-6).all()
        arm = np.einsum("nij,ni->nj", foot.rotation, foot.centre_of_pressure - foot.position)[loaded]
        heel, toe = run.plant.soles[link].points[:, 0]
        assert (arm[:, 0] > heel - 0.005).all()  # the spheres have a radius of 5 mm
        assert (arm[:, 0] < toe + 0.005).all()


@pytest.mark.slow
def test_feet_stand_flat_without_slip(named):
    name, run = named
    if name == "walking":
        return
    standing = {"single_support": ["left_foot"], "single_support of the right leg": ["right_foot"], "swing": []}.get(
        name, list(run.feet)
    )
    for link, foot in run.feet.items():
        if link in standing:
            assert run.fixed(link).all()
            assert foot.slip.max() < 1e-3
            assert np.ptp(foot.position, axis=0).max() < 1e-3
        else:
            assert not foot.touching.any()
            assert not foot.force.any()


@pytest.mark.slow
def test_a_walking_machine_walks():
    walk = run_of("walking")
    assert walk.position[-1, 0] - walk.position[0, 0] > 2.5
    assert sum(foot.force[:, 2].mean() for foot in walk.feet.values()) > 0.7 * WEIGHT
    for link, foot in walk.feet.items():
        touching = foot.touching
        steps = np.count_nonzero(np.diff(touching.astype(int)) == 1)
        assert steps >= 4
        assert 0.4 < touching.mean() < 0.7
        assert 0.15 < walk.fixed(link).mean() < 0.5  # flat, between heel strike and heel off
        assert np.median(foot.slip[touching]) < 0.003
        assert foot.position[:, 2].max() > 0.2  # of the ankle in swing, 0.115 m while it stands
    both = np.all([foot.touching for foot in walk.feet.values()], axis=0)
    assert 0.02 < both.mean() < 0.3  # double support


@pytest.mark.slow
def test_a_swing_log_gives_the_true_parameters_of_a_leg(leg):
    """Base motion, filters and friction of the log are those that identification expects."""
    log = replace(swing(EXO, 12.0).recording(seed=1), wrenches={}, contacts={}).select(leg.joint_names)
    est = exoid.identify(leg, log, terms=(exoid.Coulomb(), exoid.Viscous(), exoid.Armature()))
    truth = dict(zip(leg.parameter_names, leg.parameters, strict=True))
    truth["J1"] += EXO.armature[0]  # the torso hardly turns, so that the rotor of the hip turns with the leg
    for symbol, values in (("c0", EXO.coulomb), ("d", EXO.viscous), ("Ia", EXO.armature)):
        truth |= {f"{symbol}_{label}": x for label, x in zip(leg.joint_labels, values, strict=False)}
    for name in est.names:
        assert abs(est[name].value - truth[name]) < 4.0 * est[name].std, name
    assert est["X1"].std < 0.003 * truth["X1"]
    assert est["J2"].std < 0.01 * truth["J2"]


@pytest.mark.slow
def test_on_ice_feet_slip_and_the_switches_do_not_tell():
    run = squats_and_shifts(bleex_machine(ground_friction=0.022), 6.0)
    share = np.mean([~run.fixed(link) for link in run.feet])
    assert 0.02 < share < 0.1
    assert np.abs(residual(run)).max() < 1e-6
    assert all(closed.all() for closed in run.recording().contacts.values())


def test_torques_of_the_plan_let_the_machine_follow_closely():
    """Feed-forward torques bear the machine, so that soft joints follow; without them it sinks."""
    time, legs = np.linspace(-1.0, 2.0, 301), planar_legs(EXO)
    squat = 0.04 * np.sin(4.0 * np.clip(time, 0.0, None))
    base = np.column_stack([0.06 + 0.0 * time, 0.88 + squat, np.full_like(time, -0.25)])
    q = np.hstack([leg.angles(base, np.zeros(len(time), dtype=complex), np.zeros(len(time))) for leg in legs])
    feet = {leg.foot: Bearing(np.ones_like(time), EXO.soles[leg.foot].centre) for leg in legs}
    plan = planned_motion(EXO, time, q, base, feet)
    gains = JointGains((400.0, 400.0, 400.0), (20.0, 20.0, 20.0))
    errors = []
    for motion in (plan, replace(plan, torque=np.zeros_like(plan.torque))):
        run = simulate_on_ground(EXO, motion, gains)
        errors.append(np.abs(run.q - CubicSpline(time, q)(run.time)).max())
    assert errors[0] < 0.02
    assert errors[1] > 0.1
