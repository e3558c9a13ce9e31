"""Motion and parameters fitted together: right without noise, better with it, and honest about it."""

import dataclasses

import numpy as np
import pytest
from scipy.signal import lfilter
from swings import TERMS, Swing, holds
from unchecked import identify

import exoid
from exoid import ExoidError
from exoid.identification.estimators import JointML
from exoid.identification.estimators.motion_system import Levels, MotionState, Moving, System, respond
from exoid.identification.estimators.trajectory import Trajectory, eliminate
from exoid.signals import Poses
from exoid.torques import Motion, TorqueModel

pytestmark = pytest.mark.slow

ANGLE, TORQUE = 1e-3, 0.05
NO_PRIORS = np.zeros((0, 16))


@pytest.fixture(scope="module")
def swing():
    """12 s at 50 Hz."""
    return Swing(exoid.load_leg("bleex", inertias="cad"), 50.0, 12.0, base=0.15)


def noisy(swing, seed, angle=ANGLE, torque=TORQUE):
    rng = np.random.default_rng(seed)
    q, _, _ = swing.motion
    return swing.recording(
        q=q + angle * rng.standard_normal(q.shape),
        v=None,
        a=None,
        tau=swing.torque + torque * rng.standard_normal(q.shape),
    )


def relative(estimate, swing):
    return np.abs(estimate.values / swing.truth - 1.0)


def test_the_torque_answers_to_the_motion_as_pinocchio_says(swing):
    """∂τ/∂a is the mass matrix; along a direction the derivative is that of a much smaller step."""
    model = TorqueModel(swing.leg, TERMS)
    motion = Motion(*(x[:30] for x in swing.motion))
    _, to_motion = respond(model, swing.truth, motion)
    np.testing.assert_allclose(to_motion[2], swing.leg.mass_matrix(motion.q), rtol=1e-7, atol=1e-8)
    rng = np.random.default_rng(2)
    for kind, name in enumerate(("q", "v")):
        way = rng.standard_normal(motion.q.shape)
        there, back = (
            model.columns(motion._replace(**{name: getattr(motion, name) + step * way})) for step in (3e-6, -3e-6)
        )
        expected = np.tensordot(swing.truth, there - back, axes=1).T / 6e-6
        np.testing.assert_allclose((to_motion[kind] @ way[..., None])[..., 0], expected, rtol=1e-5, atol=1e-5)


@pytest.fixture
def system(swing):
    """Two recordings at noise levels that are all different."""
    model = TorqueModel(swing.leg, TERMS)
    moving = []
    for seed, rows in ((3, slice(0, 150)), (4, slice(150, 260))):
        log = noisy(swing, seed).slice(rows.start, rows.stop)
        usable = (np.random.default_rng(seed).random(log.q.shape) > 0.1).astype(float)
        moving.append(Moving(log.time, log.q, log.tau, usable, swing.motion[0][rows], None))
    least = Levels(1e-9 * LEVELS.angle, 1e-9 * LEVELS.torque)
    return System(model, moving, NO_PRIORS, [Trajectory.on(data.time, 0.07) for data in moving], least)


LEVELS = Levels(np.array([1e-3, 2e-3, 3e-3]), np.array([0.05, 0.1, 0.02]))


def test_the_score_is_the_derivative_of_the_sum_of_squares(system, swing):
    """Gradient of what the motions leave over, against finite differences in motion and parameters."""
    state = system.begin(1.1 * swing.truth)
    rows = system.linearise(state, LEVELS)
    reduced = [eliminate(*pair) for pair in zip(system.trajectories, rows, strict=True)]
    _, gradient = system.join(reduced)

    def squares(share, values, coefficients):
        moved = [c + share * x for c, x in zip(state.coefficients, coefficients, strict=True)]
        return system.squares(MotionState(moved, state.values + share * values), LEVELS)

    rng = np.random.default_rng(6)
    for _ in range(3):
        values = rng.standard_normal(len(swing.truth)) * np.abs(swing.truth)
        # a direction in which the motions answer to β as the normal equations say
        turns = [-(part.coupling @ values).reshape(-1, 3) for part in reduced]
        slope = (squares(1e-5, values, turns) - squares(-1e-5, values, turns)) / 2e-5
        assert slope == pytest.approx(-2.0 * gradient @ values, rel=2e-4)


