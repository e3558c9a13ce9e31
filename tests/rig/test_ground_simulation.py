"""A machine on the ground obeys the equation of motion, bears its weight, and keeps its books."""

from dataclasses import replace

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from ground_machines import inverse_dynamics_residual, residual, spatial_plant
from processes import run_python

from exoid.experiments.ground import bleex_machine
from exoid.rig import Rates
from exoid.rig.ground import (
    Block,
    GroundMotion,
    GroundPlant,
    GroundSensors,
    JointGains,
    Sole,
    Spring,
    simulate_on_ground,
)
from exoid.rig.ground.engine import Engine

pytestmark = pytest.mark.slow

PLANT = bleex_machine()
GAINS = JointGains((2000.0, 2000.0, 1500.0), (60.0, 60.0, 40.0))
STAND = np.array([0.45, -0.65, 0.45] * 2)
PITCH = -0.25
HOLD = Spring((0.0, 0.0, 0.3), (5000.0, 5000.0, 5000.0), (300.0, 300.0, 300.0), 800.0, 60.0)


def motion(seconds=2.0, squat=0.0, height=0.912, pitch=PITCH, lead=-1.0):
    """Squats with flat feet; without a size, standing."""
    time = np.linspace(lead, seconds, round(100 * (seconds - lead)) + 1)
    s = squat * np.where(time > 0.0, 1.0 - np.cos(2.0 * np.pi * 0.8 * time), 0.0)
    q = np.tile(np.column_stack([STAND[0] + s, STAND[1] - 2.0 * s, STAND[2] + s]), 2)
    base = np.column_stack([np.zeros_like(time), np.full_like(time, height), np.full_like(time, pitch)])
    return GroundMotion(time, q, np.zeros_like(q), base)


@pytest.fixture(scope="module")
def standing():
    return simulate_on_ground(PLANT, motion(seconds=4.0, lead=-3.0), GAINS, spring=None)


@pytest.fixture(scope="module")
def in_space():
    return simulate_on_ground(spatial_plant(), motion(squat=0.05), JointGains(1500.0, 50.0), spring=HOLD)


def test_a_standing_machine_bears_its_weight_below_its_centre_of_mass(standing):
    weight = 9.81 * sum(body.mass for body in PLANT.leg.model.inertias)
    forces = sum(foot.force[-1] for foot in standing.feet.values())
    np.testing.assert_allclose(forces, [0.0, 0.0, weight], rtol=0, atol=1e-3 * weight)
    model, data = PLANT.leg.model, PLANT.leg.model.createData()
    pin.centerOfMass(model, data, standing.q[-1])
    legs = sum(body.mass for body in list(model.inertias)[1:])
    within = (legs * data.com[0] + model.inertias[0].mass * model.inertias[0].lever) / (weight / 9.81)
    centre = standing.position[-1] + standing.rotation[-1] @ within
    pressure = np.mean([foot.centre_of_pressure[-1] for foot in standing.feet.values()], axis=0)
    np.testing.assert_allclose(pressure[0], centre[0], rtol=0, atol=1e-4)


