"""Planned motions keep their limits, start and stop at rest, and are as good as a search can tell."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import exoid
from exoid.experiments.excitation import MotionLimits, plan_excitation
from exoid.experiments.excitation.fourier import Basis
from exoid.experiments.excitation.objective import Objective, Stage
from exoid.experiments.excitation.scales import Scales, TorqueNoise
from exoid.experiments.limits import refuse_motion_beyond_limits
from exoid.torques import DEFAULT_TERMS, TorqueModel

pytestmark = pytest.mark.slow

BLEEX, CUHK = exoid.load_leg("bleex"), exoid.load_leg("cuhk")
STAGES = [Stage(1.0, 30.0), Stage(16.0, 1e3), Stage(0.0, 30.0)]


def objective(leg, terms=DEFAULT_TERMS, pitches=(0.0,), limits=None, harmonics=5):
    model, limits = TorqueModel(leg, terms), limits or MotionLimits.of(leg)
    scales = Scales.of(model, limits)
    noise = TorqueNoise.of(0.3, scales.typical_torque)
    basis = Basis.make(6.0, harmonics, 24 * harmonics)
    common = {"basis": basis, "noise": noise, "seconds": 30.0, "rate": 100.0}
    return Objective(model=model, limits=limits, scales=scales, pitches=np.array(pitches), **common)


@pytest.fixture(scope="module")
def plan():
    limits = MotionLimits.of(CUHK, velocity=2.0, acceleration=8.0, torque=(60.0, 25.0), angles_deg={"hip": (-10, 80)})
    return plan_excitation(CUHK, limits=limits, noise=0.3, duration=20.0, highest=0.7, starts=2)


@pytest.mark.parametrize("stage", STAGES, ids=["a", "worst", "d"])
@pytest.mark.parametrize(
    ("leg", "terms", "pitches"),
    [
        (BLEEX, DEFAULT_TERMS, (0.0,)),
        (BLEEX, (exoid.Stiffness(), exoid.Coulomb()), (-0.5, 0.4)),
        (CUHK, (exoid.Coulomb(smoothing=0.1), exoid.Viscous()), (0.2,)),
    ],
    ids=["bleex", "tilted", "cuhk"],
)
def test_the_gradient_is_that_of_finite_differences(leg, terms, pitches, stage):
    """Through information, criterion, every limit and the regressor, at a motion beyond all of its limits."""
    limits = MotionLimits.of(leg, velocity=1.0, acceleration=3.0, torque=10.0)
    cost, rng = objective(leg, terms, pitches, limits), np.random.default_rng(3)
    x = 0.35 * rng.standard_normal(cost.shape).ravel()
    _, gradient = cost(x, stage)
    for _ in range(5):
        direction = rng.standard_normal(x.size)
        ends = [cost(x + sign * 1e-6 * direction, stage)[0] for sign in (1.0, -1.0)]
        slope = (ends[0] - ends[1]) / 2e-6
        assert gradient @ direction == pytest.approx(slope, rel=1e-4, abs=1e-6 * np.linalg.norm(gradient))


def test_every_limit_is_penalised():
    """A motion that is too large exceeds all four, and none when it stands still in a harmless pose."""
    cost = objective(BLEEX, limits=MotionLimits.of(BLEEX, velocity=1.0, acceleration=3.0, torque=30.0))
    x = np.random.default_rng(0).standard_normal(cost.shape)[0]
    assert (cost.excesses_of(0, cost.basis.states(x)) > 0.0).all()
    still = np.zeros_like(x)
    still[0] = [0.6, -1.2, 0.6]
    assert cost.excesses_of(0, cost.basis.states(still)).sum() == 0.0


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    period=st.floats(3.0, 20.0),
    harmonics=st.integers(3, 12),
    joints=st.integers(1, 4),
    cycles=st.integers(1, 4),
)
def test_a_motion_of_any_coefficients_starts_and_stops_at_rest(seed, period, harmonics, joints, cycles):
    """No velocity, no acceleration and no jerk at both ends; velocity and acceleration are derivatives."""
    basis = Basis.make(period, harmonics, 24 * harmonics)
    x = np.random.default_rng(seed).standard_normal((basis.count, joints))
    motion = basis.motion(x, cycles * period, 0.0)
    ends = motion.at(np.array([0.0, motion.duration]))
    largest = motion.period_samples(200)
    for end, size in zip(ends[1:], largest[1:], strict=True):
        assert np.abs(end).max() < 1e-9 * np.abs(size).max()
    np.testing.assert_allclose(ends.q[0], ends.q[1], atol=1e-9)
    h = 1e-4 * period
    near = motion.at(np.array([0.0, h]))
    jerk = np.abs(near.a[1] - near.a[0]) / h
    assert (jerk < 0.02 * np.abs(largest.a).max() * 2.0 * np.pi * harmonics / period).all()
    times = np.linspace(0.0, period, 50)
    before, after, now = motion.at(times - 1e-6), motion.at(times + 1e-6), motion.at(times)
    np.testing.assert_allclose((after.q - before.q) / 2e-6, now.v, atol=1e-6 * np.abs(now.a).max() + 1e-8)
    np.testing.assert_allclose((after.v - before.v) / 2e-6, now.a, atol=1e-4 * np.abs(now.a).max())
    np.testing.assert_allclose(basis.states(x).q, motion.period_samples(24 * harmonics).q, atol=1e-9)


def test_a_plan_keeps_its_limits_between_samples(plan):
    """On a grid ten times as fine as that of the log, by Pinocchio's torques."""
    limits, motion = plan.limits, plan.motions[0]
    q, v, a = motion.at(np.arange(round(10.0 * plan.rate * motion.duration) + 1) / (10.0 * plan.rate))
    tau = CUHK.inverse_dynamics(q, v, a)
    assert (q >= limits.lower - 1e-9).all()
    assert (q <= limits.upper + 1e-9).all()
    for x, limit in ((v, limits.velocity), (a, limits.acceleration), (tau, limits.torque)):
        assert (np.abs(x) <= limit + 1e-9).all()
    used = [np.abs(v).max(axis=0) / limits.velocity, np.abs(a).max(axis=0) / limits.acceleration]
    assert np.max(used) > 0.97  # and makes use of them
    refuse_motion_beyond_limits(CUHK, motion.reference, plan.duration)


def test_a_plan_is_what_a_rig_is_commanded(plan):
    """As a reference at any time, and as a log."""
    recording, reference = plan.recordings[0], plan.motions[0].reference
    for k in (0, 17, 1234, len(recording) - 1):
        asked = reference.at(float(recording.time[k]))
        for target, logged in zip(asked, (recording.q, recording.v, recording.a), strict=True):
            np.testing.assert_allclose(target[:, 0], logged[k], atol=1e-11)
    np.testing.assert_allclose(recording.tau, CUHK.inverse_dynamics(recording.q, recording.v, recording.a), atol=1e-10)


def test_tilting_the_torso_makes_hip_stiffness_known():
    """Doc. 1 proposes it: upright, X1 and the hip's spring are nearly collinear."""
    terms = (exoid.Stiffness(), exoid.Coulomb())
    plans = [
        plan_excitation(BLEEX, terms, noise=0.3, duration=20.0, highest=0.5, tilts_deg=tilts, starts=1, criterion="d")
        for tilts in ((0.0,), (-30.0, 30.0))
    ]
    upright, tilted = (plan.precision.std[plan.precision.names.index("b1_hip")] for plan in plans)
    assert tilted < 0.5 * upright
    assert [round(np.rad2deg(motion.pitch)) for motion in plans[1].motions] == [-30, 30]
