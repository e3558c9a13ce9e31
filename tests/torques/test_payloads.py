"""Payloads in recordings: a known torque, equal to Pinocchio's, that moves to the side of the measured one."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from small_urdfs import spatial_arm
from swings import harmonics
from unchecked import identify

import exoid
from exoid.leg.model import configuration
from exoid.leg.payload import Payload
from exoid.signals import Poses, Recording
from exoid.torques import Coulomb, LoadFriction, Motion, Offset, Viscous
from exoid.torques.payloads import payload_torque

LOADS = (Payload("hip", 2.0, (0.05, 0.1, -0.2), 0.04), Payload("left_knee", 1.5, (-0.02, 0.0, -0.3)))
TERMS = (Coulomb(), Viscous(), Offset())
FRICTION = {"c0": 0.8, "d": 0.3, "offset": 0.1}


def difference(leg, loads, q, v, a):
    """RNEA with the bodies less RNEA without, by Pinocchio alone."""
    model, data = leg.model.copy(), leg.model.createData()
    for load in loads:
        name = next(n for n in leg.joint_names if n in (load.joint, f"left_{load.joint}"))
        inertia = pin.Inertia(load.mass, np.array(load.position), load.mass * load.gyration**2 * np.eye(3))
        model.appendBodyToJoint(model.getJointId(name), inertia, pin.SE3.Identity())
    loaded = model.createData()
    rows = zip(configuration(leg.model, q), v, a, strict=True)
    return np.array([pin.rnea(model, loaded, *row) - pin.rnea(leg.model, data, *row) for row in rows])


@pytest.mark.parametrize("name", ["bleex", "cuhk", "arm"])
def test_the_torque_of_payloads_is_pinocchios(name):
    """Also of a robot that is no planar chain, to rounding."""
    leg = spatial_arm(("hip", "left_knee", "wrist")) if name == "arm" else exoid.load_leg(name)
    q, v, a = np.random.default_rng(0).uniform(-2.0, 2.0, (3, 20, len(leg.joint_names)))
    expected = difference(leg, LOADS, q, v, a)
    found = payload_torque(leg, LOADS, Motion(q, v, a))
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def log(leg, payloads=(), noise=0.0, seed=0, seconds=30.0):
    """Log of a leg with friction that carries payloads."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, seconds, 0.01)
    n = len(leg.joint_names)
    frequencies, phases = rng.uniform(0.2, 1.2, (4, n)), rng.uniform(0.0, 6.3, (4, n))
    q, v, a = harmonics(t, 0.25, 2.0 * np.pi * frequencies.T, phases.T)
    q = q - 0.3
    model = exoid.torques.TorqueModel(leg, TERMS)
    values = [*leg.parameters, *(FRICTION[name.partition("_")[0]] for name in model.names[len(leg.parameters) :])]
    tau = model.regressor(q, v, a) @ values + difference(leg, payloads, q, v, a)
    tau += noise * rng.standard_normal(tau.shape)
    return Recording(t, q, tau=tau, joint_names=leg.joint_names, payloads=payloads)


HEAVY = (Payload("knee", 3.0, (0.0, 0.0, -0.3)),)


def test_recordings_with_different_payloads_give_the_unloaded_leg():
    leg = exoid.load_leg("cuhk")
    recordings = [log(leg, seed=1), log(leg, HEAVY, seed=2), log(leg, LOADS, seed=3)]
    found = identify(leg, recordings, TERMS)
    np.testing.assert_allclose(found.values[: len(leg.parameters)], leg.parameters, rtol=1e-3)
    ignored = identify(leg, [replace(one, payloads=()) for one in recordings], TERMS)
    assert abs(ignored.value("X2") / leg.parameters[3] - 1.0) > 0.1
    assert found.inputs[1].payloads == ("knee:3.0@0.0,0.0,-0.3",)


