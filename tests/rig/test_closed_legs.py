"""Rigs of legs with closed loops: MuJoCo's `connect` as truth, energy, and parameters that are found again."""

import mujoco
import numpy as np
import pytest
from closed_machines import cylinder_knee, four_bar_knee, to_mjcf, two_rod_ankle

from exoid.experiments import Hold
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates, simulate

pytestmark = pytest.mark.slow

MACHINES = {"four-bar knee": four_bar_knee, "two-rod ankle": two_rod_ankle, "cylinder": cylinder_knee}


@pytest.mark.parametrize("make", MACHINES.values(), ids=MACHINES)
def test_a_closed_leg_swings_as_in_mujoco_and_keeps_its_energy(make, tmp_path):
    machine = make(0)
    leg = machine.leg(tmp_path)
    spec = to_mjcf(machine)
    spec.option.timestep, spec.option.integrator = 1e-4, mujoco.mjtIntegrator.mjINT_RK4
    for each in spec.equalities:
        each.solref[:2] = 5e-4, 1.0  # as stiff as the step allows
    model = spec.compile()
    state = mujoco.MjData(model)
    start = leg.closure.reachable(np.full((1, len(leg.joint_names)), 0.03))
    for joint, angle in zip(leg.tree_joint_names, leg.tree_motion(start).q[0], strict=True):
        state.qpos[model.joint(joint).qposadr[0]] = angle
    expected = []
    for _ in range(4):
        expected.append([state.qpos[model.joint(joint).qposadr[0]] for joint in leg.joint_names])
        mujoco.mj_step(model, state, 500)
    rates = Rates(control=1000.0, log=20.0, step=1e-3)
    plant = Plant.build(leg, end_stops=False)
    run = simulate(plant, Hold(start.T), ProportionalDerivative(0.0, 0.0), IdealTorque(), 0.15, rates=rates)
    travelled = np.abs(np.array(expected) - expected[0]).max()
    assert travelled > 0.003
    np.testing.assert_allclose(run.q[..., 0], expected, rtol=0.0, atol=1e-3 * travelled)
    kinetic = 0.5 * run.v[-1, :, 0] @ leg.mass_matrix(run.q[-1].T)[0] @ run.v[-1, :, 0]
    assert abs(run.energy.gain[0]) < 1e-3 * kinetic
