"""Payloads add their weight and inertia to a leg, and nothing else."""

import numpy as np
import pinocchio as pin
import pytest
from loaded_legs import with_payloads

import exoid
from exoid.rig import Payload

LOADS = (Payload("hip", 2.0, (0.05, 0.1, -0.2), 0.04), Payload("left_knee", 1.5, (-0.02, 0.0, -0.3)))


def welded(leg, loads):
    """The same by Pinocchio's own addition of bodies."""
    model = leg.model.copy()
    for load in loads:
        name = load.joint if load.joint.startswith("left_") else f"left_{load.joint}"
        inertia = pin.Inertia(load.mass, np.array(load.position), load.mass * load.gyration**2 * np.eye(3))
        model.inertias[model.getJointId(name)] = model.inertias[model.getJointId(name)] + inertia
    return model


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_a_loaded_leg_moves_as_pinocchio_says(name):
    leg = exoid.load_leg(name)
    loaded, model = with_payloads(leg, LOADS), welded(leg, LOADS)
    data = model.createData()
    for q, v, a in np.random.default_rng(0).uniform(-1.0, 1.0, (10, 3, len(leg.joint_names))):
        np.testing.assert_allclose(loaded.inverse_dynamics(q, v, a)[0], pin.rnea(model, data, q, v, a), atol=1e-12)
