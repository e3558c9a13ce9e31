"""Payloads add their weight and inertia to a leg, and nothing else."""

import numpy as np
import pinocchio as pin
import pytest
from loaded_legs import with_payloads

import exoid
from exoid.rig import Payload, Plant, plant_with_payloads, sandbags

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


def test_every_rig_of_a_plant_is_loaded_alike():
    leg = exoid.load_leg("cuhk")
    light = Plant.concatenate([Plant.build(leg), Plant.build(leg, {"X2": 1.0})])
    heavy = plant_with_payloads(light, LOADS)
    difference = with_payloads(leg, LOADS).parameters - leg.parameters
    np.testing.assert_allclose(heavy.parameters - light.parameters, np.tile(difference[:, None], 2), atol=1e-12)
    assert difference[leg.parameter_names.index("X2")] == pytest.approx(1.5 * 0.3)
    assert difference[leg.parameter_names.index("J2")] == pytest.approx(1.5 * (0.3**2 + 0.02**2))


def test_sandbags_weigh_what_winter_says():
    """Of a wearer of 65 kg: 6.5 kg of thigh, 3.02 kg of shank and 0.94 kg of foot."""
    bags = sandbags()
    assert [bag.joint for bag in bags] == ["hip", "knee", "knee"]
    assert [bag.mass for bag in bags] == pytest.approx([6.5, 3.0225, 0.9425])
    assert bags[0].position[2] == pytest.approx(-0.433 * 0.245 * 1.70)
    assert bags[0].gyration == pytest.approx(0.323 * 0.245 * 1.70)
    assert [bag.mass for bag in sandbags(share=0.5)] == pytest.approx([3.25, 1.51125, 0.47125])
