"""A scene draws the leg where Pinocchio says it is, with its inertias and forces, whatever URDF it comes from."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from drawings import meshes, mounts, objects, places, root, scene_of, unpacked
from planar_chains import random_chain
from public_robots import urdf_of

import exoid
from exoid import Leg, Recording, TorsoMotion
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.description import describe
from exoid.view import scene
from exoid.view.colours import CAD, IDENTIFIED
from exoid.view.report.identification import _replay
from exoid.view.scenes.leg_geometry import STEEL
from exoid.view.scenes.page import _viewer_file as viewer_file
from exoid.view.scenes.skeleton import Skeleton

RNG = np.random.default_rng(6)
TIME = np.arange(90) / 60.0


def robot(name, joints=None):
    return Leg.from_urdf(urdf_of(name), joints)


LEGS = {
    "bleex": lambda: exoid.load_leg("bleex"),
    "cuhk": lambda: exoid.load_leg("cuhk", "right"),
    "both legs, floating": lambda: exoid.load_exo("bleex", base="floating"),
    "double pendulum": lambda: exoid.Leg.from_urdf("urdf/dfki_double_pendulum.urdf"),
    "continuous joints": lambda: random_chain(np.random.default_rng(3), 4).leg(),
    "sliding joint": lambda: robot("tiago_no_hand", ("torso_lift_joint", "arm_1_joint", "arm_2_joint")),
}


@pytest.fixture(params=LEGS, scope="module")
def leg(request):
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(Path(__file__).parents[2])
        return LEGS[request.param]()


def body_paths(leg, drawn):
    """Path of each moving body, from the torso outwards."""
    return mounts(drawn), [f"{mount}/body" for mount in mounts(drawn)]


def motion(leg, time=TIME):
    """A motion of all joints, with torques."""
    phase = RNG.uniform(0.0, 6.0, len(leg.joint_names))
    q = 0.6 * np.sin(2.0 * np.pi * 0.8 * time[:, np.newaxis] + phase)
    return Recording(
        time=time, q=q, tau=3.0 * np.cos(q) * np.cos(5.0 * time[:, np.newaxis]), joint_names=leg.joint_names
    )


def test_a_replay_shows_each_pose_at_its_time(leg):
    recording = motion(leg)
    drawn = scene(leg, recording=recording)
    assert drawn.duration == pytest.approx(recording.duration, abs=1.0 / 30.0)
    for frame in (0, 7, 30, 43):
        rotation, translation = leg.forward_kinematics(recording.q[2 * frame])  # 60 Hz against 30 frames a second
        found = places(drawn, frame / 30.0)
        for j, path in enumerate(body_paths(leg, drawn)[1]):
            np.testing.assert_allclose(found[path][:3, :3], rotation[0, j], atol=2e-4)
            np.testing.assert_allclose(found[path][:3, 3], translation[0, j], atol=2e-4)


def test_axes_are_drawn_along_the_joint_axes(leg):
    drawn = scene(leg)
    found = places(drawn)
    data = leg.model.createData()
    pin.forwardKinematics(leg.model, data, pin.neutral(leg.model))
    pin.computeJointJacobians(leg.model, data, pin.neutral(leg.model))
    for j, mount in enumerate(body_paths(leg, drawn)[0]):
        J = pin.getJointJacobian(leg.model, data, j + 1, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        column = J[:, leg.model.joints[j + 1].idx_v]
        axis = column[3:] if np.linalg.norm(column[3:]) > 0.5 else column[:3]
        ((geometry, _, place),) = meshes(objects(drawn)[f"{mount}/axis"])
        assert geometry["type"] == "CylinderGeometry"  # whose length is along y
        np.testing.assert_allclose(np.abs((found[f"{mount}/axis"] @ place)[:3, 1] @ axis), 1.0, atol=1e-4)


def test_ellipsoids_have_the_inertia_and_balls_the_mass_of_the_body(leg):
    """Pinocchio's inertia of a solid ellipsoid is the truth; bodies that cannot exist are left out."""
    drawn = scene(leg)
    for j, path in enumerate(body_paths(leg, drawn)[1], start=1):
        inertia = leg.model.inertias[j]
        ((_, _, ball),) = meshes(objects(drawn)[f"{path}/mass CAD"])
        radius = ball[0, 0]
        assert STEEL * 4.0 / 3.0 * np.pi * radius**3 == pytest.approx(inertia.mass, rel=1e-4)
        np.testing.assert_allclose(ball[:3, 3], inertia.lever, atol=1e-5)
        moments = np.linalg.eigvalsh(inertia.inertia)
        if moments[2] > 0.99 * (moments[0] + moments[1]):
            continue
        (_, _, place), *rings = meshes(objects(drawn)[f"{path}/inertia CAD"])
        circle = np.array([[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.6, 0.8, 0.0, 1.0]]).T
        for _, material, ring in rings:
            np.testing.assert_allclose(
                np.linalg.norm(np.linalg.solve(place, ring @ circle)[:3], axis=0), 1.0, atol=1e-3
            )
            assert "opacity" not in material  # colours of rings do not mix where ellipsoids overlap
        assert len(rings) == 3
        axes = np.linalg.norm(place[:3, :3], axis=0)
        turned = pin.SE3(place[:3, :3] / axes, place[:3, 3])
        solid = turned.act(pin.Inertia.FromEllipsoid(inertia.mass, *axes))
        scale = np.abs(inertia.inertia).max()
        np.testing.assert_allclose(solid.inertia, inertia.inertia, atol=1e-4 * scale)
        np.testing.assert_allclose(solid.lever, inertia.lever, atol=1e-5)


