"""Functions are data: feet stay where they bear, stairs are cleared, limits are kept, and a stride comes from a CSV."""

import re
from contextlib import nullcontext
from dataclasses import astuple, replace

import numpy as np
import pytest

from exoid import ExoidError, Leg, load_exo, load_leg
from exoid.control import functions
from exoid.control.functions import FUNCTIONS, PHASE, SIDES, Body, contact_name, joint_angles
from exoid.control.functions.walk import stride_flexion
from exoid.rig.ground.plant import BLEEX_SOLES, CUHK_SOLES
from exoid.signals.link_wrenches import link_placements

MACHINES = {"bleex": BLEEX_SOLES, "cuhk": CUHK_SOLES}


@pytest.fixture(params=MACHINES)
def machine(request):
    return load_exo(request.param, base="floating"), MACHINES[request.param]


@pytest.fixture
def body(machine):
    return Body.of(*machine)


def soles(body, function):
    hip = function.torso[:, 0] + 1j * function.torso[:, 1]
    return np.array([body.sole(hip, function.torso[:, 2], function.flexion[:, k]) for k in range(2)])


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_is_within_the_limits_of_the_machine_and_has_a_foot_on_the_ground(machine, body, name):
    leg, _ = machine
    function = FUNCTIONS[name](body)
    q = joint_angles(leg, function.flexion)
    assert ((q >= leg.limits.lower) & (q <= leg.limits.upper)).all()
    assert all(contacts & {*SIDES} for _, contacts in function.contacts)


@pytest.mark.parametrize("name", ["stand", "sit", "rise", "stairs up", "stairs down"])
def test_a_foot_that_bears_stays_where_it_is(body, name):
    function = FUNCTIONS[name](body)
    places = soles(body, function)
    for k, side in enumerate(SIDES):
        rows = np.flatnonzero(np.array([side in function.expected(p) for p in PHASE]))
        for run in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
            if len(run) < 3:  # the last phase is the first one of the next cycle
                continue
            toe = places[k, run[1:-1], 1]  # the toe stays when the heel rises
            np.testing.assert_allclose(toe, toe[0], rtol=0, atol=2e-3)


@pytest.mark.parametrize("up", [True, False])
def test_a_foot_does_not_pass_through_a_step(up):
    body, riser, tread = Body.of(load_exo("bleex", base="floating"), BLEEX_SOLES), 0.17, 0.29
    places = soles(body, functions.stairs(body, up=up, riser=riser, tread=tread))
    for foot in places:
        points = np.column_stack([foot, foot.mean(axis=1)])
        ground = (riser if up else -riser) * np.floor(points.real / tread + 0.5)
        assert (points.imag - ground).min() > -1e-6


def test_the_lowest_sole_of_a_walk_is_on_the_ground_and_a_swinging_toe_is_not(body):
    function = functions.walk(body)
    low = soles(body, function).imag.min(axis=2)
    assert abs(low.min(axis=0)).max() < 0.012  # the path of the hip is smooth
    swing = np.array(
        [["left" not in function.expected(p) for p in PHASE], ["right" not in function.expected(p) for p in PHASE]]
    )
    assert low[swing].max() > 0.03


def test_joint_angles_reach_the_planned_places(machine, body):
    """The soles by Pinocchio are where the planned ones are."""
    leg, own = machine
    function = functions.stairs(body)
    q = joint_angles(leg, function.flexion)
    for k, (link, sole) in enumerate(own.items()):
        rotation, origin = link_placements(leg, q, link)
        place = origin + rotation @ sole.centre
        hip = function.torso[:, 0] + 1j * function.torso[:, 1]
        np.testing.assert_allclose(
            hip + place[:, 0] + 1j * place[:, 2], soles(body, function)[k].mean(axis=1), rtol=0, atol=1e-9
        )


