"""Many virtual rigs at once against MuJoCo's rollout of the same leg: ``pytest tests/benchmarks/test_rollout.py -s``.

The same one leg, friction, rotor and torques, the same steps, every state kept, one thread each. Our joints stick
exactly and our step is of second order; MuJoCo's friction is its softened constraint, its integrator semi-implicit
Euler, both as by default.
"""

import mujoco
import mujoco.rollout
import numpy as np
import pytest
from turns import best_of_turns, show

import exoid
from exoid.leg.catalog import URDFS, urdf_folder
from exoid.rig import Plant, Stepper

RIGS, STEPS, ROUNDS, DT = 256, 400, 5, 5e-4
RATIO = 4.0
"""Below this something has become slower."""

LEG = exoid.load_leg("bleex")
POSE = np.array([0.3, -0.5, 0.1])
PLANT = Plant.build(LEG, {"c0_hip": 2.0, "c0_knee": 1.5, "c0_ankle": 0.5, "d_hip": 0.1, "Ia_hip": 0.1}, end_stops=False)
TIME = DT * np.arange(STEPS)
SWING = np.array([14.0, 7.0, 1.5]) * np.sin(2 * np.pi * np.array([0.5, 0.7, 0.9]) * TIME[:, None])
TORQUE = SWING[:, :, None] * np.random.default_rng(0).uniform(0.7, 1.3, (3, RIGS))
"""Each rig's own [N·m], (steps, 3, rigs)."""


def ours() -> np.ndarray:
    """Angles and velocities, (steps, 6, rigs)."""
    path = np.empty((STEPS, 6, RIGS))
    rig = Stepper(PLANT.repeat(RIGS), np.tile(POSE[:, None], RIGS), np.zeros((3, RIGS)), DT)
    undamped = np.zeros((3, RIGS))
    for torque, state in zip(TORQUE, path, strict=True):
        rig.step(torque, undamped)
        state[:3], state[3:] = rig.q, rig.v
    return path


class Theirs:
    """The left leg of the same URDF in MuJoCo, without joint limits and contacts."""

    def __init__(self) -> None:
        spec = mujoco.MjSpec.from_file(str(urdf_folder() / URDFS["bleex", "cad"]))
        spec.delete(spec.body("right_thigh"))
        self.model = model = spec.compile()
        assert tuple(model.joint(k).name for k in range(model.njnt)) == LEG.joint_names
        model.dof_damping[:], model.dof_armature[:] = PLANT.viscous[:, 0], PLANT.armature[:, 0]
        model.dof_frictionloss[:] = PLANT.coulomb[:, 0]
        model.opt.timestep = DT
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT | mujoco.mjtDisableBit.mjDSBL_CONTACT
        self.data = mujoco.MjData(model)
        self.start = np.tile(np.concatenate([[0.0], POSE, np.zeros(3)]), (RIGS, 1))
        self.torque = np.ascontiguousarray(TORQUE.transpose(2, 0, 1))
        self.path = np.empty((RIGS, STEPS, 7))

    def run(self) -> np.ndarray:
        """Angles and velocities, (steps, 6, rigs)."""
        applied = int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)
        mujoco.rollout.rollout(
            self.model, self.data, self.start, self.torque, control_spec=applied, state=self.path, skip_checks=False
        )
        return self.path[:, :, 1:].transpose(1, 2, 0)


@pytest.fixture(scope="module")
def theirs() -> Theirs:
    return Theirs()


def test_both_swing_alike(theirs):
    path, reference = ours(), theirs.run()
    assert np.abs(path[:, :3] - reference[:, :3]).max() < 2e-3
    assert np.ptp(path[:, :3], axis=0).min() > 0.02
    assert (path[1:, 3:] == 0.0).any()  # some joint stood for a while


def test_256_rigs_take_many_times_the_steps_of_mujocos_rollout(theirs):
    names = f"{RIGS} rigs, {STEPS} steps", "MuJoCo's rollout of the same"
    best = best_of_turns(dict(zip(names, (ours, theirs.run), strict=True)), ROUNDS)
    show("Simulation of a leg with dry friction, all states kept", best, names[0])
    print("  " + ", ".join(f"{RIGS * STEPS / seconds:.2e} rig-steps/s" for seconds in best.values()))
    assert best[names[1]] >= RATIO * best[names[0]]
