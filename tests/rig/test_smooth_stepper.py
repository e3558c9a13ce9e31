"""Coupled motors of the stepper that studies of drives take for the truth: gears, and balance of energy."""

from functools import partial

import numpy as np
import pytest
from rigs import BLEEX, POSE, torque, zeros
from smooth_stepper import CoupledMotors, SmoothStepper

import exoid
from exoid.actuators import Coupling
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, simulate

pytestmark = pytest.mark.slow


DT = 5e-4


def _run(stepper, steps=2000):
    """Drive a stepper by the same torques, and collect its angles."""
    angles = []
    for k in range(steps):
        stepper.step(torque(k * DT), zeros(stepper.plant))
        angles.append(stepper.q[:, 0].copy())
    return np.array(angles)


def test_motors_of_a_diagonal_coupling_are_gears_of_single_joints():
    """Friction c and d and rotor J behind ratio r are r c, r² d and r² J at the joint."""
    r = 5.0
    coupling = Coupling(BLEEX.joint_names, np.diag([1.0 / r, 1.0 / r, 1.0 / r]))
    at_motors = CoupledMotors(coupling, coulomb=(0.2, 0.1, 0.02), viscous=0.004, rotor=0.002)
    at_joints = {"c0_hip": 1.0, "c0_knee": 0.5, "c0_ankle": 0.1}
    at_joints |= {f"{symbol}_{j}": value for j in BLEEX.joint_labels for symbol, value in (("d", 0.1), ("Ia", 0.05))}
    plain, geared = Plant.build(BLEEX, end_stops=False), Plant.build(BLEEX, at_joints, end_stops=False)
    start = (POSE, zeros(plain), DT)
    coupled = SmoothStepper(plain, *start, motors=at_motors)
    alone = _run(coupled)
    np.testing.assert_allclose(alone, _run(SmoothStepper(geared, *start)), atol=1e-9)
    two = plain.repeat(2)
    both = _run(SmoothStepper(two, np.tile(POSE, 2), zeros(two), DT, motors=at_motors), 300)
    np.testing.assert_allclose(both, alone[:300], atol=1e-10)


def test_energy_is_balanced_with_friction_and_rotors_of_both_sides():
    leg = exoid.load_leg("cuhk")
    motors = CoupledMotors(
        Coupling(("hip", "knee"), ((0.1, 0.1), (0.1, -0.1))), coulomb=0.05, viscous=0.01, rotor=0.002
    )
    plant = Plant.build(leg, {"c0_hip": 1.0, "d_knee": 0.3}, end_stops=False)

    class Motion:
        def at(self, time: float) -> exoid.rig.Target:
            angle = np.array([[0.4 * np.sin(3.0 * time)], [0.6 + 0.4 * np.cos(4.0 * time)]])
            return exoid.rig.Target(angle, np.array([[1.2 * np.cos(3.0 * time)], [-1.6 * np.sin(4.0 * time)]]))

    run = simulate(
        plant,
        Motion(),
        ProportionalDerivative(300.0, 20.0),
        IdealTorque(),
        3.0,
        stepper=partial(SmoothStepper, motors=motors),
    )
    assert run.energy.dissipated[0] > 1.0
    assert run.energy.relative_error[0] < 1e-3
