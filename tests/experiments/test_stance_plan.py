"""Plans of squats, shifts and leg swings: limits, predicted precision, what is missing, and a rig that follows."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from standing import mirrored, standing

import exoid
from exoid import BaseMotion, Coulomb, ExoidError, Viscous
from exoid.experiments.excitation import plan_stance, run_stance
from exoid.experiments.excitation.precision import information_of
from exoid.experiments.excitation.scales import TorqueNoise
from exoid.experiments.ground.posture import planar_legs
from exoid.experiments.ground.protocol import CLEARANCE, FRICTION, KNEE, LOAD, PITCH, SOLE_MARGIN
from exoid.leg.torso import TorsoMotion, base_kinematics
from exoid.torques import TorqueModel
from exoid.torques.contacts.standing_base import standing_base

pytestmark = pytest.mark.slow

EXO = exoid.load_exo("bleex", base="floating")
COUNT = len(EXO.parameters)
STD = (0.5, 0.4, 0.2) * 2
HEEL, TOE, SOLE_HEIGHT = -0.075, 0.13, -0.115


@pytest.fixture(scope="module")
def plan():
    return plan_stance(EXO, (), feet=("left", "right"), noise=STD, duration=20.0)


def test_limits_hold_by_inverse_dynamics_and_the_contact_jacobian(plan):
    limits, weight = EXO.limits, 9.81 * EXO.parameters[0]
    for k, (log, motion) in enumerate(zip(plan.recordings, plan.motions, strict=True)):
        (foot,) = motion.feet
        rows = EXO.inverse_dynamics(log.q, log.v, log.a, base_of(plan, k))
        J = EXO.contact_jacobian(log.q, foot)
        wrench = np.linalg.solve(J[..., :3].transpose(0, 2, 1), rows[:, :3, None])[..., 0]
        forward, up, moment = wrench.T
        torque = rows[:, 3:] - np.einsum("nki,nk->ni", J[..., 3:], wrench)
        np.testing.assert_allclose(log.tau, torque, atol=1e-6)
        pressure = (moment + SOLE_HEIGHT * forward) / up
        assert ((log.q >= limits.lower) & (log.q <= limits.upper)).all()
        assert (np.abs(log.v) <= limits.velocity).all()
        assert log.q[:, [1, 4]].max() <= -KNEE
        assert (np.abs(torque) <= limits.effort).all()
        assert (np.abs(forward) <= FRICTION * up).all()
        assert LOAD[0] * weight <= up.min() <= up.max() <= LOAD[1] * weight
        # the moment is about -y: forces in front of the ankle make it positive
        assert HEEL + SOLE_MARGIN <= pressure.min() <= pressure.max() <= TOE - SOLE_MARGIN
        pose = motion.motion.base
        assert PITCH[0] <= pose[:, 2].min() <= pose[:, 2].max() <= PITCH[1]
        for leg in planar_legs(plan.plant):
            height = leg.points(pose, motion.motion.q).imag
            if leg.foot == foot:
                np.testing.assert_allclose(height, 0.0, atol=1e-9)
            else:
                assert height.min() >= CLEARANCE
        for part in (log.v, log.a):  # from rest to rest
            assert np.abs(part[[0, -1]]).max() < 0.01 * np.abs(part).max()


def base_of(plan, number):
    """Motion of the torso of a plan at the times of its log."""
    motion, time = plan.motions[number].motion, plan.recordings[number].time
    base = make_interp_spline(motion.time, motion.base, 7)
    pose, rate, change = (base(time, order) for order in range(3))
    torso = TorsoMotion(pose[:, 2], rate[:, 2], change[:, 2], change[:, :2])  # about the origin of the root link
    return base_kinematics(torso, len(time), plan.plant.plane, np.zeros(3))


def assert_scatter_is_predicted(logs, model, precision, seeds=8):
    """Errors of logs with torque noise; 8 seeds of one parameter scatter by a quarter alone."""
    errors = []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        noisy = [replace(log, tau=log.tau + STD * rng.standard_normal(log.tau.shape)) for log in logs]
        found = exoid.identify(EXO, noisy, terms=model.terms)
        errors.append(found.values[:COUNT] - EXO.parameters)
    relative = np.array(errors) / precision.std[:COUNT]
    kinds = np.array([name[0] for name in EXO.parameter_names])
    for kind in "XYJ":
        assert np.sqrt(np.mean(relative[:, kinds == kind] ** 2)) == pytest.approx(1.0, abs=0.3)
    assert np.sqrt(np.mean(relative**2)) == pytest.approx(1.0, abs=0.2)


@pytest.mark.nightly
def test_the_predicted_precision_is_the_scatter_of_identifications(plan):
    logs = []
    for k, log in enumerate(plan.recordings):  # with an exact IMU, which the prediction assumes
        base = base_of(plan, k)
        logs.append(replace(log, base=BaseMotion(base.angular_velocity, base.specific_force)))
    assert_scatter_is_predicted(logs, plan.model, plan.precision)


@pytest.mark.nightly
def test_the_precision_of_any_stance_is_the_scatter_of_identifications(plan):
    """Staggered feet and other motions than planned ones, friction beside the rigid bodies."""
    model = TorqueModel(EXO, (Coulomb(smoothing=0.05), Viscous()))
    each = [standing(EXO, feet, seed=k, seconds=20.0) for k, feet in enumerate(("both", "left", "left"))]
    logs = []
    for log in (each[0].recording, each[1].recording, mirrored(each[2]).recording):
        base = standing_base(EXO, log, next(link for link, rests in log.contacts.items() if rests.all()))
        logs.append(replace(log, base=BaseMotion(base.angular_velocity, base.specific_force)))
    ones = np.ones(len(model.names))
    expected = np.append(EXO.parameters, np.zeros(len(ones) - COUNT))
    scales = plan.precision.scales._replace(expected=expected, parameter_scale=ones)
    assert_scatter_is_predicted(logs, model, information_of(model, logs, TorqueNoise(STD)).precision(model, scales))


@pytest.mark.nightly
def test_a_machine_follows_a_plan_on_flat_feet_and_is_identified(plan):
    """On one foot without a hand rail; an IMU tells how the torso moves on soles that give way a little."""
    pytest.importorskip("mujoco")
    from exoid.rig.ground import GroundSensors  # noqa: PLC0415

    logs = []
    for k, (one, run) in enumerate(zip(plan.motions, run_stance(plan), strict=True)):
        (other,) = {*run.feet} - {*one.feet}
        assert run.fixed(one.feet[0]).all()
        assert not run.feet[other].touching.any()
        sensors = GroundSensors(torque_noise=STD[:3], angle_noise=1e-5)
        logs.append(run.recording(sensors, seed=k, wrenches=()))
    found = exoid.identify(EXO, logs, terms=())
    error = (found.values - EXO.parameters) / found.std
    assert np.sqrt(np.mean(error**2)) < 1.7
    assert found["M"].value == pytest.approx(EXO.parameters[0], rel=0.002)


def test_two_feet_in_turn_determine_torso_and_legs(plan):
    assert plan.precision.identifiability == ("well",) * len(plan.model.names)
    assert "every parameter is determined well" in str(plan)


def test_hips_that_are_apart_are_planned_on_both_feet_too():
    description = EXO.description
    hip = description.text.replace('xyz="0.0 -0.2 0.0"', 'xyz="0.05 -0.2 0.0"')  # the right hip, 5 cm in front
    uneven = exoid.Leg.from_description(replace(description, text=hip), base="floating")
    found = plan_stance(uneven, (), feet=("both", "left", "right"), noise=STD, duration=30.0)
    assert found.precision.identifiability == ("well",) * len(found.model.names)
    q = found.recordings[0].q
    assert np.abs(q[:, :3] - q[:, 3:]).max() > 0.05  # not the same posture


def test_one_foot_names_what_cannot_be_told_apart():
    found = plan_stance(EXO, (), feet=("left",), noise=STD, duration=10.0)
    grades = dict(zip(found.precision.names, found.precision.identifiability, strict=True))
    loose = {name for name, grade in grades.items() if grade == "not"}
    assert {"J0", "J1_left", "J2_left", "M"} <= loose
    assert {"X0", "X1_right", "J1_right"}.isdisjoint(loose)
    assert "exoid plan --supports says on which links" in str(found)
    with pytest.raises(ExoidError, match="J0"):
        exoid.identify(EXO, found.recordings, terms=())
