"""Actuators: torque, limits, and what the hydraulic servo does in a closed loop."""

import numpy as np
import pytest
from rigs import BLEEX, EVERYTHING, Swing

import exoid
from exoid.experiments import Hold
from exoid.rig import HydraulicServo, IdealTorque, Plant, ProportionalDerivative, Rates, Target, simulate

pytestmark = pytest.mark.slow

KH, CL, KV = 5000.0, 0.01, 10.0
"""Oil stiffness, leakage and valve gain; with Kp = 1 a bandwidth of 10 1/s and a static stiffness of 1000 N·m/rad."""

ANKLE = exoid.Leg.from_description(BLEEX.description, ("left_ankle",))
STATE = np.zeros((3, 2))


def test_ideal_torque_is_the_command_up_to_its_limit():
    command = np.array([[1.0, -1.0], [7.0, -7.0], [0.0, 5.0]])
    drive = IdealTorque(limit=5.0).drive(STATE, command, 1e-3)
    np.testing.assert_array_equal(drive.torque, [[1.0, -1.0], [5.0, -5.0], [0.0, 5.0]])
    np.testing.assert_array_equal(drive.damping, 0.0)


def servo_run(leakage, duration, *, gain=KV, load=0.0, step=2.5e-4, amplitude=0.0):
    """The ankle, weightless, under P control of gain 1 V/rad, holding zero or following a sine of 10 rad/s."""

    class Sine:
        def at(self, time):
            return Target(
                np.full((1, 1), amplitude * np.sin(10.0 * time)),
                np.full((1, 1), 10.0 * amplitude * np.cos(10.0 * time)),
            )

    plant = Plant.build(ANKLE, {"b0_ankle": load, "Y1": 0.0, "X1": 0.0}, end_stops=False)
    servo = HydraulicServo(KH, leakage, gain)
    start = np.full((1, 1), 1e-3 if load == 0.0 and amplitude == 0.0 else 0.0)
    rates = Rates(control=1.0 / step, log=200.0, step=step)
    return simulate(plant, Sine(), ProportionalDerivative(1.0), servo, duration, start=start, rates=rates)


def test_static_stiffness_of_the_servo_is_valve_gain_over_leakage():
    load = 20.0
    run = servo_run(CL, 2.5, load=load, step=5e-4)
    assert -load / run.q[-1, 0, 0] == pytest.approx(KV / CL, rel=1e-6)
    assert run.tau[-1, 0, 0] == pytest.approx(load, rel=1e-6)


def test_bandwidth_of_the_servo_is_valve_gain_times_controller_gain():
    """At 10 rad/s a lag of 10 1/s leaves 1/√2 of the amplitude; oil stiffness and inertia change that by a percent."""
    run = servo_run(CL, 4.0, amplitude=0.05, step=5e-4)
    late = run.time > 2.0
    waves = np.column_stack([np.sin(10.0 * run.time[late]), np.cos(10.0 * run.time[late])])
    s, c = np.linalg.lstsq(waves, run.q[late, 0, 0], rcond=None)[0] / 0.05
    J = ANKLE.parameters[2]  # transfer function of the linear servo, Kv kh / (J s³ + kh cl J s² + kh s + Kv kh)
    jw = 10.0j
    expected = KV * KH / (J * jw**3 + KH * CL * J * jw**2 + KH * jw + KV * KH)
    assert abs(s + 1j * c - expected) < 5e-3
    assert abs(s + 1j * c) == pytest.approx(np.sqrt(0.5), rel=0.05)


@pytest.mark.parametrize(("leakage", "grows"), [(1.3 * KV / KH, False), (0.5 * KV / KH, True), (0.3 * KV / KH, True)])
def test_the_servo_is_stable_only_if_its_leakage_is_fast_enough(leakage, grows):
    """Routh: J s³ + kh cl J s² + kh s + Kv Kp kh is stable if and only if kh cl > Kv Kp."""
    run = servo_run(leakage, 3.0, step=5e-4)
    first, last = (np.abs(run.q[rows]).max() for rows in (slice(60), slice(-60, None)))
    assert (last > 2.0 * first) if grows else (last < 0.3 * first)


def test_proportional_control_with_the_printed_sign_runs_away():
    """Document 2 prints τ = K (θ − θ_ref): positive feedback."""
    leg = exoid.load_leg("cuhk")
    plant = Plant.build(leg, {"d_hip": 0.038, "d_knee": 0.192})
    pose, start = np.deg2rad([[20.0], [20.0]]), np.deg2rad([[21.0], [21.0]])
    distances = []
    for gain in (150.0, -150.0):
        run = simulate(plant, Hold(pose), ProportionalDerivative(gain), IdealTorque(), 1.0, start=start)
        distances.append(np.abs(run.q[-1] - pose).max())
    assert distances[0] < np.deg2rad(10.0)
    assert distances[1] > np.deg2rad(20.0)  # at the end stops


@pytest.mark.parametrize("actuator", ["ideal", pytest.param("servo", marks=pytest.mark.nightly)])
def test_energy_balances(actuator):
    """Work in = gain of mechanical energy + dissipated, to 1e-4 of the turnover."""
    plant = Plant.build(BLEEX, EVERYTHING)
    law, drive = {
        "ideal": (ProportionalDerivative(150.0), IdealTorque()),
        "servo": (ProportionalDerivative(1.0), HydraulicServo(KH, CL, KV)),
    }[actuator]
    run = simulate(plant, Swing(), law, drive, 20.0, rates=Rates(step=2e-3))
    assert np.ptp(run.q, axis=0).min() > 0.05
    assert run.energy.dissipated[0] > 10.0
    assert run.energy.relative_error[0] <= 1e-4
