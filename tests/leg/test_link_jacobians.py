"""Jacobians of links: Pinocchio's, what they do with a wrench, and which motion they allow a foot on the ground."""

import importlib

import numpy as np
import pinocchio as pin
import pytest
from free_flyers import Flight
from planar_chains import assert_relative
from planar_machines import random_machine
from public_robots import urdf_of

import exoid
from exoid import Leg
from exoid.leg.rewriting import read_inertials
from exoid.torques.motion import Motion
from exoid.torques.payloads import payload_torque

TOLERANCE = 1e-12
POINT = np.array([0.1, -0.2, 0.3])


def pinocchio_jacobian(flight, link, point):
    """Pinocchio's Jacobian of a link in its own axes, moved to a point, (N, 6, 6 + n)."""
    model, data = flight.model, flight.model.createData()
    frame = model.getFrameId(link, pin.FrameType.BODY)
    at_point = pin.SE3(np.eye(3), point).inverse().action
    found = [pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL).copy() for q in flight.q]
    return at_point @ np.array(found)


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["solo12", "hyq", "ur5", "talos"])
def test_jacobians_of_all_links_are_pinocchios(robot, monkeypatch):
    monkeypatch.setattr(importlib.import_module("exoid.leg.reduction.tree_motion"), "BLOCK", 7)
    joints = None if robot != "talos" else ("leg_left_1_joint", "leg_left_4_joint", "leg_right_6_joint")
    locked = {"leg_left_2_joint": 0.4} if robot == "talos" else None
    leg = Leg.from_urdf(urdf_of(robot), joints, locked=locked, base="floating")
    held = Leg.from_urdf(urdf_of(robot), joints, locked=locked)
    flight = Flight.random(leg, np.random.default_rng(0), 17)
    q = flight.joints[0]
    links = [element.get("name") for element in leg.description.parse().findall("link")]
    for link in links[:: 1 + len(links) // 30]:
        expected = pinocchio_jacobian(flight, link, POINT)
        assert_relative(leg.frame_jacobian(q, link, POINT), expected, TOLERANCE)
        np.testing.assert_allclose(held.frame_jacobian(q, link, POINT), expected[..., 6:], atol=TOLERANCE)


@pytest.mark.parametrize("seed", range(6))
def test_those_of_a_planar_machine_are_per_unit_of_its_own_coordinates(seed):
    rng = np.random.default_rng(seed)
    leg = random_machine(rng).leg()
    flight = Flight.random(leg, rng, 10, within_plane=True)
    q, v, _ = flight.joints
    u, omega = flight.v[:, :3], flight.v[:, 3:6]
    hip = u + np.cross(omega, leg.hip)
    rates = np.column_stack([hip @ leg.plane.forward, hip @ leg.plane.up, -omega @ leg.plane.lateral, v])
    for link in read_inertials(leg.description):
        expected = np.einsum("nij,nj->ni", pinocchio_jacobian(flight, link, POINT), flight.v)
        found = np.einsum("nij,nj->ni", leg.frame_jacobian(q, link, POINT), rates)
        np.testing.assert_allclose(found, expected, atol=1e-11)


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_a_force_on_a_foot_is_that_of_gravity_on_a_body_there(name):
    exo = exoid.load_exo(name, base="floating")
    last = exo.link_names[-1]
    q = np.random.default_rng(1).normal(size=(20, len(exo.joint_names)))
    load = exoid.Payload(last, 3.0, position=tuple(POINT))
    still = np.zeros_like(q)
    added = payload_torque(exo, (load,), Motion(q, still, still, None))
    J = exo.frame_jacobian(q, last, POINT)
    placements = exo.forward_kinematics(q).rotation[:, -1]
    weight = np.concatenate([placements.swapaxes(1, 2) @ [0.0, 0.0, -3.0 * 9.81], still[:, :3]], axis=1)
    assert_relative(added, -np.einsum("nir,ni->nr", J, weight), TOLERANCE)


@pytest.mark.parametrize("planar", [True, False])
def test_a_link_that_a_contact_holds_stays_where_it_is(planar):
    leg = exoid.load_exo("bleex", base="floating") if planar else Leg.from_urdf(urdf_of("solo12"), base="floating")
    link = "left_foot" if planar else "FL_FOOT"
    n, b = len(leg.joint_names), leg.base_rows
    rng = np.random.default_rng(2)
    q, v = rng.normal(size=(2, 1, n))
    J = leg.contact_jacobian(q, link)
    assert J.shape == (1, b, b + n)
    rates = np.concatenate([-np.linalg.solve(J[0, :, :b], J[0, :, b:] @ v[0]), v[0]])
    np.testing.assert_allclose(J[0] @ rates, 0.0, atol=1e-12)
    twist = leg.frame_jacobian(q, leg.description.root_link)[0, :, :b] @ rates[:b]  # of the root link
    flight, step = Flight.random(leg, rng, 1), 1e-6
    model, data = flight.model, flight.model.createData()
    frame, at = model.getFrameId(link, pin.FrameType.BODY), np.r_[np.zeros(6), 1.0, q[0]]
    places = []
    for sign in (1.0, -1.0):
        pin.framesForwardKinematics(model, data, pin.integrate(model, at, sign * step * np.r_[twist, v[0]]))
        places.append(data.oMf[frame].copy())
    drift = pin.log6(places[1].actInv(places[0])).vector / (2.0 * step)
    np.testing.assert_allclose(drift, 0.0, atol=1e-7)
