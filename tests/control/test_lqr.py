"""Gains along a trajectory against python-control, finite differences and the cost they minimise."""

import numpy as np
import pytest
from legs import LEG, cuhk_plant, exact_estimate, frictionless, random_target

from exoid.control import ControlModel, State, Weights, lqr, simulate
from exoid.control.linearise import Linear, discretise, linearise
from exoid.control.lqr import riccati
from exoid.errors import ExoidError
from exoid.experiments import Hold, healthy_gait
from exoid.rig import Target

control = pytest.importorskip("control")

GAIT = healthy_gait()
MODEL = ControlModel.of(cuhk_plant(b2_hip=0.4, b1_hip=-0.6))


def forward_dynamics(model, q, v, tau):
    """Acceleration without Coulomb friction."""
    net = tau - model.viscous * v - model.inverse_dynamics(q, v, np.zeros(model.n))
    return np.linalg.solve(model.mass_matrix(q), net)


def test_the_linearisation_is_the_derivative_of_forward_dynamics():
    """Central differences of Pinocchio's dynamics with springs, rotors and viscous friction."""
    for q, v, a in np.random.default_rng(0).uniform(-1.0, 1.0, (10, 3, 2)):
        tau = MODEL.inverse_dynamics(q, v, a) + MODEL.viscous * v
        A, B = linearise(MODEL, q, v, a)
        step = 1e-6
        for k in range(2):
            e = step * np.eye(2)[k]
            by_q = forward_dynamics(MODEL, q + e, v, tau) - forward_dynamics(MODEL, q - e, v, tau)
            by_v = forward_dynamics(MODEL, q, v + e, tau) - forward_dynamics(MODEL, q, v - e, tau)
            by_tau = forward_dynamics(MODEL, q, v, tau + e) - forward_dynamics(MODEL, q, v, tau - e)
            np.testing.assert_allclose(A[2:, k], by_q / (2.0 * step), atol=1e-6)
            np.testing.assert_allclose(A[2:, 2 + k], by_v / (2.0 * step), atol=1e-6)
            np.testing.assert_allclose(B[2:, k], by_tau / (2.0 * step), atol=1e-6)
        np.testing.assert_array_equal(A[:2], [[0, 0, 1, 0], [0, 0, 0, 1]])


def test_sampling_is_that_of_python_control():
    continuous = linearise(MODEL, *np.random.default_rng(1).uniform(-1.0, 1.0, (3, 2)))
    sampled = discretise(continuous, 0.01)
    system = control.c2d(control.ss(*continuous, np.eye(4), np.zeros((4, 2))), 0.01)
    np.testing.assert_allclose(sampled.A, system.A, atol=1e-10)
    np.testing.assert_allclose(sampled.B, system.B, atol=1e-10)


@pytest.mark.parametrize("weights", [Weights(), Weights(np.deg2rad([1.0, 4.0]), 2.0, (5.0, 20.0))])
@pytest.mark.parametrize("points", [1, 7])
def test_the_gain_at_a_fixed_point_is_python_controls(weights, points):
    """On the leg linearised there, at 100 Hz, however many points are kept."""
    pose = np.array([[0.4], [0.9]])
    law = lqr(MODEL, Hold(pose), 1.0, weights=weights, points=points)
    A, B = discretise(linearise(MODEL, pose[:, 0], np.zeros(2), np.zeros(2)), 0.01)
    expected, _, poles = control.dlqr(A, B, *weights.matrices(2))
    assert np.abs(poles).max() < 1.0
    for gain in law.gain:
        np.testing.assert_allclose(gain, expected, rtol=1e-7, atol=1e-8)


def random_steps(count, seed=0):
    rng = np.random.default_rng(seed)
    return [
        Linear(np.eye(4) + 0.2 * rng.standard_normal((4, 4)), 0.3 * rng.standard_normal((4, 2))) for _ in range(count)
    ]


