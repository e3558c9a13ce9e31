"""MuJoCo finds the torques of an estimate in its file: rigid bodies, rotors and friction."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
from closed_machines import cylinder_knee, four_bar_knee, two_rod_ankle
from made_estimates import made, motion_within
from mujoco_torques import mujoco_model, mujoco_torque
from public_robots import urdf_of

import exoid
from exoid import Armature, Coulomb, ExoidError, Leg, Offset, Viscous
from exoid.torques import TorqueModel

DFKI = Path(__file__).resolve().parents[2] / "urdf" / "dfki_double_pendulum.urdf"

LEGS = {
    "bleex": lambda: exoid.load_leg("bleex", "left"),
    "cuhk": lambda: exoid.load_leg("cuhk", "right"),
    "dfki": lambda: Leg.from_urdf(DFKI),
    "panda": lambda: Leg.from_urdf(urdf_of("panda"), locked={"panda_joint1": 0.4}),
    "locked": lambda: Leg.from_urdf(
        urdf_of("panda"), ("panda_joint2", "panda_joint4"), locked={"panda_joint1": 0.4, "panda_joint3": -0.5}
    ),
}
NUMBERS = {"Ia": 0.21, "c0": 0.7, "d": 0.3, "offset": 0.2}


def estimate_of(leg, terms, **numbers):
    """An estimate of the leg's own bodies and of these numbers at every joint."""
    model = TorqueModel(leg, terms)
    p = len(leg.parameter_names)
    values = np.array([{**NUMBERS, **numbers}.get(name.partition("_")[0], 0.0) for name in model.names])
    values[:p] = leg.parameters
    covariance = np.diag((0.01 * np.maximum(np.abs(values), 1e-3)) ** 2)
    return made(model, values, covariance)


@pytest.mark.parametrize("name", LEGS)
@pytest.mark.parametrize("terms", [(), (Viscous(),), (Armature(), Viscous())], ids=("bodies", "viscous", "rotors"))
def test_mujoco_finds_the_torques_of_the_estimate(name, terms, tmp_path):
    """To 1e-5 of the largest torque: MuJoCo writes six digits."""
    leg = LEGS[name]()
    est = estimate_of(leg, terms)
    assert est.to_mjcf(tmp_path / "leg.xml").urdf.lift.feasible
    model = mujoco_model(tmp_path / "leg.xml")
    q, v, a = motion_within(leg, margin=0.05)
    expected = est.torque(q, v, a)
    np.testing.assert_allclose(
        mujoco_torque(model, leg.joint_names, q, v, a, leg.locked), expected, rtol=0, atol=1e-5 * np.abs(expected).max()
    )


def test_rotors_and_friction_stand_at_the_joints_and_not_in_a_urdf(tmp_path):
    est = estimate_of(exoid.load_leg("bleex", "left"), (Coulomb(), Viscous(), Armature(), Offset()))
    export = est.to_mjcf(tmp_path / "leg.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "leg.xml"))
    joints = [model.joint(name).dofadr[0] for name in est.joint_names]
    np.testing.assert_array_equal(model.dof_frictionloss[joints], 0.7)
    np.testing.assert_array_equal(model.dof_damping[joints], 0.3)
    np.testing.assert_array_equal(model.dof_armature[joints], [0.0, 0.21, 0.21])  # that of the hip is part of J1
    assert export.left_out == ("offset_hip", "offset_knee", "offset_ankle")
    assert "no place for offset_hip" in str(export)
    assert "Ia_hip" in str(export)


def test_a_simulated_joint_sticks_until_its_coulomb_friction_is_exceeded(tmp_path):
    """Motors of the joints drive it: below the friction it hardly moves, above it does."""
    estimate_of(exoid.load_leg("cuhk", "right"), (Coulomb(),), c0=5.0).to_mjcf(tmp_path / "leg.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "leg.xml"))
    model.opt.gravity[:] = 0.0
    moved = []
    for torque in (4.0, 6.0):
        data = mujoco.MjData(model)
        data.ctrl[:] = [torque, 0.0]
        for _ in range(100):
            mujoco.mj_step(model, data)
        moved.append(abs(data.qvel[model.joint("right_hip").dofadr[0]]))
    assert moved[0] < 0.01
    assert moved[1] > 0.05


def test_friction_below_zero_is_written_as_zero_and_said(tmp_path):
    est = estimate_of(exoid.load_leg("cuhk", "right"), (Viscous(),), d=-0.1)
    export = est.to_mjcf(tmp_path / "leg.xml")
    assert export.negative == ("d_hip", "d_knee")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "leg.xml"))
    assert not any(model.joint(name).damping[0] for name in est.joint_names)
    assert "below zero: 0 in the file" in str(export)


def test_a_floating_base_is_refused(tmp_path):
    est = estimate_of(exoid.load_exo("cuhk", base="floating"), ())
    with pytest.raises(ExoidError, match=r"floating base is not written.*free joint"):
        est.to_mjcf(tmp_path / "leg.xml")
    assert not (tmp_path / "leg.xml").exists()


@pytest.mark.slow
@pytest.mark.parametrize("make", [four_bar_knee, two_rod_ankle, cylinder_knee])
def test_mujoco_closes_the_loops_of_a_closed_leg(make, tmp_path):
    """At rest its acceleration under the motors' torque is that of exoid."""
    leg = make(0).leg(tmp_path)
    estimate = estimate_of(leg, (Armature(),))
    estimate.to_mjcf(tmp_path / "out.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out.xml"))
    state, rng = mujoco.MjData(model), np.random.default_rng(0)
    q = leg.closure.reachable(rng.uniform(-0.04, 0.04, (1, len(leg.joint_names))))
    for joint, angle in zip(leg.tree_joint_names, leg.tree_motion(q).q[0], strict=True):
        state.qpos[model.joint(joint).qposadr[0]] = angle
    state.ctrl[:] = estimate.torque(q, 0.0 * q, 0.0 * q)[0] + rng.uniform(-2.0, 2.0, q.shape[1])
    mujoco.mj_forward(model, state)
    change = np.array([[state.qacc[model.joint(joint).dofadr[0]] for joint in leg.joint_names]])
    np.testing.assert_allclose(estimate.torque(q, 0.0 * q, change)[0], state.ctrl, rtol=0.0, atol=0.02)
    for _ in range(100):
        mujoco.mj_step(model, state)
    pose = np.array([[state.qpos[model.joint(joint).qposadr[0]] for joint in leg.tree_joint_names]])
    assert leg.closure.gap(pose).max() < 1e-4
