"""A scene of a leg that stands: feet stay on the ground, arrows are the forces of the ground."""

import re
from dataclasses import replace

import numpy as np
import pytest
from closed_machines import cylinder_knee, four_bar_knee, two_rod_ankle
from drawings import meshes, objects, places, root
from public_robots import urdf_of
from scipy.spatial.transform import Rotation
from standing import session, standing

import exoid
from exoid import BaseMotion
from exoid.signals.link_wrenches import link_placements
from exoid.view import scene

FEET = ("left_foot", "right_foot")


@pytest.fixture(scope="module")
def log(exo):
    found = standing(exo, "both", seconds=4.0)
    return replace(found.recording, wrenches=found.wrenches)


@pytest.fixture(scope="module")
def estimate(exo):
    return exoid.identify(exo, [log.recording for log in session(exo, seconds=10.0)], terms=())


def foot(exo, drawn, recording, link, time):
    """Place of a foot as drawn: the drawn torso, and Pinocchio below it."""
    q = np.array([[np.interp(time, recording.time, column) for column in recording.q.T]])
    rotation, position = link_placements(exo, q, link)
    base = places(drawn, time)[root(drawn)]
    return base[:3, :3] @ rotation[0], base[:3, 3] + base[:3, :3] @ position[0]


def test_resting_feet_stay_on_the_ground_while_the_torso_moves(exo, log):
    drawn = scene(exo, recording=log)
    times = np.arange(0, 110, 7) / 30.0
    torso = [places(drawn, t)[root(drawn)][2, 3] for t in times]
    assert np.ptp(torso) > 0.03
    for link in FEET:
        found = np.array([foot(exo, drawn, log, link, t)[1] for t in times])
        assert np.abs(found - found[0]).max() < 1e-3


def test_forces_of_a_log_with_more_joints_than_the_leg_are_drawn(exo, log):
    left = exoid.Leg.from_description(exo.description, exo.joint_names[:3], base="floating")
    found, both = (lengths(scene(leg, recording=log), "measured ground force")[1] for leg in (left, exo))
    assert found == both


def lengths(drawn, label):
    """Length [m] of an arrow of a layer, and the force that it stands for [N], as the legend says."""
    (scale,) = [layer.scale for layer in drawn.layers if layer.label == label]
    length, force = re.fullmatch(r"arrow of ([0-9.]+) m = ([0-9.e+]+) N", scale).groups()
    return float(length), float(force)


def test_arrows_are_the_measured_forces_from_the_centre_of_pressure(exo, log):
    drawn = scene(exo, recording=log)
    longest, largest = lengths(drawn, "measured ground force")
    sizes = [np.linalg.norm(log.wrenches[link].force, axis=1).max() for link in FEET]
    assert largest == pytest.approx(max(sizes), rel=5e-3)
    floor = places(drawn)["/exoid/ground"][2, 3]
    for t in (0.0, 1.0, 3.0):
        k = round(t * 250)
        for link in FEET:
            path = f"/exoid/measured ground force {link}"
            arrow, start = places(drawn, t)[f"{path}/arrow"], places(drawn, t)[path][:3, 3]
            rotation, origin = foot(exo, drawn, log, link, t)
            force = rotation @ log.wrenches[link].force[k]
            np.testing.assert_allclose(arrow[:3, 2], longest * force / largest, atol=2e-3)
            moment = rotation @ log.wrenches[link].moment[k] - np.cross(start - origin, force)
            np.testing.assert_allclose(moment[:2], 0.0, atol=0.01)  # a force at the centre of pressure
            assert start[2] == pytest.approx(floor, abs=1e-3)


