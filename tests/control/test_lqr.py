"""The gain against python-control, finite differences, and the cost it minimises."""

import numpy as np
import pytest
import scipy
from controlled_legs import LEG, cuhk_plant, estimate_of, exact_estimate, random_target

from exoid.control import ControlModel, State, lqr
from exoid.control.lqr import linearise
from exoid.experiments import healthy_gait
from exoid.torques import CouplingInertia, CouplingSpring, TorqueModel, Viscous

control = pytest.importorskip("control")

GAIT = healthy_gait()
MODEL = ControlModel.of(cuhk_plant(b2_hip=0.4, b1_hip=-0.6))
BOTH = {"joints": ("hip", "knee"), "ratios": (1.0, -0.6)}
VALUES = {**dict(zip(LEG.parameter_names, LEG.parameters, strict=True)), "d_knee": 0.4, "k_hip_knee": 12.0}
COUPLED = TorqueModel(LEG, (Viscous(), CouplingSpring(**BOTH), CouplingInertia(**BOTH)))
MODELS = [MODEL, ControlModel.of(estimate_of(COUPLED, {**VALUES, "Ia_hip_knee": 0.3}))]


def forward_dynamics(model, q, v, tau):
    """Acceleration without Coulomb friction."""
    net = tau - model.viscous * v - model.inverse_dynamics(q, v, np.zeros(model.n))
    return np.linalg.solve(model.mass_matrix(q), net)


@pytest.mark.parametrize("model", MODELS, ids=["single joints", "couplings"])
def test_the_linearisation_is_the_derivative_of_forward_dynamics(model):
    """Central differences of Pinocchio's dynamics with springs, rotors and viscous friction."""
    for q, v, a in np.random.default_rng(0).uniform(-1.0, 1.0, (10, 3, 2)):
        tau = model.inverse_dynamics(q, v, a) + model.viscous * v
        A, B = linearise(model, q, v, a)
        step = 1e-6
        for k in range(2):
            e = step * np.eye(2)[k]
            by_q = forward_dynamics(model, q + e, v, tau) - forward_dynamics(model, q - e, v, tau)
            by_v = forward_dynamics(model, q, v + e, tau) - forward_dynamics(model, q, v - e, tau)
            by_tau = forward_dynamics(model, q, v, tau + e) - forward_dynamics(model, q, v, tau - e)
            np.testing.assert_allclose(A[2:, k], by_q / (2.0 * step), atol=1e-6)
            np.testing.assert_allclose(A[2:, 2 + k], by_v / (2.0 * step), atol=1e-6)
            np.testing.assert_allclose(B[2:, k], by_tau / (2.0 * step), atol=1e-6)
        np.testing.assert_array_equal(A[:2], [[0, 0, 1, 0], [0, 0, 0, 1]])


@pytest.mark.parametrize(("angle", "torque"), [(2.0, 10.0), ((1.0, 4.0), (5.0, 20.0))])
def test_the_gain_is_python_controls(angle, torque):
    """On the leg linearised in the pose at rest, with a torque that is held for 10 ms."""
    for time in (0.0, 1.25, 5.0, 8.75):
        pose = GAIT.at(time).q[:, 0]
        A, B = linearise(MODEL, pose, np.zeros(2), np.zeros(2))
        moves = np.vstack([np.hstack([A, B]), np.zeros((2, 6))])
        A, B = np.split(scipy.linalg.expm(0.01 * moves)[:4], [4], axis=1)
        expected, _, poles = control.dlqr(A, B, *costs(angle, torque))
        assert np.abs(poles).max() < 1.0
        found = lqr(MODEL, pose, angle_deg=angle, torque=torque)
        np.testing.assert_allclose(np.hstack([found.kp, found.kd]), expected, rtol=1e-7, atol=1e-8)


def costs(angle=2.0, torque=10.0):
    """Q and R by Bryson's rule."""
    Q = np.zeros((4, 4))
    Q[:2, :2] = np.diag(np.broadcast_to(np.deg2rad(angle), 2) ** -2.0)
    return Q, np.diag(np.broadcast_to(torque, 2) ** -2.0)


def test_the_torque_is_feedforward_and_gain():
    law = lqr(exact_estimate(), (0.3, 0.6))
    target, state = random_target(), State(*np.random.default_rng(4).uniform(-1.0, 1.0, (2, 2)))
    model = ControlModel.of(exact_estimate())
    expected = model.inverse_dynamics(*target) + model.friction(target.q, target.v, 0.05)
    expected = expected + law.kp @ (target.q - state.q) + law.kd @ (target.v - state.v)
    np.testing.assert_allclose(law.torque(state, target), expected, atol=1e-12)