def test_without_noise_it_is_the_truth_and_what_the_default_says(swing):
    log = swing.encoders_only()
    joint, default = (exoid.identify(swing.leg, log, TERMS, estimator) for estimator in ("ml", "wls"))
    assert relative(joint, swing).max() < 1e-3
    np.testing.assert_allclose(joint.values, default.values, rtol=2e-3)


@pytest.mark.parametrize("seed", [1, 2])
def test_noise_levels_and_parameters_are_found_from_noisy_angles(swing, seed):
    estimate = identify(swing.leg, noisy(swing, seed), TERMS, "ml")
    assert estimate.estimator.startswith("ml(spacing=")
    assert estimate.warnings == ()
    assert np.abs((estimate.values - swing.truth) / estimate.std).max() < 4.0
    assert estimate.std.max() < 0.1
    again = identify(swing.leg, noisy(swing, seed), TERMS, estimator=JointML(float(estimate.estimator[11:-1])))
    np.testing.assert_allclose(again.values, estimate.values, rtol=0.02)


def test_it_is_nearer_to_the_truth_than_least_squares_at_a_cutoff_that_is_too_high(swing):
    """Errors in variables: noise in the columns weakens least squares, not the joint fit."""
    joint = identify(swing.leg, noisy(swing, 3), TERMS, "ml")
    filtered = identify(swing.leg, noisy(swing, 3), TERMS, cutoff=8.0)
    assert relative(joint, swing).max() < 0.1 * relative(filtered, swing).max()


@pytest.mark.parametrize(
    "spacing", [0.0, -1.0, float("nan"), float("inf"), pytest.param(0.02, id="knots closer than samples can hold")]
)
def test_what_it_cannot_fit_is_refused(swing, spacing):
    with pytest.raises(ExoidError):
        identify(swing.leg, noisy(swing, 8), TERMS, JointML(spacing))
    log = noisy(swing, 5)
    poses = Poses(log.q[:5], log.tau[:5], log.joint_names)
    with pytest.raises(ExoidError, match="ml fits motions of the leg in the air, without poses"):
        identify(swing.leg, [log, poses], TERMS, "ml")


def test_rows_with_the_motion_eliminated_have_the_normal_equations_and_the_score(system, swing):
    """Σ rowᵀ row is the matrix of the reduced system, and Σ rowᵀ residual its gradient."""
    state = system.begin(1.02 * swing.truth)
    linear = system.linearise(state, LEVELS)
    reduced = [eliminate(*pair) for pair in zip(system.trajectories, linear, strict=True)]
    matrix, gradient = system.join(reduced)
    rows = system.influence(state, LEVELS)
    W = np.vstack([block.rows.W.reshape(-1, len(swing.truth)) for block in rows.blocks])
    tau = np.concatenate([block.rows.tau.ravel() for block in rows.blocks])
    np.testing.assert_allclose(W.T @ W, matrix, rtol=1e-5, atol=1e-6 * np.abs(matrix).max())
    score = W.T @ (tau - W @ state.values)
    np.testing.assert_allclose(score, gradient, rtol=1e-4, atol=1e-6 * np.abs(gradient).max())


@pytest.mark.nightly
def test_intervals_hold_under_torque_noise_with_a_memory(swing):
    """AR(1) of 0.2 s; by the textbook's formula for white noise they hold far less often."""
    inside = {"correlated": [], "white": []}
    for seed in range(16):
        log = noisy(swing, seed, 1e-4, 0.0)
        rng = np.random.default_rng([seed, 1])
        noise = lfilter([1.0], [1.0, -0.9], rng.standard_normal((200 + len(log.tau), 3)), axis=0)[200:]
        log = dataclasses.replace(log, tau=log.tau + 0.1 * noise)
        for assumed, found in inside.items():
            found.append(holds(identify(swing.leg, log, TERMS, JointML(0.05), noise=assumed), swing.truth))
    coverage = {assumed: np.mean(found) for assumed, found in inside.items()}
    print("coverage of ml:", coverage)
    assert 0.88 < coverage["correlated"] < 0.995
    assert coverage["white"] < 0.7
