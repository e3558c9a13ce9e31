"""What the documents claim of their models, and what is true."""

import numpy as np
import pytest

import exoid
from exoid import published
from exoid.errors import ExoidError
from exoid.experiments import bleex, cuhk
from exoid.experiments.limits import refuse_poses_beyond_limits
from exoid.torques import Stiffness, TorqueModel


def stacked(W):
    return W.reshape(-1, W.shape[-1])


def scaled_condition(W):
    return np.linalg.cond(W / np.linalg.norm(W, axis=0))


# -----------------------------------------------------------------------------------------------------


def hip_statics(tilts_deg, *names):
    """Columns of the hip's torque over document 1's 100 poses at some tilts of the torso."""
    leg = exoid.load_leg("bleex")
    model = TorqueModel(leg, (Stiffness(joints=("hip",)),))
    q = bleex.static_sets(np.random.default_rng(0)).random
    still = np.zeros_like(q)
    poses = [model.regressor(q, still, still, exoid.TorsoMotion(pitch=np.deg2rad(tilt))) for tilt in tilts_deg]
    return np.vstack([W[:, 0, [model.names.index(name) for name in names]] for W in poses])


MOMENTS, SPRING = ("X1", "Y1"), ("b2_hip", "b1_hip", "b0_hip")


def test_hip_stiffness_is_nearly_collinear_with_the_mass_moments_of_an_upright_torso():
    """True as document 1 says: X1, Y1 and a parabola over the hip angle hardly differ."""
    assert scaled_condition(hip_statics([0.0], *MOMENTS)) < 2.5
    assert scaled_condition(hip_statics([0.0], *MOMENTS, *SPRING)) > 500.0


def test_tilting_the_torso_tells_hip_stiffness_from_the_mass_moments():
    assert scaled_condition(hip_statics([0.0, -30.0, 30.0], *MOMENTS, *SPRING)) < 50.0


# -----------------------------------------------------------------------------------------------------


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


# -----------------------------------------------------------------------------------------------------


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


# -----------------------------------------------------------------------------------------------------


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


def test_static_friction_of_unknown_sign_is_gone_from_the_mean_of_both_directions(leg):
    q = bleex.static_sets(np.random.default_rng(0)).random
    still, friction = np.zeros_like(q), np.array([0.5, 0.53, 0.26])
    gravity = leg.inverse_dynamics(q, still, still)
    names = leg.joint_names
    both = exoid.signals.Approaches(
        exoid.signals.Poses(q, gravity + friction, names), exoid.signals.Poses(q, gravity - friction, names)
    )
    np.testing.assert_allclose(both.averaged.tau, gravity, atol=1e-12)
    np.testing.assert_allclose(both.band, np.tile(friction, (len(q), 1)), atol=1e-12)
    model = TorqueModel(leg, (Stiffness(),))
    W = stacked(model.regressor(q, still, still))
    acting = np.linalg.norm(W, axis=0) > 0.0
    wrong, right = (np.linalg.lstsq(W[:, acting], p.tau.ravel())[0] for p in (both.below, both.averaged))
    moved = dict(zip(np.array(model.names)[acting], wrong - right, strict=True))
    assert moved["b0_knee"] == pytest.approx(friction[1], abs=1e-6)
    assert moved["b0_ankle"] == pytest.approx(friction[2], abs=1e-6)


# -----------------------------------------------------------------------------------------------------


def document_validation():
    motion = cuhk.validation_motion()
    time = np.linspace(0.0, 5.0, 101)
    q, v = (np.array([motion.at(t)[k][:, 0] for t in time]) for k in (0, 1))
    return q, v, np.array([motion.at(t).a[:, 0] for t in time])


def test_the_validation_motion_of_document_2_cannot_see_j2():
    """θh = θk: the shank does not turn, so ∂τ/∂J2 is zero at both joints, exactly."""
    leg = exoid.load_leg("cuhk")
    W = leg.regressor(*document_validation())
    index = leg.parameter_names.index("J2")
    assert np.abs(W[..., index]).max() < 1e-15
    fivefold = leg.parameters * np.where(np.arange(6) == index, 5.0, 1.0)
    np.testing.assert_allclose(W @ fivefold, W @ leg.parameters, atol=1e-12)


def test_a_motion_that_turns_the_shank_sees_j2():
    leg = exoid.load_leg("cuhk")
    motion = cuhk.multisine(leg, np.random.default_rng(0), 5)
    W = leg.regressor(*motion.over(cuhk.PERIOD))[..., leg.parameter_names.index("J2")]
    assert np.abs(W).max() > 1.0


def test_a_good_motion_sees_inertia_a_hundred_times_better_than_table_ii():
    """J1's column in the hip's torque, in N·m for each kg·m²."""
    leg = exoid.load_leg("cuhk")
    fast = cuhk.multisine(leg, np.random.default_rng(0), 5).over(cuhk.PERIOD).a[:, 0]
    slow = np.deg2rad(20.0) * cuhk.TABLE_II_FREQUENCY**2 / np.sqrt(2.0)
    assert np.sqrt(np.mean(fast**2)) > 50.0 * slow
