"""Friction with shapes that must be found: recovery, honest errors, files, and what cannot be known."""

import dataclasses
import json

import numpy as np
import pytest
from swings import harmonics
from unchecked import identify

import exoid
from exoid import Coulomb, Estimate, ExoidError, Leg, Offset, Recording, Viscous
from exoid.signals import FiniteDifference, Poses
from exoid.torques import LoadFriction, NonlinearParameter, Stribeck

EXACT = FiniteDifference()
DELTA, VS = NonlinearParameter(1e-3, 1e-5, 0.05), NonlinearParameter(0.1, 0.01, 1.0)
RICH = (
    Coulomb(presliding=DELTA),
    LoadFriction(split=True, presliding=DELTA, joints=("knee",)),
    Stribeck(velocity=VS, presliding=DELTA, joints=("knee",)),
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
SHAPES = {"delta_hip": 0.004, "delta_knee": 0.0025, "vs_knee": 0.25}


@pytest.fixture(scope="module")
def leg():
    return exoid.load_leg("cuhk")


def motion_of(seconds=12.0, rate=200.0, seed=3):
    """Angles, velocities, accelerations of two joints."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * rate)) / rate
    omega = 2.0 * np.pi * np.array([0.15, 0.3, 0.45, 0.75, 1.05])
    size, phase = rng.uniform(0.1, 0.3, (2, 5)) / np.array([1, 1, 1.5, 2, 3]), rng.uniform(0, 2 * np.pi, (2, 5))
    return time, *harmonics(time, size, omega, phase)


def bent(q, v, length):
    """Dahl's state, sample by sample."""
    z = np.empty(len(q))
    z[0] = np.sign(v[0])
    for k in range(1, len(q)):
        s = np.sign(q[k] - q[k - 1])
        z[k] = s + (z[k - 1] - s) * np.exp(-abs(q[k] - q[k - 1]) / length)
    return z


def truth_torque(leg, q, v, a):
    """The torque written down again, with Pinocchio's inverse dynamics as the load."""
    t, s = TRUTH, SHAPES
    rigid = leg.inverse_dynamics(q, v, a)
    hip, knee = bent(q[:, 0], v[:, 0], s["delta_hip"]), bent(q[:, 1], v[:, 1], s["delta_knee"])
    load = rigid[:, 1]
    share = 0.5 * (1.0 + knee * np.sign(load))
    size = t["c0_knee"] + np.abs(load) * (t["mu_drive_knee"] * share + t["mu_back_knee"] * (1.0 - share))
    size += t["cs_knee"] * np.exp(-((v[:, 1] / s["vs_knee"]) ** 2))
    friction = np.column_stack(
        [
            t["c0_hip"] * hip + t["d_hip"] * v[:, 0] + t["offset_hip"],
            size * knee + t["d_knee"] * v[:, 1] + t["offset_knee"],
        ]
    )
    return rigid + friction


def recording_of(leg, noise=0.0, seed=0, **motion):
    time, q, v, a = motion_of(**motion)
    tau = truth_torque(leg, q, v, a)
    tau = tau + noise * np.random.default_rng(seed).standard_normal(tau.shape)
    return Recording(time=time, q=q, v=v, a=a, tau=tau, joint_names=leg.joint_names)


@pytest.fixture(scope="module")
def estimate(leg):
    return exoid.identify(leg, recording_of(leg, noise=0.05), RICH, preparation=EXACT)


def test_without_noise_parameters_and_settings_come_back(leg):
    est = identify(leg, recording_of(leg), RICH, preparation=EXACT)
    assert est.nonlinear.names == tuple(SHAPES)
    np.testing.assert_allclose(est.nonlinear.values, list(SHAPES.values()), rtol=1e-4)
    for name, value in TRUTH.items():
        assert est.value(name) == pytest.approx(value, abs=1e-3), name
    np.testing.assert_allclose(est.values[: len(leg.parameters)], leg.parameters, atol=1e-3)
    assert not [warning for warning in est.warnings if "hardly tell apart" not in warning]


@pytest.mark.parametrize("estimator", ["wls", "huber", "ols"])
def test_with_noise_they_come_back_within_their_errors(leg, estimator):
    est = identify(leg, recording_of(leg, noise=0.05), RICH, estimator, preparation=EXACT)
    truth = np.array([*leg.parameters, *(TRUTH[name] for name in est.names[len(leg.parameters) :])])
    assert (np.abs(est.values - truth) < 4.5 * est.std).all()
    assert (np.abs(est.nonlinear.values - list(SHAPES.values())) < 4.5 * est.nonlinear.std).all()
    assert set(est.nonlinear.identifiability) <= {"well", "weakly"}


def test_behind_the_default_filter_too(leg):
    """Columns of every kind pass the same filter as the torque."""
    est = identify(leg, recording_of(leg, seconds=20.0, rate=400.0), RICH)
    np.testing.assert_allclose(est.nonlinear.values, list(SHAPES.values()), rtol=0.1)
    assert est.value("mu_drive_knee") == pytest.approx(0.10, abs=0.01)
    assert (exoid.validate(est, recording_of(leg, seconds=15.0, rate=400.0, seed=8)).nrmse < 0.01).all()


def test_the_prediction_is_that_of_the_true_friction_on_another_motion(leg):
    est = identify(leg, recording_of(leg), RICH, preparation=EXACT)
    _, q, v, a = motion_of(seed=11)
    np.testing.assert_allclose(est.torque(q, v, a), truth_torque(leg, q, v, a), atol=2e-3)
    assert (exoid.validate(est, recording_of(leg, seed=11)).nrmse < 1e-3).all()


@pytest.mark.nightly
def test_intervals_count_in_that_settings_are_uncertain(leg):
    """Standard deviations of parameters and settings over replicates are those that each estimate states."""
    found, stated = [], []
    for seed in range(25):
        est = identify(leg, recording_of(leg, 0.05, seed, seconds=6.0), RICH, preparation=EXACT)
        found.append([*est.values, *est.nonlinear.values])
        stated.append([*est.std, *est.nonlinear.std])
    ratio = np.std(found, axis=0, ddof=1) / np.mean(stated, axis=0)
    print("spread over stated std:", ratio.round(2))
    assert (ratio > 0.6).all()
    assert (ratio < 1.6).all()


def test_a_setting_that_is_found_makes_its_parameters_less_certain_than_one_that_is_given(leg, estimate):
    recording, settled = recording_of(leg, noise=0.05), estimate.model.terms
    found = identify(leg, recording, RICH, preparation=EXACT, noise="white")
    given = identify(leg, recording, settled, preparation=EXACT, noise="white")
    ratio = found.std / given.std
    assert given.nonlinear.names == ()
    assert (ratio > 0.97).all()
    assert ratio[estimate.names.index("cs_knee")] > 1.04
    np.testing.assert_allclose(given.values, estimate.values, atol=0.1 * estimate.std.max())


def test_an_estimate_with_settings_survives_a_file(estimate, tmp_path):
    estimate.save(tmp_path / "est.json")
    again = Estimate.load(tmp_path / "est.json")
    assert again.nonlinear.names == estimate.nonlinear.names
    assert again.nonlinear.units == ("rad", "rad", "rad/s")
    np.testing.assert_array_equal(again.nonlinear.values, estimate.nonlinear.values)
    np.testing.assert_array_equal(again.nonlinear.covariance, estimate.nonlinear.covariance)
    _, q, v, a = motion_of(seed=5)
    np.testing.assert_array_equal(again.torque(q, v, a), estimate.torque(q, v, a))
    assert str(again) == str(estimate)
    assert "vs_knee" in str(estimate)


def test_an_exported_sidecar_holds_what_a_urdf_has_no_place_for(estimate, tmp_path):
    written = estimate.to_urdf(tmp_path / "leg.urdf")
    assert {"mu_drive_knee", "mu_back_knee", "cs_knee"} <= set(written.only_in_sidecar)
    beside = json.loads((tmp_path / "leg.exoid.json").read_text())
    assert beside["shapes"] == dict(zip(estimate.nonlinear.names, estimate.nonlinear.values.tolist(), strict=True))
    assert beside["values"]["mu_drive_knee"] == pytest.approx(estimate.value("mu_drive_knee"), abs=0.05)


def test_poses_stand_beside_recordings(leg):
    """At rest no bent contact is known of: friction is left out there, and gravity is still right."""
    q = np.random.default_rng(0).uniform(-0.5, 0.5, (20, 2))
    still = np.zeros_like(q)
    poses = Poses(q, leg.inverse_dynamics(q, still, still) + np.array([0.2, -0.1]), leg.joint_names)
    est = identify(leg, [recording_of(leg), poses], RICH, preparation=EXACT)
    np.testing.assert_allclose(est.nonlinear.values, list(SHAPES.values()), rtol=1e-3)


def test_what_is_known_is_kept_and_the_settings_found_beside_it(leg):
    known = {"X1": float(leg.parameters[0]), "mu_back_knee": TRUTH["mu_back_knee"]}
    est = identify(leg, recording_of(leg), RICH, preparation=EXACT, known=known, nonnegative=True)
    for name, value in known.items():
        assert est.value(name) == value
    np.testing.assert_allclose(est.nonlinear.values, list(SHAPES.values()), rtol=1e-4)
    assert est.value("mu_drive_knee") == pytest.approx(TRUTH["mu_drive_knee"], abs=1e-3)


def test_bands_contain_the_true_torque(leg, estimate):
    _, q, v, a = motion_of(seed=21)
    band = estimate.torque_band(q, v, a, measured=False)
    truth = truth_torque(leg, q, v, a)
    assert ((band.lower <= truth) & (truth <= band.upper)).mean() > 0.8


# ------------------------------------------------------------------------- what cannot be known


def plain(leg, friction, noise=0.02, **motion):
    time, q, v, a = motion_of(**motion)
    tau = leg.inverse_dynamics(q, v, a) + friction(q, v)
    tau += noise * np.random.default_rng(0).standard_normal(tau.shape)
    return Recording(time=time, q=q, v=v, a=a, tau=tau, joint_names=leg.joint_names)


def test_a_stribeck_velocity_where_there_is_no_such_friction_is_said_not_to_be_determined(leg):
    recording = plain(leg, lambda q, v: 0.5 * np.tanh(v / 0.02) + 0.2 * v)
    est = identify(leg, recording, (Coulomb(), Stribeck(velocity=VS), Viscous()), preparation=EXACT)
    for name, verdict in zip(est.nonlinear.names, est.nonlinear.identifiability, strict=True):
        assert verdict in ("not", "held"), name
    assert any("vs_" in warning for warning in est.warnings)
    assert all(name in est.nonlinear.names for name in est.nonlinear.held)
    assert est.value("d_hip") == pytest.approx(0.2, abs=0.1)


def test_presliding_sharper_than_the_samples_is_held_at_its_bound_and_said(leg):
    recording = plain(leg, lambda q, v: 0.5 * np.sign(v) + 0.2 * v)
    est = identify(leg, recording, (Coulomb(presliding=DELTA), Viscous()), preparation=EXACT)
    assert "delta_hip" in est.nonlinear.held
    assert any(w.startswith("delta_hip is at its lower bound, 1e-05 rad, and held") for w in est.warnings)
    assert est.nonlinear.std[0] == 0.0
    assert "held" in str(est)
    assert est.value("c0_hip") == pytest.approx(0.5, abs=0.02)


def test_at_a_single_joint_driving_and_back_driving_are_not_told_apart_without_bending(leg):
    """Half their difference scales the only rigid-body torque there is; with a sharp sign nothing else shows it."""
    knee = Leg.from_description(leg.description, ("left_knee",))
    time, q, v, a = (x[..., :1] if x.ndim > 1 else x for x in motion_of())
    tau = knee.inverse_dynamics(q, v, a) * (1.0 + 0.1 * np.sign(v * knee.inverse_dynamics(q, v, a)))
    recording = Recording(time=time, q=q, v=v, a=a, tau=tau, joint_names=knee.joint_names)
    with pytest.raises(ExoidError, match=r"mu_drive_knee.*cannot be told apart"):
        identify(knee, recording, (LoadFriction(split=True, smoothing=0.0),), preparation=EXACT)
    est = identify(knee, recording, (LoadFriction(smoothing=0.0),), preparation=EXACT)
    assert est.value("mu_knee") == pytest.approx(0.1, abs=1e-4)


def test_friction_of_a_load_that_is_not_there_is_refused_by_name(leg):
    """No rigid body: no gravity, no inertia, nothing that gears would carry."""
    recording = plain(leg, lambda q, v: 0.5 * np.tanh(v / 0.02), noise=0.0)
    tau = recording.tau - leg.inverse_dynamics(recording.q, recording.v, recording.a)
    empty = dataclasses.replace(recording, tau=tau)
    with pytest.raises(ExoidError, match="mu_hip, mu_knee left no trace"):
        identify(leg, empty, (Coulomb(), LoadFriction()), preparation=EXACT)
