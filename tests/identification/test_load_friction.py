"""Friction under load, which the fit finds beside the load itself: recovery, errors, and what cannot be known."""

import numpy as np
import pytest
from swings import harmonics, log_of
from unchecked import identify

from exoid import Coulomb, ExoidError, Leg, Offset, Recording, Viscous
from exoid.signals import FiniteDifference, Poses
from exoid.torques import LoadFriction, Presliding, Stribeck

EXACT = FiniteDifference()
HIP, KNEE = 0.004, 0.0025
RICH = (
    Coulomb(presliding=HIP, joints=("hip",)),
    Coulomb(presliding=KNEE, joints=("knee",)),
    LoadFriction(split=True, presliding=KNEE, joints=("knee",)),
    Stribeck(velocity=0.25, presliding=KNEE, joints=("knee",)),
    Viscous(),
    Offset(),
)
TRUTH = {
    "c0_hip": 0.8,
    "c0_knee": 0.5,
    "mu_drive_knee": 0.10,
    "mu_back_knee": 0.06,
    "cs_knee": 0.4,
    "d_hip": 0.3,
    "d_knee": 0.1,
    "offset_hip": 0.2,
    "offset_knee": -0.1,
}


def motion_of(seconds=12.0, rate=200.0, seed=3):
    """Angles, velocities, accelerations of two joints."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * rate)) / rate
    omega = 2.0 * np.pi * np.array([0.15, 0.3, 0.45, 0.75, 1.05])
    size, phase = rng.uniform(0.1, 0.3, (2, 5)) / np.array([1, 1, 1.5, 2, 3]), rng.uniform(0, 2 * np.pi, (2, 5))
    return time, *harmonics(time, size, omega, phase)


def truth_torque(leg, q, v, a):
    """The torque written down again, with Pinocchio's inverse dynamics as the load."""
    t, rigid = TRUTH, leg.inverse_dynamics(q, v, a)
    hip, knee, load = Presliding(HIP).states(q[:, 0], v[:, 0]), Presliding(KNEE).states(q[:, 1], v[:, 1]), rigid[:, 1]
    share = 0.5 * (1.0 + knee * np.sign(load))
    size = t["c0_knee"] + np.abs(load) * (t["mu_drive_knee"] * share + t["mu_back_knee"] * (1.0 - share))
    size += t["cs_knee"] * np.exp(-((v[:, 1] / 0.25) ** 2))
    of_hip = t["c0_hip"] * hip + t["d_hip"] * v[:, 0] + t["offset_hip"]
    return rigid + np.column_stack([of_hip, size * knee + t["d_knee"] * v[:, 1] + t["offset_knee"]])


def recording_of(leg, noise=0.0, seed=0, torque=truth_torque, **motion):
    time, q, v, a = motion_of(**motion)
    tau = torque(leg, q, v, a)
    tau = tau + noise * np.random.default_rng(seed).standard_normal(tau.shape)
    return Recording(time=time, q=q, v=v, a=a, tau=tau, joint_names=leg.joint_names)


def test_without_noise_parameters_come_back_and_predict_another_motion(cuhk_leg):
    est = identify(cuhk_leg, recording_of(cuhk_leg), RICH, preparation=EXACT)
    for name, value in TRUTH.items():
        assert est.value(name) == pytest.approx(value, abs=1e-3), name
    np.testing.assert_allclose(est.values[: len(cuhk_leg.parameters)], cuhk_leg.parameters, atol=1e-3)
    assert not [warning for warning in est.warnings if "hardly tell apart" not in warning]
    _, q, v, a = motion_of(seed=11)
    np.testing.assert_allclose(est.torque(q, v, a), truth_torque(cuhk_leg, q, v, a), atol=2e-3)


@pytest.mark.parametrize("estimator", ["wls", "huber", "ols"])
def test_with_noise_they_come_back_within_their_errors(cuhk_leg, estimator):
    est = identify(cuhk_leg, recording_of(cuhk_leg, noise=0.05), RICH, estimator, preparation=EXACT)
    truth = np.array([*cuhk_leg.parameters, *(TRUTH[name] for name in est.names[len(cuhk_leg.parameters) :])])
    assert (np.abs(est.values - truth) < 4.5 * est.std).all()
    _, q, v, a = motion_of(seed=21)
    band, torque = est.torque_band(q, v, a, measured=False), truth_torque(cuhk_leg, q, v, a)
    assert ((band.lower <= torque) & (torque <= band.upper)).mean() > 0.8


def test_poses_stand_beside_recordings_and_what_is_known_is_kept(cuhk_leg):
    """At rest no bent contact is known of: friction is left out there, and gravity is still right."""
    q = np.random.default_rng(0).uniform(-0.5, 0.5, (20, 2))
    still = np.zeros_like(q)
    poses = Poses(q, cuhk_leg.inverse_dynamics(q, still, still) + np.array([0.2, -0.1]), cuhk_leg.joint_names)
    known = {"X1": float(cuhk_leg.parameters[0]), "mu_back_knee": TRUTH["mu_back_knee"]}
    est = identify(cuhk_leg, [recording_of(cuhk_leg), poses], RICH, preparation=EXACT, known=known, nonnegative=True)
    for name, value in known.items():
        assert est.value(name) == value
    assert est.value("mu_drive_knee") == pytest.approx(TRUTH["mu_drive_knee"], abs=1e-3)


def test_at_a_single_joint_driving_and_back_driving_are_not_told_apart_without_bending(cuhk_leg):
    """Half their difference scales the only rigid-body torque there is; with a sharp sign nothing else shows it."""
    knee = Leg.from_description(cuhk_leg.description, ("left_knee",))
    time, q, v, a = (x[..., :1] if x.ndim > 1 else x for x in motion_of())
    load = knee.inverse_dynamics(q, v, a)
    recording = log_of(knee, time, (q, v, a), 0.1 * load * np.sign(v * load), exact=True)
    with pytest.raises(ExoidError, match=r"mu_drive_knee.*cannot be told apart"):
        identify(knee, recording, (LoadFriction(split=True, smoothing=0.0),), preparation=EXACT)
    est = identify(knee, recording, (LoadFriction(smoothing=0.0),), preparation=EXACT)
    assert est.value("mu_knee") == pytest.approx(0.1, abs=1e-4)


def test_friction_of_a_load_that_is_not_there_is_refused_by_name(cuhk_leg):
    """No rigid body: no gravity, no inertia, nothing that gears would carry."""
    empty = recording_of(cuhk_leg, torque=lambda leg, q, v, a: 0.5 * np.tanh(v / 0.02))
    with pytest.raises(ExoidError, match="mu_hip, mu_knee left no trace"):
        identify(cuhk_leg, empty, (Coulomb(smoothing=0.02), LoadFriction(smoothing=0.02)), preparation=EXACT)