@pytest.mark.parametrize("pitch", [0.0, 0.4])
def test_weights_point_down_from_the_centres_of_mass(pitch):
    leg = exoid.load_leg("bleex")
    still = Recording(time=TIME, q=np.full((90, 3), 0.3), joint_names=leg.joint_names, torso=TorsoMotion(pitch=pitch))
    drawn = scene(leg, recording=still)
    for found in (places(drawn), places(drawn, 0.5)):
        rotation, translation = leg.forward_kinematics(np.full(3, 0.3), TorsoMotion(pitch=pitch))
        for j, name in enumerate(leg.link_names):
            arrow = found[f"/exoid/left leg/weight {name}"]
            np.testing.assert_allclose(arrow[:3, 2], [0.0, 0.0, -1.0], atol=1e-4)
            centre = translation[0, j] + rotation[0, j] @ leg.model.inertias[j + 1].lever
            np.testing.assert_allclose(arrow[:3, 3], centre, atol=1e-4)


def test_torque_arrows_grow_and_turn_with_the_measured_torque():
    """The area is in proportion to the torque; the arrow of a positive torque follows the right-hand rule."""
    leg = exoid.load_leg("bleex")
    recording = motion(leg)
    drawn = scene(leg, recording=recording)
    largest = np.abs(recording.tau[::2]).max()
    assert "measured torque" in [layer.label for layer in drawn.layers]
    for frame in (3, 17, 31):
        found = places(drawn, frame / 30.0)
        for j, mount in enumerate(mounts(drawn)):
            tau, scale = recording.tau[2 * frame, j], found[f"{mount}/torque/arrow"][:3, :3]
            assert np.linalg.norm(scale[:, 0]) ** 2 == pytest.approx(abs(tau) / largest, rel=2e-3)
            (_, _, _), (_, _, head) = meshes(objects(drawn)[f"{mount}/torque/arrow"])
            tip = found[f"{mount}/torque/arrow"] @ head
            axis = found[f"{mount}/axis"] @ meshes(objects(drawn)[f"{mount}/axis"])[0][2]
            arm = tip[:3, 3] - axis[:3, 3]
            moment = np.cross(arm, tip[:3, 1]) @ leg.chain.plane.lateral  # a cone points along its y
            positive = found[mount][:3, :3] @ Skeleton(leg).axes[j] @ leg.chain.plane.lateral
            assert np.sign(moment) == np.sign(tau) * np.sign(positive)


