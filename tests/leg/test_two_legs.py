"""Torso and both legs in one tree, from a log or a URDF to an estimate, a picture and a URDF again."""

import numpy as np
import pytest
from free_flyers import Flight
from planar_chains import assert_relative
from public_robots import urdf_of
from walking import Walk

import exoid
from exoid import Leg, Payload
from exoid.leg.description import describe
from exoid.leg.lift import lift
from exoid.leg.lift.lumping import distribute_bodies
from exoid.leg.rewriting import rewrite
from exoid.torques import Motion
from exoid.torques.payloads import payload_torque


@pytest.fixture(scope="module")
def walk():
    """A log of both legs in the plane, with an IMU on the torso."""
    return Walk(exoid.load_exo("bleex"), seconds=40.0).recording()


def test_a_walk_gives_the_documented_parameters_of_both_legs(walk):
    exo = exoid.load_exo("bleex")
    estimate = exoid.identify(exo, walk, terms=())
    assert estimate.names == exo.parameter_names
    relative = dict(zip(estimate.names, estimate.values / exo.parameters - 1.0, strict=True))
    assert max(abs(error) for name, error in relative.items() if name[0] == "X") < 0.005
    assert max(abs(error) for name, error in relative.items() if name[0] == "J") < 0.03
    assert not [finding for finding in estimate.findings if finding.severity == "error"]


@pytest.mark.parametrize("robot", ["planar", "spatial"])
def test_payloads_on_torso_and_legs_take_pinocchios_forces(robot):
    leg = (
        exoid.load_exo("bleex", base="floating")
        if robot == "planar"
        else Leg.from_urdf(urdf_of("solo12"), base="floating")
    )
    root, last = leg.description.root_link, leg.joint_names[-1]
    loads = (Payload(root, 8.0, (-0.1, 0.0, 0.4), 0.1), Payload(last, 1.5, (0.1, 0.0, -0.05)))
    flight = Flight.random(leg, np.random.default_rng(0), within_plane=robot == "planar")
    motion = Motion(*flight.joints, flight.base)
    bodies = leg.model.copy()
    for load in loads:
        body = 0 if load.joint == root else bodies.getJointId(load.joint)
        own = load.mass * load.gyration**2 * np.eye(3)
        bodies.inertias[body] += type(bodies.inertias[0])(load.mass, np.array(load.position), own)
    loaded = Leg(leg.description, bodies, leg.reduction, leg.machine, base="floating")
    expected = loaded.inverse_dynamics(*flight.joints, flight.base) - leg.inverse_dynamics(*flight.joints, flight.base)
    assert_relative(payload_torque(leg, loads, motion), expected, 1e-10)


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_links_of_changed_parameters_go_into_a_urdf_with_the_torso(name):
    exo = exoid.load_exo(name, base="floating")
    values = exo.parameters * np.random.default_rng(1).uniform(0.97, 1.03, len(exo.parameters))
    lifted = lift(exo, values)
    assert lifted.feasible
    assert lifted.links == ("torso", *exo.link_names)
    links = distribute_bodies(exo, lifted.link_parameters)
    assert set(links) == {"torso", *exo.link_names}
    text = rewrite(exo.description, links, {})
    again = Leg.from_description(
        describe(text, name="again.urdf"), exo.joint_names, base="floating", cumulative=exo.cumulative
    )
    np.testing.assert_allclose(again.parameters, values, rtol=1e-11, atol=1e-12)
