"""Heel and toe of a foot: links of their own, merged to a flat foot, and left with the directions they hold."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import study_heel_toe as study
from scipy.spatial.transform import Rotation

import exoid
from exoid.errors import BadArgumentError, NotIdentifiableError, NotSupportedError, UnreadableInputError
from exoid.estimate.ground_prediction import level_wrench
from exoid.experiments.ground import bleex_machine, walking
from exoid.lab.reproduce.stance import TERMS, WALKING, true_values
from exoid.leg.description import describe
from exoid.rig.ground import GroundSensors, Sole
from exoid.signals import contacts_from_motion
from exoid.signals.link_wrenches import link_placements
from exoid.torques.contacts import level_rotation, split
from exoid.torques.contacts.kinds import on_time, touch_downs, whole_feet

HEEL, TOE = (-0.075, -0.1, -0.11), (0.13, -0.1, -0.11)
FOOT = "left_foot"


@cache
def exo():
    plain = exoid.load_exo("bleex", base="floating")
    places = {f"{FOOT}_heel": HEEL, f"{FOOT}_toe": TOE}
    return exoid.Leg.from_description(plain.description, plain.joint_names, base="floating", contacts=places)


def bits(text):
    return np.array([each == "1" for each in text])


def test_a_heel_holds_its_line_in_the_axes_of_the_foot():
    q = np.random.default_rng(0).uniform(-1.0, 1.0, (5, 6))
    whole = exo().contact_jacobian(q, FOOT)
    for edge, (x, _, z) in ((f"{FOOT}_heel", HEEL), (f"{FOOT}_toe", TOE)):
        # the pitch turns forward into up: a point (x, z) moves by (−z, x)
        expected = whole[:, :2] + np.array([-z, x])[:, None] * whole[:, 2:]
        np.testing.assert_allclose(exo().contact_jacobian(q, edge), expected, atol=1e-12)
    np.testing.assert_array_equal(exo().parameters, exoid.load_exo("bleex", base="floating").parameters)


def test_heel_and_toe_together_are_flat():
    heel, toe = bits("0111000"), bits("0011100")
    found = whole_feet(exo(), {f"{FOOT}_heel": heel, f"{FOOT}_toe": toe})
    np.testing.assert_array_equal(found[FOOT], bits("0011000"))
    np.testing.assert_array_equal(found[f"{FOOT}_heel"], bits("0100000"))
    np.testing.assert_array_equal(found[f"{FOOT}_toe"], bits("0000100"))
    np.testing.assert_array_equal(touch_downs(exo(), found, 7, settling=2), bits("0111000"))


def a_log(contacts):
    q = np.tile([0.2, -0.4, 0.2] * 2, (500, 1))
    flags = {link: np.full(500, value) for link, value in contacts.items()}
    base = exoid.BaseMotion(np.zeros((500, 3)), np.tile([0.0, 0.0, 9.81], (500, 1)))
    return exoid.Recording(np.arange(500) / 250.0, q, tau=q, joint_names=exo().joint_names, base=base, contacts=flags)


def test_the_motion_says_which_part_of_a_foot_is_down():
    """A foot rolls over its heel for 0.4 s, is flat for as long, and rolls over its toe."""
    leg, time = exo(), np.arange(0.0, 1.2, 0.004)
    q = 0.3 * np.sin(np.outer(time, [3.0, 4.0, 5.0, 3.5, 4.5, 5.5]))
    tilt = 0.5 * (np.maximum(0.0, 0.4 - time) - np.maximum(0.0, time - 0.8))
    pivot = np.where(tilt[:, None] > 0.0, HEEL, TOE)
    turn = Rotation.from_rotvec(np.outer(tilt, leg.plane.lateral * -1.0)).as_matrix()
    foot = link_placements(leg, q, FOOT)
    rotation = turn @ level_rotation(leg, FOOT) @ np.swapaxes(foot.rotation, 1, 2)
    level = level_rotation(leg, FOOT) @ pivot.T
    place = level.T - np.einsum("nij,nj->ni", turn, level.T) - np.einsum("nij,nj->ni", rotation, foot.translation)
    base = exoid.BaseMotion.from_pose(place, Rotation.from_matrix(rotation).as_quat(), time)
    log = exoid.Recording(time, q, joint_names=leg.joint_names, base=base)
    found = contacts_from_motion(leg, log, (f"{FOOT}_heel", f"{FOOT}_toe"))
    for part, down in (("heel", time < 0.8), ("toe", time > 0.4)):
        apart = np.abs(time - (0.8 if part == "heel" else 0.4)) > 0.06
        np.testing.assert_array_equal(found[f"{FOOT}_{part}"][apart], down[apart])
    with pytest.raises(NotSupportedError, match="an IMU does not measure it"):
        contacts_from_motion(leg, a_log({FOOT: True}), (FOOT,))


@pytest.mark.parametrize(
    ("contacts", "message"),
    [
        ({FOOT: True, f"{FOOT}_toe": True}, "flat and on left_foot_toe at once"),
        ({f"{FOOT}_heel": True, f"{FOOT}_toe": True, f"{FOOT}_tip": True}, "overdetermine"),
        ({f"{FOOT}_ball": True}, "no link"),
        ({"right_foot_heel": True}, "right_foot"),
    ],
)
def test_contradictions_are_one_error(contacts, message):
    text = exo().description.text.replace("</robot>", TIP + "</robot>")
    leg = exoid.Leg.from_description(
        describe(text), exo().joint_names, base="floating", contacts={**exo().contacts, f"{FOOT}_tip": "point"}
    )
    with pytest.raises(BadArgumentError, match=message):
        split(leg, a_log(contacts))


TIP = (
    f'<link name="{FOOT}_tip"/><joint name="tip" type="fixed"><parent link="{FOOT}"/><child link="{FOOT}_tip"/></joint>'
)


def test_a_foot_on_heel_or_toe_is_no_point_itself():
    """Its point and its heel would count as a flat sole."""
    kinds = {FOOT: "point", f"{FOOT}_heel": "edge"}
    with pytest.raises(BadArgumentError, match=f"{FOOT} rests on its heel, and is a contact of the kind 'point'"):
        exoid.Leg.from_description(exo().description, exo().joint_names, base="floating", contacts=kinds)


@pytest.fixture(scope="module")
def walk():
    return walking(bleex_machine(), 20.0)


def errors(estimate, run):
    true = dict(zip(run.plant.leg.parameter_names, run.plant.leg.parameters, strict=True))
    names = [name for name in true if name[0] in "MXJ" and name not in ("X0", "J0")]
    return {name: abs(estimate[name].value / true[name] - 1.0) for name in names}


@pytest.mark.nightly
def test_most_of_a_walk_counts_and_late_switches_do_no_harm(walk):
    leg = exoid.load_exo("bleex", base="floating")
    for delay in (0.0, 0.03):
        log = walk.recording(GroundSensors(switch_delay=delay), 1, wrenches=("torso",))
        log = replace(log, base=replace(log.base, calibrated=True))
        parts = split(leg, log, WALKING).stretches
        counted = np.any([part.recording.mask for part in parts], axis=0)
        assert np.mean(counted[np.any(list(log.contacts.values()), axis=0)]) > 0.9
        found = errors(exoid.identify(leg, log, TERMS, preparation=WALKING, check=False), walk)
        assert max(value for name, value in found.items() if name[0] == "X") < 0.02


@pytest.mark.slow
def test_a_walk_tells_the_bias_of_its_imu():
    leg, walk = exoid.load_exo("bleex", base="floating"), walking(bleex_machine(), 12.0)
    log = walk.recording(GroundSensors(), 1, wrenches=("torso",))
    log = replace(log, base=replace(log.base, specific_force=np.add(log.base.specific_force, (0.2, 0.0, -0.1))))
    estimate = exoid.identify(leg, log, TERMS, preparation=WALKING, check=False)
    assert max(value for name, value in errors(estimate, walk).items() if name[0] == "X") < 0.02
    (bias,) = (each for each in estimate.findings if each.kind == "imu-bias")
    assert bias.value == pytest.approx(np.hypot(0.2, 0.1), abs=0.05)


@pytest.mark.nightly
def test_a_healthy_walk_needs_no_settings_but_an_imu(walk):
    """Touch-downs shake joints faster than the usual low-pass lets through: a torque offset was made of it."""
    log, true = walk.recording(seed=1, wrenches=("torso",)), true_values(walk.plant)
    estimate = exoid.identify(walk.plant.leg, log)
    with_plates = exoid.identify(walk.plant.leg, walk.recording(seed=1), preparation=WALKING)
    for each in (estimate, with_plates):
        assert not [one for one in each.findings if one.severity == "error"]
        low, high = each.interval(0.95).T
        values = np.array([true.get(name, 0.0) for name in each.names])
        assert np.mean((low <= values) & (values <= high)) > 0.9
    again = walking(walk.plant, 8.0, period=1.15)  # forces of touch-downs are faster than the low-pass of the torques
    for link, force in exoid.ground_forces(estimate, again.recording(seed=2, wrenches=("torso",))).items():
        rows = np.searchsorted(again.time, force.time - 1e-9)
        error = (force.force - level_wrench(walk.plant.leg, again.q, link, again.wrench(link), rows).force)[:, 2]
        assert np.sqrt(np.mean(error**2)) < 0.3 * again.wrench(link).force[rows, 2].std()
        assert np.mean(np.abs(error) <= force.force_half[:, 2]) > 0.92
    much = replace(log.base, specific_force=1.04 * log.base.specific_force)
    assert "imu-scale" in {one.kind for one in exoid.check(walk.plant.leg, replace(log, base=much))}
    with pytest.raises(UnreadableInputError, match="feet roll from heel to toe"):
        exoid.identify(walk.plant.leg, replace(log, base=None))
    held = walk.recording(seed=1, wrenches=())  # an unknown harness: no foot, but nothing tells of the torso
    with pytest.raises(NotIdentifiableError, match="M, X0, Y0, J0 left no trace"):
        exoid.identify(walk.plant.leg, held)


@pytest.mark.parametrize("late", [0.0, 0.01, 0.03, 0.06])
def test_switches_that_close_after_the_jolt_of_a_touch_down_are_late(late):
    rate, rng = 500.0, np.random.default_rng(0)
    time = np.arange(0.0, 10.0, 1.0 / rate)
    down = time % 1.0 > 0.4
    force = np.tile([0.0, 0.0, 9.81], (len(time), 1)) + 0.05 * rng.standard_normal((len(time), 3))
    jolts = np.flatnonzero(np.diff(down.astype(int)) > 0) + 1
    for k in range(5):
        force[jolts + k] += 3.0 * (-0.7) ** k
    shift = round(late * rate)
    closed = np.concatenate([np.zeros(shift, dtype=bool), down[: len(down) - shift]])
    base = exoid.BaseMotion.from_imu(np.zeros_like(force), force)
    q = np.zeros((len(time), 6))
    log = exoid.Recording(time, q, tau=q, joint_names=exo().joint_names, base=base, contacts={f"{FOOT}_heel": closed})
    mended, found = on_time(exo(), log)
    assert found == (pytest.approx({FOOT: late}, abs=0.003) if late >= 0.03 else {})
    begun = np.flatnonzero(np.diff(mended.contacts[f"{FOOT}_heel"].astype(int)) > 0) + 1
    np.testing.assert_allclose(begun, jolts + (shift if late < 0.03 else 0), atol=1)


@pytest.mark.nightly
@pytest.mark.parametrize(("radius", "delay"), [(5e-4, 0.0), (5e-4, 0.06), (0.02, 0.0)])
def test_round_edges_and_late_switches_are_named(radius, delay):
    """A walk of the study, without noise of other seeds: sharp edges in time are no finding."""
    plant = bleex_machine()
    plant = replace(plant, soles={name: Sole(sole.points, radius) for name, sole in plant.soles.items()})
    run, late = walking(plant, 40.0), round(500.0 * delay)
    log = run.recording(GroundSensors(), 0, wrenches=("torso",))
    contacts = {k: np.roll(x, late) for k, x in study.switches(run).items()}
    log = replace(log, base=replace(log.base, calibrated=True), contacts=contacts)
    found = exoid.identify(study.machine(plant), log, TERMS, preparation=WALKING).findings
    units = {each.unit for each in found if each.kind == "contact-kind"}
    assert units == ({"s"} if delay else {"m"} if radius > 0.01 else set())