def test_the_engine_has_the_mass_matrix_and_the_bias_of_pinocchio():
    engine, rng = Engine(PLANT, 5e-4), np.random.default_rng(0)
    q, rate, pitch = rng.normal(size=6), rng.normal(size=9), 0.4
    engine.place(q, np.array([0.3, 3.0, pitch]))
    engine.rate[:] = rate
    engine.begin()
    M = np.zeros((9, 9))
    mujoco.mj_fullM(engine.model, engine.data, M)
    leg = PLANT.leg  # its base rows are forward and up in axes of the torso, and about the hip, here the origin
    turn = np.eye(9)
    turn[:2, :2] = [[np.cos(pitch), np.sin(pitch)], [-np.sin(pitch), np.cos(pitch)]]
    expected = turn.T @ leg.mass_matrix(q[None])[0] @ turn + np.diag([0.0] * 3 + PLANT.armature.tolist())
    np.testing.assert_allclose(M, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("spring", [None, HOLD], ids=["free", "held"])
def test_a_run_obeys_the_equation_of_motion(spring):
    run = simulate_on_ground(PLANT, motion(squat=0.08), GAINS, spring=spring)
    assert np.abs(residual(run)).max() < 1e-7
    assert np.abs(inverse_dynamics_residual(run)).max() < 1e-7
    assert np.abs(run.a).max() > 1.0


def test_so_does_a_machine_in_space(in_space):
    assert in_space.plant.leg.base_rows == 6
    assert np.abs(residual(in_space)).max() < 1e-3
    assert np.abs(inverse_dynamics_residual(in_space)).max() < 1e-3
    assert (in_space.base.angular_velocity.std(axis=0) > 0.005).all()


def test_the_logged_acceleration_is_the_second_difference_of_the_angles_and_the_velocity_is_of_their_time():
    rates = Rates(control=2000.0, log=2000.0, step=5e-4)
    run = simulate_on_ground(PLANT, motion(squat=0.08, seconds=0.5), GAINS, rates=rates)
    second = np.diff(run.q, 2, axis=0) * 2000.0**2
    np.testing.assert_allclose(run.a[1:-1], second, rtol=0, atol=1e-6)
    between = np.diff(run.q, axis=0) * 2000.0
    np.testing.assert_allclose(run.v[2:], 1.5 * between[1:] - 0.5 * between[:-1], rtol=0, atol=1e-9)


def test_a_plant_is_made_of_its_values():
    assert PLANT.values["c0_right_knee"] == 1.5
    assert PLANT.values["M"] == pytest.approx(49.1)
    other = GroundPlant.build(PLANT.leg, PLANT.soles, {**PLANT.values, "X1_left": 4.0, "b1_left_hip": 2.0})
    assert other.values == pytest.approx({**PLANT.values, "X1_left": 4.0, "b1_left_hip": 2.0}, rel=1e-9, abs=1e-12)
    v = np.ones((1, 6))
    expected = other.coulomb * np.tanh(1.0 / 0.02) + other.viscous + other.stiffness * 0.5
    np.testing.assert_allclose(other.resistance(0.5 * v, v)[0], expected)


def test_mujoco_is_imported_by_the_first_run_only():
    program = "import sys, exoid.experiments.ground as g; g.bleex_machine(); print('mujoco' in sys.modules)"
    assert run_python(program).strip() == "False"


def test_a_chair_and_a_step_bear_what_the_ground_does_not():
    """BLEEX stands with both feet on a block, and the seat of the torso is just pressed on another one."""
    height = 0.2
    seat = {**PLANT.soles, "torso": Sole.flat(-0.4, -0.3, -0.09)}
    low = (np.exp(1j * PITCH) * (-0.3 - 0.09j)).imag  # front of the seat below the hip; it is 3 mm into the chair
    blocks = (Block(-0.2, 0.5, height), Block(-0.9, -0.25, height + 0.921 + low + 0.003))
    on_blocks = replace(PLANT, soles=seat, blocks=blocks)
    still = motion(seconds=1.5, lead=-2.0)
    still = replace(still, base=still.base + np.array([0.0, height, 0.0]))
    run = simulate_on_ground(on_blocks, still, GAINS, spring=HOLD)
    weight = 9.81 * sum(body.mass for body in PLANT.leg.model.inertias)
    held = run.rotation[-1] @ run.wrenches["torso"].force[-1]
    assert all(foot.force[-1, 2] > 20.0 for foot in run.feet.values())
    total = sum(foot.force[-1] for foot in run.feet.values()) + held
    np.testing.assert_allclose(total, [0.0, 0.0, weight], rtol=0, atol=2e-3 * weight)
    alone = simulate_on_ground(on_blocks, still, GAINS)  # the log has what holds a seat, or else what the seat bears
    for one, true in ((run, run.wrenches["torso"]), (alone, alone.feet["torso"].wrench)):
        read = one.recording(GroundSensors.exact()).wrenches["torso"]
        np.testing.assert_allclose(read.force, true.force, rtol=0, atol=1e-9)
        assert np.abs(read.force).max() > 1.0