def test_the_recursion_minimises_the_cost():
    """Against the least-squares solution for all torques at once, from a random state, without dynamic programming."""
    steps, Q, R = random_steps(12), np.diag([1.0, 2.0, 0.5, 0.3]), np.diag([0.7, 1.3])
    gains = riccati(steps, Q, R, periodic=False)
    last = control.dlqr(*steps[-1], Q, R)[1]  # what follows after the steps
    x0 = np.array([1.0, -2.0, 0.5, 0.3])
    free, forced, rows, rhs = np.eye(4), np.zeros((4, 24)), [], []
    for k, (A, B) in enumerate(steps):
        rows += [np.sqrt(Q) @ forced, np.sqrt(R) @ np.eye(24)[2 * k : 2 * k + 2]]
        rhs += [-np.sqrt(Q) @ free @ x0, np.zeros(2)]
        free, forced = A @ free, A @ forced
        forced[:, 2 * k : 2 * k + 2] += B
    root = np.linalg.cholesky(last).T
    best = np.linalg.lstsq(np.vstack([*rows, root @ forced]), np.concatenate([*rhs, -root @ free @ x0]))[0]
    x = x0
    for k, (A, B) in enumerate(steps):
        u = -gains[k] @ x
        np.testing.assert_allclose(u, best[2 * k : 2 * k + 2], rtol=1e-6, atol=1e-8)
        x = A @ x + B @ u


def test_a_periodic_solution_is_that_of_many_periods():
    steps, Q, R = random_steps(5), np.eye(4), np.eye(2)
    once, long = riccati(steps, Q, R, periodic=True), riccati(60 * steps, Q, R, periodic=False)
    for k in range(5):
        np.testing.assert_allclose(once[k], long[k], rtol=1e-6, atol=1e-9)


def test_the_torque_is_feedforward_and_gain():
    law = lqr(exact_estimate(), GAIT, 10.0)
    target, state = random_target(), State(*np.random.default_rng(4).uniform(-1.0, 1.0, (2, 2)), time=3.337)
    model = ControlModel.of(exact_estimate())
    expected = model.inverse_dynamics(*target) + model.friction(target.q, target.v, 0.05)
    expected = expected + law.gain[33] @ [*(target.q - state.q), *(target.v - state.v)]
    np.testing.assert_allclose(law.torque(state, target), expected, atol=1e-12)


def test_gains_follow_the_time_of_the_reference():
    law = lqr(exact_estimate(), GAIT, 10.0, points=10)
    assert law.gain.shape == (10, 2, 4)
    for time, point in ((0.0, 0), (0.99, 0), (1.0, 1), (9.99, 9), (10.0, 0), (25.0, 5)):
        np.testing.assert_array_equal(law.gain_at(time), law.gain[point])
    once = lqr(exact_estimate(), GAIT, 10.0, points=10, periodic=False)
    np.testing.assert_array_equal(once.gain_at(31.0), once.gain[9])


@pytest.mark.parametrize("points", [1, 10, 100])
def test_the_leg_follows_a_gait_with_any_number_of_gains(points):
    """What counts is the feed-forward: one gain does as well as the hundred of the work that document 2 cites."""
    plant = frictionless(cuhk_plant())
    law = lqr(plant, healthy_gait(period=4.0), 4.0, points=points)
    assert simulate(plant, law, healthy_gait(period=4.0), 4.0).peak_deg.max() < 0.15


def test_many_legs_at_once_get_what_each_gets_alone():
    rng = np.random.default_rng(2)
    law = lqr(exact_estimate(), GAIT, 10.0, points=4)
    q, v = rng.uniform(-1.0, 1.0, (2, 2, 3))
    target = Target(*rng.uniform(-1.0, 1.0, (3, 2, 3)))
    torque = law.torque(State(q, v, 6.0), target)
    for k in range(3):
        alone = law.torque(State(q[:, k], v[:, k], 6.0), Target(*(x[:, k] for x in target)))
        np.testing.assert_allclose(torque[:, k], alone, atol=1e-12)


@pytest.mark.parametrize(
    ("settings", "word"),
    [
        ({"points": 0}, "0 gains"),
        ({"points": 1001}, "1001 gains"),
        ({"duration": 0.0}, "over 0 s"),
        ({"duration": np.nan}, "gains over nan s"),
        ({"rate": 0.0}, "0 Hz"),
        ({"weights": Weights(angle=0.0)}, "weights"),
        ({"weights": Weights(torque=np.inf)}, "weights"),
        ({"weights": Weights(angle=(1.0, 2.0, 3.0))}, "for 2 joints"),
    ],
)
def test_bad_settings_are_refused(settings, word):
    with pytest.raises(ExoidError, match=word):
        lqr(LEG, GAIT, **{"duration": 10.0, **settings})


def test_a_reference_of_several_legs_is_refused():
    with pytest.raises(ExoidError, match="that of one leg"):
        lqr(LEG, GAIT.tile(2), 10.0)
