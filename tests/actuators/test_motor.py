"""A motor's current becomes torque by its constants, and power is never created by a gear."""

import numpy as np
import pytest

import exoid
from exoid.actuators import Actuators, Motor

RNG = np.random.default_rng(3)


@pytest.mark.parametrize("ratio", [50.0, -50.0])
@pytest.mark.parametrize(("efficiency", "back"), [(0.85, None), (0.8, 0.6)])
def test_power_balance_in_both_directions(ratio: float, efficiency: float, back: float | None) -> None:
    """Driving, the joint receives η of the motor's power; driven back, the motor receives η_back of the joint's."""
    motor = Motor(0.07, ratio=ratio, efficiency=efficiency, back_efficiency=back)
    current, v = 4.0 * RNG.normal(size=200), RNG.choice([-1.0, 1.0], 200) * RNG.uniform(0.5, 2.0, 200)
    at_motor, at_joint = 0.07 * current * ratio * v, motor.torque(current, np.zeros(200), v) * v
    driving = at_joint > 0.0
    assert 0 < np.count_nonzero(driving) < len(driving)
    np.testing.assert_allclose(at_joint[driving], efficiency * at_motor[driving], rtol=1e-12)
    np.testing.assert_allclose(at_motor[~driving], (back or efficiency) * at_joint[~driving], rtol=1e-12)
    assert (at_motor >= at_joint - 1e-12).all(), "a gear takes power, it gives none"


def test_the_command_is_the_inverse_of_the_torque_also_near_standstill() -> None:
    motor = Motor(0.07, ratio=50.0, efficiency=0.8)
    torque, v = RNG.normal(size=100), 0.05 * RNG.normal(size=100)
    current = motor.command(torque, np.zeros(100), v)
    np.testing.assert_allclose(motor.torque(current, np.zeros(100), v), torque, rtol=1e-12)


def _recording(**given: object) -> exoid.Recording:
    time = np.arange(200) / 100.0
    q = np.column_stack([np.sin(3.0 * time), np.cos(2.0 * time)])
    return exoid.Recording(time=time, q=q, joint_names=("left_hip", "left_knee"), **given)  # type: ignore[arg-type]


def _motors() -> Actuators:
    return Actuators.of(exoid.load_leg("cuhk"), {"hip": Motor(0.1, ratio=10.0), "left_knee": Motor(0.2, ratio=10.0)})


def test_a_measured_torque_is_kept_and_a_joint_without_reading_stays_unmeasured() -> None:
    nothing, ones = np.full(200, np.nan), np.ones(200)
    tau = np.column_stack([7.0 * ones, nothing])
    both = _motors().torque(_recording(tau=tau, current=np.column_stack([ones, ones])))
    np.testing.assert_allclose(both.tau, np.column_stack([7.0 * ones, 2.0 * ones]))
    hip_only = _motors().torque(_recording(current=np.column_stack([ones, nothing])))
    assert hip_only.measured.tolist() == [True, False]


def test_a_log_without_currents_is_refused_by_the_names_of_the_columns() -> None:
    with pytest.raises(exoid.ExoidError, match=r"but force.*i_left_hip, i_left_knee \(i_ in A\)"):
        _motors().torque(_recording(force=np.ones((200, 2))))


def test_direction_of_power_comes_from_derived_velocities() -> None:
    lossy = Actuators.of(exoid.load_leg("cuhk"), {"hip": Motor(0.1, ratio=10.0, efficiency=0.8)})
    torque = lossy.torque(_recording(current=np.ones((200, 2)))).tau
    assert torque is not None
    fast = np.abs(np.cos(3.0 * np.arange(200) / 100.0)) > 0.2
    expected = np.where(np.cos(3.0 * np.arange(200) / 100.0) > 0.0, 0.8, 1.25)
    np.testing.assert_allclose(torque[fast, 0], expected[fast], rtol=1e-9)