@pytest.mark.slow
def test_feet_on_points_carry_a_torso_that_sways_and_turns():
    """Joint angles by Newton's method for a pose of the torso; one foot is up in the second half."""
    feet = ("LF_FOOT", "RF_FOOT", "LH_FOOT", "RH_FOOT")
    leg = exoid.Leg.from_urdf(urdf_of("anymal"), base="floating", contacts=dict.fromkeys(feet, "point"))
    time = np.arange(0.0, 2.0, 0.02)
    turns = Rotation.from_euler("xyz", np.outer(np.sin(3.0 * time), [0.1, -0.08, 0.12]))
    sway = np.outer(np.sin(2.0 * time), [0.03, 0.02, -0.02])
    q = np.tile([0.0, 0.6, -1.2, 0.0, -0.6, 1.2] * 2, (len(time), 1))
    goals = [turns.inv().apply(link_placements(leg, q[:1], link).translation - sway) for link in feet]
    for _ in range(8):
        J = np.concatenate([leg.contact_jacobian(q, link)[..., 6:] for link in feet], axis=1)
        axes = [link_placements(leg, q, link) for link in feet]
        left = [
            np.einsum("nji,nj->ni", at.rotation, goal - at.translation) for at, goal in zip(axes, goals, strict=True)
        ]
        q += np.linalg.solve(J, np.hstack(left)[..., None])[..., 0]
    base = BaseMotion.from_imu(np.zeros((len(time), 3)), turns.inv().apply([0.0, 0.0, 9.81]))
    down = {link: (time < 1.0) | (link != "RH_FOOT") for link in feet}
    drawn = scene(leg, recording=exoid.Recording(time, q, joint_names=leg.joint_names, base=base, contacts=down))
    first = places(drawn, 0.0)[root(drawn)]
    for when in (0.5, 1.5, 1.9):
        now = places(drawn, when)[root(drawn)]
        k = round(when / 0.02)
        np.testing.assert_allclose(first[:3, :3].T @ now[:3, :3], turns[k].as_matrix(), atol=2e-3)
        np.testing.assert_allclose(now[:3, 3] - first[:3, 3], first[:3, :3] @ sway[k], atol=2e-3)


def test_a_recorded_pose_moves_the_torso(exo, log):
    turn = np.tile([0.0, 0.0, np.sin(0.2), np.cos(0.2)], (len(log), 1))
    place = np.column_stack([0.1 * log.time, np.zeros(len(log)), 0.9 + 0.05 * np.sin(log.time)])
    posed = replace(log, base=BaseMotion.from_pose(place, turn, log.time), contacts={}, wrenches={})
    drawn = scene(exo, recording=posed)
    found = places(drawn, 2.0)[root(drawn)]
    np.testing.assert_allclose(found[:3, 3], place[500], atol=1e-4)
    np.testing.assert_allclose(found[:2, 0], [np.cos(0.4), np.sin(0.4)], atol=1e-4)
    weight = places(drawn, 2.0)[f"{root(drawn)}/weight {exo.link_names[0]}"]
    np.testing.assert_allclose(weight[:3, 2], [0.0, 0.0, -1.0], atol=1e-4)


@pytest.mark.nightly
def test_an_estimate_adds_predicted_forces_that_equal_exact_ones(exo, estimate):
    log = standing(exo, "left", seconds=4.0, seed=5)
    drawn = scene(estimate, recording=log.recording)
    assert "predicted ground force" in [layer.label for layer in drawn.layers]
    longest, largest = lengths(drawn, "predicted ground force")
    for t in (1.0, 2.0, 3.0):
        arrow = places(drawn, t)["/exoid/predicted ground force left_foot/arrow"]
        rotation, _ = foot(exo, drawn, log.recording, "left_foot", t)
        exact = rotation @ log.wrenches["left_foot"].force[round(250 * t)] * longest / largest
        np.testing.assert_allclose(arrow[:3, 2], exact, atol=0.01)
    assert not [path for path in places(drawn) if "predicted ground force right_foot" in path]
    (left,) = [each for each in drawn.readings if each.foot]
    assert left.name == "left_foot"
    assert np.isnan(left.torque).all()  # no plate
    exact = log.wrenches["left_foot"].force[(250 * np.arange(30, 90) / 30).round().astype(int), 2]
    np.testing.assert_allclose(left.predicted[30:90], exact, rtol=0.02)


@pytest.mark.parametrize(
    "make", [four_bar_knee, *(pytest.param(each, marks=pytest.mark.slow) for each in (two_rod_ankle, cylinder_knee))]
)
def test_the_ends_of_a_loop_are_drawn_in_one_place(make, tmp_path):
    leg = make(0).leg(tmp_path)
    pose = dict.fromkeys(leg.joint_names, 0.02 if make is cylinder_knee else 0.3)
    drawn = scene(leg, pose=pose)
    at, ends = places(drawn), []
    for path, shape in objects(drawn).items():
        if path.endswith("/loops"):
            ends += [(at[path] @ place)[:3, 3] for _, _, place in meshes(shape)]
    assert len(ends) == 2 * len(leg.closure.loops.loops)
    apart = np.sort(np.linalg.norm(np.array(ends)[:, None] - ends, axis=2), axis=1)
    assert (apart[:, 1] < 1e-5).all()  # of each end the nearest other one; a loop closes to 10 µm