def test_an_estimate_shows_its_links_beside_those_of_cad(data, estimate):
    drawn = scene(estimate, recording=data.test)
    p = len(data.leg.parameter_names)
    lifted = exoid.lift.lift(data.leg, estimate.values[:p], estimate.covariance[:p, :p])
    for mount, row in zip(mounts(drawn), lifted.link_parameters, strict=True):
        ((_, material, place),) = meshes(objects(drawn)[f"{mount}/body/mass identified"])
        np.testing.assert_allclose(place[:3, 3], row[1:4] / row[0], atol=1e-5)
        assert material["color"] == int(IDENTIFIED[1:], 16)
        (_, material, _), *_ = meshes(objects(drawn)[f"{mount}/body/inertia CAD"])
        assert material["color"] == int(CAD[1:], 16)
        assert material["opacity"] < 0.5


@pytest.mark.slow
def test_links_fixed_by_locked_joints_are_drawn():
    """A thigh that carries the moving knee, and the fingers of a hand."""
    knee = Leg.from_urdf(Path(__file__).parents[2] / "urdf" / "bleex.urdf", ("left_knee", "left_ankle"))
    hip = objects(scene(knee))[f"{root(scene(knee))}/shape"]
    robot_ = knee.description.parse()
    count = sum(len(robot_.findall(f"link[@name='{name}']/visual")) for name in ("torso", "left_thigh"))
    assert len(meshes(hip)) == count
    panda = robot("panda", [f"panda_joint{k}" for k in range(1, 8)])
    drawn = scene(panda, meshes=urdf_of("panda").parents[1])
    hand = meshes(objects(drawn)[f"{mounts(drawn)[-1]}/body/shape"])
    assert len(hand) >= 4  # the last link, the hand and two fingers, each with a part for every colour of its file
    assert len({material["color"] for _, material, _ in hand}) >= 3
    assert drawn.notes == ()


# The page


def test_the_page_is_the_scene_with_meshcats_viewer_and_its_licence():
    drawn = scene(exoid.load_leg("bleex"), title="a </script><script>alert(1)</script> leg")
    page = drawn.html()
    assert scene_of(page)["commands"] == [dict(command) for command in drawn.to_json()["commands"]]
    assert "MeshCat" in unpacked(page, "viewer")
    assert "Three.js Authors" in page
    assert "alert(1)</script>" not in page
    assert page.count("<script") == 3
    assert len(page) < 1e6
    assert page == drawn.html()


# Errors


def test_scenes_that_cannot_be_drawn_are_refused():
    leg, right = exoid.load_leg("bleex"), exoid.load_leg("bleex", "right")
    log, long = motion(leg), Recording(0.25 * np.arange(4800), np.zeros((4800, 3)), joint_names=leg.joint_names)
    far = describe(leg.description.text.replace('radius="0.05"', 'radius="50"').replace("-0.43", "-99"))
    for call in (
        scene,
        lambda: scene(leg, pose={"knee": 0.1}),
        lambda: scene(right, recording=log),
        lambda: scene(leg, recording=log.select(("left_hip", "left_knee"))),
        lambda: scene(leg, recording=long),
        lambda: scene(Leg.from_description(far, ("left_hip", "left_knee"))),
    ):
        with pytest.raises(BadArgumentError):
            call()


def test_without_the_viewer_a_scene_names_the_extra_and_a_report_goes_without(monkeypatch, data, estimate):
    monkeypatch.setattr("exoid.view.scenes.page.find_spec", lambda name: None)
    viewer_file.cache_clear()
    for call in (scene(data.leg).html, lambda: scene(data.leg).serve(0)):
        with pytest.raises(NotSupportedError, match=r"pip install 'meshcat"):
            call()
    (left_out,) = _replay(estimate, data.test)
    assert "the viewer (meshcat) is not installed" in left_out.lines[0]