def test_validation_and_prediction_include_the_payload():
    leg = exoid.load_leg("cuhk")
    estimate = identify(leg, log(leg, noise=0.1), TERMS)
    heavy = log(leg, HEAVY, noise=0.1, seed=4)
    validation = exoid.validate(estimate, heavy)
    assert validation.verdict == "predicts"
    assert (validation.nrmse < 0.03).all()
    middle = slice(200, -200)  # away from the ends, where both fade
    time = np.interp(validation.time, heavy.time, heavy.tau[:, 0])[middle]
    assert np.corrcoef(validation.measured[middle, 0], time)[0, 1] > 0.99
    assert exoid.validate(estimate, replace(heavy, payloads=())).nrmse.max() > 0.1
    q, v, a = heavy.q[:5], np.zeros((5, 2)), np.zeros((5, 2))
    added = estimate.torque(q, v, a, payloads=HEAVY) - estimate.torque(q, v, a)
    np.testing.assert_allclose(added, difference(leg, HEAVY, q, v, a), atol=1e-12)


def test_checks_of_a_log_with_a_payload_find_nothing():
    leg = exoid.load_leg("cuhk")
    assert not exoid.check(leg, [log(leg, noise=0.1), log(leg, HEAVY, noise=0.1, seed=5)], TERMS)
    wrong = replace(log(leg, HEAVY, noise=0.1, seed=5), payloads=(replace(HEAVY[0], mass=1.0),))
    assert exoid.check(leg, [log(leg, noise=0.1), wrong], TERMS)


def test_poses_with_a_payload():
    leg = exoid.load_leg("cuhk")
    q = np.random.default_rng(3).uniform(-0.8, 0.8, (12, 2))
    still = np.zeros_like(q)
    tau = leg.gravity(q) + difference(leg, HEAVY, q, still, still)
    poses = Poses(q, tau, leg.joint_names, payloads=HEAVY)
    assert "payloads: knee:3.0@0.0,0.0,-0.3" in repr(poses)
    assert poses.take(slice(3)).payloads == poses.select(("left_knee",)).payloads == HEAVY
    known = dict(zip(leg.parameter_names, leg.parameters, strict=True))
    found = identify(leg, poses, (), known={name: known[name] for name in ("J1", "J2")})
    np.testing.assert_allclose(found.values, leg.parameters, rtol=1e-9)


@pytest.mark.parametrize("estimator", ["huber", "ols"])
def test_other_estimators_take_payloads(estimator):
    leg = exoid.load_leg("cuhk")
    found = identify(leg, log(leg, HEAVY, noise=0.1), TERMS, estimator=estimator)
    np.testing.assert_allclose(found.value("X2"), leg.parameters[3], rtol=0.02)


def test_friction_under_load_carries_the_payload():
    """Friction of a gear is proportional to all torque that it carries."""
    leg, terms = exoid.load_leg("cuhk"), (LoadFriction(), Viscous())
    model = exoid.torques.TorqueModel(leg, terms)
    values = np.array([*leg.parameters, 0.15, 0.10, 0.3, 0.2])
    logs = []
    for seed, payloads in ((1, ()), (2, HEAVY)):
        plain = log(leg, payloads, seed=seed)
        motion = model.motion(*exact(plain), payloads=payloads)
        tau = model.columns(motion).transpose(2, 1, 0) @ values
        logs.append(replace(plain, tau=tau if motion.payload is None else tau + motion.payload))
    found = identify(leg, logs, terms)
    assert found.value("mu_knee") == pytest.approx(0.10, rel=0.02)
    assert found.value("X2") == pytest.approx(leg.parameters[3], rel=0.01)


def exact(recording):
    """Motion as a preparation derives it, smooth enough to be taken for true."""
    q, v, a, _ = exoid.signals.ZeroPhase().kinematics(recording)
    return q, v, a


@pytest.mark.parametrize("preparation", ["finite-difference", "smoothed"])
def test_every_preparation_takes_payloads_out(preparation):
    leg = exoid.load_leg("cuhk")
    found = identify(leg, log(leg, HEAVY), TERMS, preparation=preparation)
    bare = identify(leg, log(leg), TERMS, preparation=preparation)
    np.testing.assert_allclose(found.values, bare.values, rtol=2e-2, atol=2e-3)
