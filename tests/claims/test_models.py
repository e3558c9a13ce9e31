"""What the documents claim of their models, and what is true."""

import numpy as np
import pytest

import exoid
from exoid import published
from exoid.errors import ExoidError
from exoid.experiments import bleex
from exoid.experiments.limits import refuse_poses_beyond_limits
from exoid.torques import Stiffness, TorqueModel


def scaled_condition(W):
    return np.linalg.cond(W / np.linalg.norm(W, axis=0))


def test_180_degree_pairs_for_the_knee_would_need_more_than_the_hip_can_travel(leg):
    """The knee angle must be the same in both, so the hip alone would have to turn by 180°."""
    lowest, highest = leg.limits.lower[0], leg.limits.upper[0]
    assert highest - lowest < np.pi
    for hip in np.linspace(lowest, highest, 50):
        with pytest.raises(ExoidError, match="hip"):
            refuse_poses_beyond_limits(leg, [[hip, -0.5, 0.0], [hip + np.pi, -0.5, 0.0]])


def test_poses_with_different_sums_of_angles_give_the_knees_constant_without_pairs(leg):
    model = TorqueModel(leg, (Stiffness(joints=("knee",)),))
    q = bleex.static_sets(np.random.default_rng(0)).random
    fixed = np.column_stack([q[:, 0], np.full(len(q), -0.6), q[:, 2]])  # the same knee angle throughout
    still = np.zeros_like(q)
    W = model.regressor(fixed, still, still)[:, 1]
    names = ["X2", "Y2", "X3", "Y3", "b0_knee"]
    columns = W[:, [model.names.index(name) for name in names]]
    assert scaled_condition(columns) < 200.0
    truth = np.array([1.96, 0.003, 0.255, 0.131, -0.5])
    np.testing.assert_allclose(np.linalg.lstsq(columns, columns @ truth)[0], truth, atol=1e-10)


def hip_swing(extra, frequency, periods=4):
    """J1 from eq. (31) over whole periods of a sinusoid, with a torque that the equation neglects."""
    leg = exoid.load_leg("bleex")
    omega, amplitude = 2.0 * np.pi * frequency, np.deg2rad(14.0)
    t = (np.arange(2000 * periods) + 0.5) / (2000.0 * frequency)
    sine, cosine = np.sin(omega * t), np.cos(omega * t)
    hip = np.array([1.0, 0.0, 0.0])
    q, v, a = (np.outer(amplitude * x, hip) for x in (sine, omega * cosine, -(omega**2) * sine))
    q = q + bleex.CENTRE
    tau = leg.inverse_dynamics(q, v, a)[:, 0] + extra(q[:, 0] - bleex.CENTRE[0], v[:, 0])
    W = leg.regressor(q, v, a)[:, 0]
    index = leg.parameter_names.index("J1")
    others = np.delete(leg.parameters, index)
    J1 = W[:, index] @ (tau - np.delete(W, index, axis=1) @ others) / (W[:, index] @ W[:, index])
    return J1 - leg.parameters[index], omega


@pytest.mark.parametrize("frequency", bleex.FREQUENCIES)
def test_unmodelled_hip_stiffness_biases_j1_by_k_over_omega_squared(frequency):
    stiffness = 2.0
    bias, omega = hip_swing(lambda q, v: stiffness * q, frequency)
    assert bias == pytest.approx(-stiffness / omega**2, rel=1e-9)


@pytest.mark.parametrize("frequency", bleex.FREQUENCIES)
def test_neglected_hip_friction_does_not_bias_j1_over_whole_periods(frequency):
    bias, _ = hip_swing(lambda q, v: 0.5 * np.sign(v), frequency)
    assert abs(bias) < 1e-9


def held_ankle_j3(stiction):
    """J3 from the held ankle (eq. (29)) while the knee swings, with a static friction torque that it neglects."""
    leg = exoid.load_leg("bleex")
    motion = bleex.dynamic_motions()
    rig = bleex.swing_index(1, 2)
    time = np.arange(500) / 50.0
    q, v = (np.array([motion.at(t)[k][:, rig] for t in time]) for k in (0, 1))
    a = np.array([motion.at(t).a[:, rig] for t in time])
    W, index = leg.regressor(q, v, a)[:, 2], leg.parameter_names.index("J3")
    tau = W @ leg.parameters + stiction(v[:, 1], a[:, 1])
    rest = tau - np.delete(W, index, axis=1) @ np.delete(leg.parameters, index)
    return float(W[:, index] @ rest / (W[:, index] @ W[:, index])) / leg.parameters[index] - 1.0


def test_static_friction_of_a_held_joint_carries_what_j3_should():
    """It takes the inertial torque upon itself up to its band, so that the sensor sees less of it."""
    assert abs(held_ankle_j3(lambda v, a: 0.0 * a)) < 1e-9
    c0 = published.bleex_resistances("left")["c0_ankle"]
    foot = exoid.load_leg("bleex").parameters[-1]
    assert held_ankle_j3(lambda v, a: -np.clip(foot * a, -c0, c0)) == pytest.approx(-1.0, abs=1e-6)
    assert held_ankle_j3(lambda v, a: -0.05 * np.sign(a)) < -0.15
