"""Inverse dynamics of MuJoCo: an independent reading of a URDF or MJCF, and an algorithm of its own."""

import mujoco
import numpy as np


def mujoco_model(path):
    """Model of a URDF or MJCF without what exoid keeps apart: friction, limits, contacts, joints that mimic others."""
    model = mujoco.MjModel.from_xml_path(str(path))
    off = mujoco.mjtDisableBit
    model.opt.disableflags |= off.mjDSBL_FRICTIONLOSS | off.mjDSBL_LIMIT | off.mjDSBL_CONTACT | off.mjDSBL_EQUALITY
    return model


def mujoco_torque(model, names, q, v, a, locked=()):
    """Torques of joints by name (N, n), others held at their locked angles."""
    data, joints = mujoco.MjData(model), [model.joint(name) for name in names]
    for name, angle in dict(locked).items():
        data.qpos[model.joint(name).qposadr] = angle
    torque = np.empty_like(q)
    for i in range(len(q)):
        for k, joint in enumerate(joints):
            data.qpos[joint.qposadr], data.qvel[joint.dofadr], data.qacc[joint.dofadr] = q[i, k], v[i, k], a[i, k]
        mujoco.mj_inverse(model, data)
        torque[i] = [data.qfrc_inverse[joint.dofadr][0] for joint in joints]
    return torque
