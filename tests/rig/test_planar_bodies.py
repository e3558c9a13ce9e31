"""Batched planar dynamics against Pinocchio's."""

import numpy as np
import pinocchio as pin
import pytest
from planar_chains import random_chain, random_motion

import exoid
from exoid import Leg
from exoid.leg.torso import tilted_gravity
from exoid.rig.planar_bodies import PlanarBodies

B = 30
SCALE = np.random.default_rng(3).uniform(0.8, 1.2, B)
"""Legs of a batch may differ; all here is linear in their parameters."""

LEGS = [
    exoid.load_leg("bleex"),
    exoid.load_leg("bleex", side="right", inertias="identified"),
    exoid.load_leg("cuhk"),
    *(random_chain(np.random.default_rng(n), n).leg() for n in (1, 2, 3, 4, 5)),
]


def bodies_of(leg: Leg, pitch: np.ndarray) -> PlanarBodies:
    return PlanarBodies.from_parameters(leg, leg.parameters[:, None] * SCALE, pitch)


@pytest.fixture(params=LEGS, ids=lambda leg: f"{leg.description.name}-{len(leg.joint_names)}")
def leg(request):
    return request.param


@pytest.fixture
def motion(leg):
    q, v, _ = random_motion(np.random.default_rng(1), len(leg.joint_names), B)
    return q, v, np.random.default_rng(2).uniform(-1.0, 1.0, B)


def test_mass_matrix_and_bias_are_pinocchios(leg, motion):
    q, v, pitch = motion
    M, bias = bodies_of(leg, pitch).dynamics(q.T, v.T)
    expected = SCALE[:, None, None] * leg.mass_matrix(q)
    np.testing.assert_allclose(np.moveaxis(M, -1, 0), expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    model = pin.Model(leg.model)
    data = model.createData()
    torque = np.empty_like(q)
    for k in range(B):
        model.gravity.linear = tilted_gravity(leg.plane, pitch[k])
        torque[k] = SCALE[k] * pin.nonLinearEffects(model, data, q[k], v[k])
    np.testing.assert_allclose(bias.T, torque, rtol=0, atol=1e-12 * np.abs(torque).max())


def test_energy_is_pinocchios_up_to_a_constant(leg, motion):
    q, v, pitch = motion
    model = pin.Model(leg.model)
    data = model.createData()
    expected = np.empty((2, B))
    for k in range(B):  # the constant depends on the tilt: differences from the pose zero
        model.gravity.linear = tilted_gravity(leg.plane, pitch[k])
        still = pin.computePotentialEnergy(model, data, pin.neutral(model))
        expected[0, k] = pin.computePotentialEnergy(model, data, q[k]) - still
        expected[1, k] = pin.computeKineticEnergy(model, data, q[k], v[k])
    expected *= SCALE
    bodies = bodies_of(leg, pitch)
    zero = np.zeros_like(q.T)
    potential = bodies.energy(q.T, zero) - bodies.energy(zero, zero)
    kinetic = bodies.energy(q.T, v.T) - bodies.energy(q.T, zero)
    np.testing.assert_allclose(potential, expected[0], rtol=0, atol=1e-12 * max(1.0, np.abs(expected[0]).max()))
    np.testing.assert_allclose(kinetic, expected[1], rtol=0, atol=1e-12 * np.abs(expected).max())
