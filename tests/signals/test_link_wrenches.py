"""Wrenches of the laboratory on links of a leg: statics, power, Pinocchio's own placements, unknown links."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from public_robots import urdf_of
from scipy.spatial.transform import Rotation

import exoid
from exoid import BaseMotion, BasePose, ExoidError, Leg, Recording, TorsoMotion, Wrench
from exoid.signals import link_placement, wrenches_on_links
from exoid.signals.link_wrenches import refuse_unknown_links

N = 60

TIME = np.arange(N) / 50.0


def links_of(leg):
    """Names of the links of a leg's URDF."""
    return tuple(link.get("name") for link in leg.description.parse().findall("link"))


def posed(leg, seed=0, torso=None, moving=True):
    """A recording of random postures, on a base with a slow random pose."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-0.8, 0.8, len(leg.joint_names)) + 0.1 * np.sin(
        np.outer(TIME, rng.uniform(1, 3, len(leg.joint_names)))
    )
    turn = Rotation.from_rotvec(0.3 * np.sin(np.outer(TIME, rng.uniform(0.5, 2, 3))))
    position = rng.normal(size=3) + 0.2 * np.sin(np.outer(TIME, rng.uniform(0.5, 2, 3)))
    force = turn.inv().apply(np.tile([0.0, 0.0, 9.81], (N, 1)))
    base = BaseMotion(np.zeros((N, 3)), force, pose=BasePose(position, turn.as_quat()))
    return Recording(TIME, q, joint_names=leg.joint_names, base=base if moving else None, torso=torso)


def by_pinocchio(leg, recording, link):
    """Placements of a link by a model whose root is a free-flyer joint."""
    base = pin.Model()
    joint = base.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "free")
    frame = base.addFrame(pin.Frame("free", joint, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    model = pin.appendModel(base, leg.model, frame, pin.SE3.Identity())
    data, wanted = model.createData(), model.getFrameId(link, pin.FrameType.BODY)
    pose = recording.base.pose
    for k in range(N):
        pin.framesForwardKinematics(model, data, np.r_[pose.position[k], pose.quaternion[k], recording.q[k]])
        yield data.oMf[wanted].copy()


@pytest.mark.parametrize("name", ["bleex", "ur5"])
def test_links_are_where_pinocchio_puts_them(name):
    leg = exoid.load_leg("bleex") if name == "bleex" else Leg.from_urdf(urdf_of(name), base="moving")
    recording = posed(leg)
    for link in links_of(leg):
        found = link_placement(leg, recording, link)
        for k, true in enumerate(by_pinocchio(leg, recording, link)):
            assert np.abs(found.rotation[k] - true.rotation).max() < 1e-12
            assert np.abs(found.translation[k] - true.translation).max() < 1e-12


@pytest.mark.parametrize("moving_point", [False, True])
def test_a_wrench_of_the_laboratory_is_turned_as_pinocchio_turns_forces(moving_point, leg):
    recording, rng = posed(leg), np.random.default_rng(1)
    force, moment = 300.0 * rng.normal(size=(N, 3)), 20.0 * rng.normal(size=(N, 3))
    point = rng.normal(size=(N, 3)) if moving_point else rng.normal(size=3)
    link = leg.link_names[-1]
    world = dataclasses.replace(recording, wrenches={link: Wrench(force, moment, point, "world")})
    found = wrenches_on_links(leg, world)[link]
    assert found.axes == "link"
    assert not found.point.any()
    points = np.broadcast_to(point, (N, 3))
    for k, place in enumerate(by_pinocchio(leg, recording, link)):
        at_point = pin.SE3(np.eye(3), points[k])
        true = place.actInv(at_point.act(pin.Force(force[k], moment[k])))
        assert np.allclose(found.columns[k], true.vector, rtol=0, atol=1e-9)


def test_a_tilted_torso_stands_in_the_laboratory_where_its_kinematics_put_it(leg):
    tilted = posed(leg, torso=TorsoMotion(pitch=0.2), moving=False)
    placements = leg.forward_kinematics(tilted.q, TorsoMotion(pitch=0.2))
    for joint, link in enumerate(leg.link_names):
        found = link_placement(leg, tilted, link)
        assert np.allclose(found.rotation, placements.rotation[:, joint], atol=1e-12)
        assert np.allclose(found.translation, placements.translation[:, joint], atol=1e-12)
    root = link_placement(leg, tilted, links_of(leg)[0])
    assert np.allclose(np.trace(root.rotation[0]), 1.0 + 2.0 * np.cos(0.2))


def test_links_that_the_leg_does_not_have_are_refused_by_name(leg):
    recording = posed(leg)
    own = Wrench(np.ones((N, 3)), np.zeros((N, 3)))
    for link in links_of(leg):
        refuse_unknown_links(leg, dataclasses.replace(recording, wrenches={link: own}, contacts={link: np.ones(N)}))
    for changes in ({"wrenches": {"left_fot": own}}, {"contacts": {"left_fot": np.ones(N)}}):
        wrong = dataclasses.replace(recording, **changes)
        with pytest.raises(ExoidError, match="of 'left_fot', which is no link of the leg; closest") as error:
            refuse_unknown_links(leg, wrong)
        assert "--column" in error.value.for_command()
        assert "left_thigh" in error.value.remedy
    with pytest.raises(ExoidError, match="'left_fot'"):
        wrenches_on_links(leg, dataclasses.replace(recording, wrenches={"left_fot": own}))
    with pytest.raises(ExoidError, match="no link 'left_fot'"):
        link_placement(leg, recording, "left_fot")
