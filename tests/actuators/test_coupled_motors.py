"""Couplings and series springs: virtual work, powers, inverses, and friction of motors as terms."""

import numpy as np
import pytest

import exoid
from exoid.actuators import Actuators, Coupling, SeriesElastic, motor_terms
from exoid.torques import CouplingFriction, TorqueModel, Viscous

LEG = exoid.load_leg("cuhk")
RNG = np.random.default_rng(2)
MATRIX = ((0.05, 0.05), (0.06, -0.04))
COUPLING = Coupling(("hip", "knee"), MATRIX)


def test_motor_torques_become_joint_torques_of_a_recording_and_back() -> None:
    """Virtual work: τ_mᵀ θ̇_m = τᵀ q̇ with q = A θ_m."""
    time = np.arange(50) / 50.0
    given = exoid.Recording(
        time=time, q=np.zeros((50, 2)), motor_torque=RNG.normal(size=(50, 2)), joint_names=("left_hip", "left_knee")
    )
    actuators = Actuators.of(LEG, {"wrist": COUPLING})
    found = actuators.torque(given)
    assert given.motor_torque is not None
    np.testing.assert_allclose(found.tau, given.motor_torque @ np.linalg.inv(np.array(MATRIX)))
    assert found.computed == ("left_hip", "left_knee")
    np.testing.assert_allclose(actuators.readings(found).motor_torque, given.motor_torque)


def test_a_sensor_at_one_joint_of_a_coupling_is_kept() -> None:
    time, tau = np.arange(50) / 50.0, np.full((50, 2), np.nan)
    tau[:, 0] = 7.0
    given = exoid.Recording(
        time=time,
        q=np.zeros((50, 2)),
        tau=tau,
        motor_torque=RNG.normal(size=(50, 2)),
        joint_names=("left_hip", "left_knee"),
    )
    found = Actuators.of(LEG, {"wrist": COUPLING}).torque(given)
    assert found.tau is not None
    assert (found.tau[:, 0] == 7.0).all()
    assert found.computed == ("left_knee",)


def test_friction_of_motors_acts_on_the_joints_by_the_transpose_of_the_inverse() -> None:
    """τ = A⁻ᵀ (c tanh(θ̇_m / w) + d θ̇_m + J θ̈_m) with θ_m = A⁻¹ q."""
    model = TorqueModel(LEG, motor_terms(COUPLING), separate=("Ia_hip_motor", "Ia_knee_motor"))
    names = [f"{symbol}_{joint}_motor" for symbol in ("c0", "d", "Ia") for joint in ("hip", "knee")]
    values = np.array([0.01, 0.02, 1e-3, 2e-3, 1e-4, 2e-4])
    q, v, a = RNG.normal(size=(3, 40, 2))
    columns = model.regressor(q, v, a)[..., [model.names.index(name) for name in names]]
    inverse = np.linalg.inv(np.array(MATRIX))
    speed, acceleration = v @ inverse.T, a @ inverse.T
    of_motors = values[:2] * np.tanh(speed / (0.015 * COUPLING.ratio)) + values[2:4] * speed + values[4:] * acceleration
    np.testing.assert_allclose(columns @ values, of_motors @ inverse, rtol=1e-10)
    power = ((columns[..., :4] @ values[:4]) * v).sum(axis=1)
    assert (power >= 0.0).all(), "friction of motors dissipates energy"


@pytest.mark.parametrize("scale", [1.0, 100.0])
def test_viscous_friction_of_both_sides_has_one_combination_too_many(scale: float) -> None:
    """A symmetric matrix of two joints has three numbers; two joints and two motors have four."""
    coupling = Coupling(("hip", "knee"), scale * np.array(MATRIX))
    model = TorqueModel(LEG, (Viscous(), *motor_terms(coupling)[:2]))
    assert [one.name for one in model.regrouped] == ["d_knee_motor"]
    into = model.regrouped[0].into
    assert set(into) == {"d_hip", "d_knee", "d_hip_motor"}
    free = [name for name, never in zip(model.names, model.nonnegative, strict=True) if not never and name in into]
    assert free == ["d_hip_motor"], "it contains a share of minus d_knee_motor"


def test_a_motor_that_moves_one_joint_alone_has_the_terms_of_that_joint() -> None:
    belt = Coupling(("hip", "knee"), ((0.1, 0.0), (0.1, 0.1)))  # the knee's motor sits on the torso
    friction, rotor = motor_terms(belt)
    names = ("hip", "knee")
    assert friction.places(names, names) == rotor.places(names, names) == {"knee_motor": (0, 1)}
    assert isinstance(friction, CouplingFriction)
    assert friction.ratios == pytest.approx((-10.0, 10.0))


def test_reversals_of_a_motor_are_those_of_its_velocity() -> None:
    v = np.column_stack([np.ones(100), np.linspace(-2.0, 2.0, 100)])
    slow = CouplingFriction(joints=("hip", "knee"), ratios=(1.0, 1.0), reversal_speed=0.1).reversing(v)
    assert slow is not None
    of_motor = np.abs(v.sum(axis=1))
    assert slow[of_motor <= 0.05].all()
    assert not slow[of_motor > 0.15].any()


def test_controllers_compensate_friction_and_rotors_of_motors() -> None:
    model = TorqueModel(LEG, (*motor_terms(COUPLING), Viscous()))
    values = np.append(LEG.parameters, np.linspace(0.01, 0.2, len(model.names) - 6))
    control = exoid.control.ControlModel.of_parameters(model, values)
    q, v, a = np.array([[0.1, 0.2], [0.7, -0.4], [0.5, 0.3]])
    still = np.zeros((1, 2))
    expected = (model.columns(model.motion(q[None], v[None], still)).T @ np.where(model.friction, values, 0.0))[0]
    np.testing.assert_allclose(control.friction(q, v, 0.02), expected, rtol=1e-9)
    of_rotors = model.regressor(q[None], still, a[None]) - model.regressor(q[None], still, still)
    np.testing.assert_allclose(control.mass_matrix(q) @ a, (of_rotors @ values)[0], rtol=1e-9)


def test_a_series_spring_measures_torque_by_its_deflection() -> None:
    drive = SeriesElastic(300.0, ratio=-50.0)
    q, torque = RNG.uniform(-1.0, 1.0, 20), RNG.uniform(-30.0, 30.0, 20)
    angle = drive.command(torque, q, q)
    np.testing.assert_allclose(angle / -50.0 - q, torque / 300.0, rtol=1e-9)
    np.testing.assert_allclose(drive.torque(angle, q, q), torque, rtol=1e-9)
    with pytest.raises(exoid.ExoidError, match="deflection"):
        drive.torque(np.rad2deg(angle), q, q)
