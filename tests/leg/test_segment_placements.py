"""Frames of all joints by batched forward kinematics, against Pinocchio's loop over samples."""

import numpy as np
import pinocchio as pin
import pytest
from public_robots import urdf_of

import exoid
from exoid.leg.dynamics import joint_frames
from exoid.leg.model import configuration


def mixed() -> pin.Model:
    """Tree of all kinds of joints: oblique and continuous ones, slides, and a branch."""
    rng, model = np.random.default_rng(4), pin.Model()
    oblique = rng.standard_normal(3)
    joints = [
        pin.JointModelRevoluteUnaligned(oblique / np.linalg.norm(oblique)),
        pin.JointModelPrismaticUnaligned(np.array([0.6, 0.0, -0.8])),
        pin.JointModelRUBX(),
        pin.JointModelPY(),
        pin.JointModelRZ(),
        pin.JointModelRUBZ(),
    ]
    for k, (joint, parent) in enumerate(zip(joints, (0, 1, 2, 1, 4, 5), strict=True)):
        model.addJoint(parent, joint, pin.SE3.Random(), f"joint {k}")
    return model


MODELS = {
    "mixed": mixed,
    "two legs": lambda: exoid.load_exo("bleex", base="floating").model,
    "arm": lambda: exoid.Leg.from_urdf(urdf_of("panda"), joints=tuple(f"panda_joint{k}" for k in range(1, 8))).model,
}


@pytest.mark.parametrize("name", list(MODELS))
def test_frames_are_those_of_pinocchio(name):
    model = MODELS[name]()
    q = np.random.default_rng(0).uniform(-4.0, 4.0, (50, model.nv))
    placed, data = joint_frames(model, q.T), model.createData()
    for i, row in enumerate(configuration(model, q)):
        pin.forwardKinematics(model, data, row)
        for j in range(model.njoints - 1):
            np.testing.assert_allclose(placed.rotation[j, ..., i], data.oMi[j + 1].rotation, rtol=0.0, atol=1e-12)
            np.testing.assert_allclose(placed.translation[j, :, i], data.oMi[j + 1].translation, rtol=0.0, atol=1e-12)