def test_legs_are_told_by_the_names_of_their_joints(tmp_path, machine, body):
    """Pinocchio sorts limbs by name, so that "droite" is before "gauche". Links may have any name."""
    text, path = machine[0].description.text, tmp_path / "leg.urdf"
    path.write_text(re.sub(r'(link(?: name)?=")(left|right)', r"\1foot_\2", text))
    other = Leg.from_urdf(path, base="floating")
    assert [contact_name(other, link) for link in other.link_names] == np.repeat(
        SIDES, len(other.link_names) // 2
    ).tolist()
    path.write_text(text.replace("left", "gauche").replace("right", "droite"))
    with pytest.raises(ExoidError, match="begin with"):
        joint_angles(Leg.from_urdf(path, base="floating"), functions.stand(body).flexion)


def test_a_machine_that_faces_backwards_in_its_plane_is_refused(tmp_path, machine, body):
    """Planes point to x or −y: a machine that faces y would lean and bend its knees the other way."""
    (leg, own), path = machine, tmp_path / "leg.urdf"
    front = '<link name="front"/><joint name="yaw" type="fixed"><parent link="front"/><child link="{}"/>{}</joint><link'
    for yaw, forward in ((-0.5, ""), (0.5, "[0.0, -1.0, 0.0]"), (1.0, "[1.0, 0.0, 0.0]")):
        turned = front.format(leg.description.root_link, f'<origin rpy="0 0 {yaw * np.pi}"/>')
        path.write_text(leg.description.text.replace("<link", turned, 1))
        with pytest.raises(ExoidError, match=re.escape(forward)) if forward else nullcontext():
            np.testing.assert_allclose(astuple(Body.of(Leg.from_urdf(path, base="floating"), own)), astuple(body))


def test_a_stride_of_a_csv_file_is_that_of_the_file(tmp_path):
    """The healthy stride, written as a table, makes the same walk."""
    stride = stride_flexion("healthy", 1.0)
    rows = np.column_stack([PHASE, np.rad2deg(stride)])[::2]
    path = tmp_path / "stride.csv"
    np.savetxt(path, rows, delimiter=",", header="phase,hip_deg,knee_deg,ankle_deg", comments="")
    np.testing.assert_allclose(stride_flexion(path, 1.0), stride, rtol=0, atol=5e-3)
    body = Body.of(load_exo("bleex", base="floating"), BLEEX_SOLES)
    again = functions.walk(body, reference=path, scale=1.0)
    np.testing.assert_allclose(again.flexion, functions.walk(body, scale=1.0).flexion, rtol=0, atol=0.02)


REFUSED = {
    "high riser": lambda body, path: functions.stairs(body, up=False, tread=0.6),
    "low seat": lambda body, path: functions.sit(body, seat=0.02),
    "steep": lambda body, path: functions.walk(body, angle=0.5),
    "no duration": lambda body, path: functions.rise(body, duration=0.0),
    "no norm": lambda body, path: functions.walk(body, reference="Sprint"),
    "no file": lambda body, path: functions.walk(body, reference="missing.csv"),
    "no end": lambda body, path: functions.walk(body, reference="/dev/zero"),
    "no knee": lambda body, path: functions.walk(body, reference=path),
    "two strides": lambda body, path: functions.walk(body, reference=path.with_name("two.csv")),
    "no leg": lambda body, path: Body(0.4, -0.4),
    "not finite": lambda body, path: replace(functions.stand(body), flexion=np.full((len(PHASE), 2, 3), np.nan)),
    "no order": lambda body, path: replace(functions.stand(body), contacts=((0.5, frozenset(SIDES)),)),
    "one leg": lambda body, path: joint_angles(load_leg("bleex"), np.zeros((1, 2, 3))),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_done_is_refused(name, tmp_path):
    path = tmp_path / "bad.csv"
    path.write_text("phase,hip_deg\n" + "\n".join(f"{k / 10},{k}" for k in range(10)))
    two = "\n".join(f"{k / 10 % 1},{k},{k}" for k in range(20))
    path.with_name("two.csv").write_text("phase,hip_deg,knee_deg\n" + two)
    body = Body.of(load_exo("bleex", base="floating"), BLEEX_SOLES)
    with pytest.raises(ExoidError):
        REFUSED[name](body, path)
