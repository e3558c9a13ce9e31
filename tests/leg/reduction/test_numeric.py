"""Numeric base parameters of robots that are not planar legs."""

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree
from planar_chains import assert_relative, joint_torque_regressor, random_motion
from public_robots import urdf_of
from small_urdfs import OFFSET_BODY as BODY
from small_urdfs import nearly_coaxial

import exoid
from exoid import Armature, Leg
from exoid.leg.description import Description, describe, read_description
from exoid.leg.reduction.numeric import numeric
from exoid.leg.reduction.reduction import LINK_PARAMETERS, LINK_UNITS
from exoid.torques import TorqueModel

CASES = {  # joints to use (None for all of one degree of freedom), and how many base parameters they have
    "ur5": (None, 36),
    "panda": (tuple(f"panda_joint{k}" for k in range(1, 8)), 43),
    "kinova": (None, 36),
    "z1": (tuple(f"joint{k}" for k in range(1, 7)), 36),
    "talos_arm": (None, 45),
    "tiago_no_hand": (("torso_lift_joint", *(f"arm_{k}_joint" for k in range(1, 8))), 44),
    "xarm7": (None, 43),
}


@pytest.fixture(scope="module", params=list(CASES))
def robot(request):
    """The name of a robot and its leg."""
    return request.param, Leg.from_urdf(urdf_of(request.param), joints=CASES[request.param][0])


def labels(count: int) -> list[str]:
    return [f"link{k}" for k in range(1, count + 1)]


def test_base_parameters_give_pinocchios_torques(robot):
    name, leg = robot
    assert leg.chain is None
    q, v, a = random_motion(np.random.default_rng(0), len(leg.joint_names), 100)
    assert_relative(leg.regressor(q, v, a) @ leg.parameters, leg.inverse_dynamics(q, v, a), 1e-9)
    assert len(leg.parameters) == CASES[name][1]


def test_other_link_parameters_reduce_to_the_same_torques(robot):
    """Also for parameters that the URDF does not have: the map is right, not just the sum."""
    _, leg = robot
    rng = np.random.default_rng(2)
    Y = joint_torque_regressor(leg.model, *random_motion(rng, len(leg.joint_names), 20))
    for link_parameters in rng.standard_normal((3, Y.shape[-1])):
        reduced = leg.reduction.reduce(Y) @ leg.reduction.parameters(link_parameters)
        assert_relative(reduced, Y @ link_parameters, 1e-8)


def test_the_rank_is_that_of_a_regressor_over_other_motions(robot):
    _, leg = robot
    n = len(leg.joint_names)
    Y = joint_torque_regressor(leg.model, *random_motion(np.random.default_rng(4), n, 400)).reshape(400 * n, -1)
    scale = np.linalg.norm(Y, axis=0)
    Y = Y[:, scale > 1e-9 * scale.max()] / scale[scale > 1e-9 * scale.max()]
    sigma = np.linalg.svd(Y, compute_uv=False)
    rank = len(leg.parameters)
    assert sigma[rank - 1] > 1e-2 * sigma[0]
    assert not (sigma[rank:] > 1e-10 * sigma[0]).any()


def test_collecting_spread_parameters_is_the_identity(robot):
    _, leg = robot
    reduction = leg.reduction
    np.testing.assert_array_equal(reduction.collect @ reduction.spread, np.eye(len(reduction.names)))


@pytest.mark.parametrize(
    ("lower", "upper", "count"),
    [(-3.0, 3.0, 3), (0.0, 0.0, 3), (0.0, 1e-5, 2), (-1e-5, 0.0, 2), (-3.0, 1e-5, 3), (-1e-5, 3.0, 3)],
    ids=["wide", "none", "up", "down", "wide down", "wide up"],
)
def test_parameters_that_no_motion_within_the_limits_shows_are_left_out(lower, upper, count):
    """One joint about y: Iyy and both moments, of which m·c_z needs an angle."""
    model = pin.Model()
    limits = [np.array([x]) for x in (1.0, 1.0, lower, upper)]
    joint = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "one", *limits)
    model.appendBodyToJoint(joint, pin.Inertia(1.0, np.array([0.1, 0.0, 0.2]), np.eye(3)), pin.SE3.Identity())
    assert len(numeric(model, labels(1)).names) == count


def test_clearly_offset_and_clearly_coaxial_joints_have_their_number_of_parameters():
    assert len(nearly_coaxial(1e-3, last=True).parameters) == 11
    assert len(nearly_coaxial(1e-14, last=True).parameters) == 9
    assert nearly_coaxial(0.1, last=False).parameter_names == ("Izz_b + 0.01*m_c", "mcx_c", "mcy_c", "Izz_c")
    assert nearly_coaxial(0.0, last=False).parameter_names == ("Izz_b", "Izz_c")


@pytest.mark.parametrize("offset", [1e-9, 5e-10, 1e-6, 5e-5])
def test_offsets_that_rounding_explains_are_merged(offset):
    assert len(nearly_coaxial(offset, last=True).parameters) == 9
    assert nearly_coaxial(offset, last=False).parameter_names == ("Izz_b", "Izz_c")


def rounded(robot: str, decimals: int, attributes: tuple[str, ...]) -> Description:
    """A robot's URDF with rounded placements of its joints."""
    root = read_description(urdf_of(robot)).parse()
    for origin in root.findall("joint/origin"):
        for attribute in attributes:
            numbers = [float(word) for word in origin.get(attribute, "0 0 0").split()]
            origin.set(attribute, " ".join(f"{number:.{decimals}f}" for number in numbers))
    return describe(etree.tostring(root, encoding="unicode"), f"{robot}.urdf")


@pytest.mark.parametrize("decimals", [2, 4, 5])
def test_angles_of_few_digits_give_the_parameters_of_exact_angles(robot, decimals):
    """1.57, 1.5708 and 1.57080 all stand for π/2, so that torques are exact as well."""
    name, exact = robot
    leg = Leg.from_description(rounded(name, decimals, ("rpy",)), CASES[name][0])
    np.testing.assert_array_equal(leg.reduction.spread, exact.reduction.spread)
    assert [name.count("+") for name in leg.parameter_names] == [name.count("+") for name in exact.parameter_names]
    q, v, a = random_motion(np.random.default_rng(6), len(leg.joint_names), 20)
    assert_relative(leg.regressor(q, v, a) @ leg.parameters, leg.inverse_dynamics(q, v, a), 1e-9)


TILTED = (
    '<robot name="r"><link name="a"/><link name="b">{0}</link><link name="c">{0}</link>'
    '<joint name="one" type="continuous"><origin rpy="{1}"/><parent link="a"/><child link="b"/>'
    '<axis xyz="0 0 1"/></joint><joint name="two" type="continuous"><origin xyz="0 0 0.3" rpy="{2}"/>'
    '<parent link="b"/><child link="c"/><axis xyz="0 0 1"/></joint></robot>'
)


@pytest.mark.parametrize("decimals", [4, 5, 6, 7])
def test_axes_that_rounding_tilts_have_the_parameters_of_exact_axes(decimals):
    """A vertical axis, and one at right angles to it, by rotations whose angles are no multiples of π/12."""
    turned = pin.exp3(np.array([0.0, 0.0, 0.7])) @ pin.rpy.rpyToMatrix(np.array([0.0, np.pi / 2, 0.0]))
    first, second = (pin.rpy.matrixToRpy(R @ pin.exp3(np.array([0.0, 0.0, 0.3]))) for R in (np.eye(3), turned))
    upside = pin.rpy.matrixToRpy(pin.exp3(np.array([0.0, 0.0, 0.3])) @ pin.exp3(np.pi * np.array([0.6, 0.8, 0.0])))
    for start in (first, upside):
        legs = []
        for digits in (decimals, 16):
            words = [" ".join(f"{angle:.{digits}f}" for angle in rpy) for rpy in (start, second)]
            legs.append(Leg.from_description(describe(TILTED.format(BODY, *words), "tilted.urdf")))
        leg, exact = legs
        assert leg.parameter_names == exact.parameter_names
        models = [TorqueModel(each, (Armature(),)) for each in legs]
        assert [one.name for one in models[0].regrouped] == ["Ia_one", "Ia_two"]
        assert [set(one.into) for one in models[0].regrouped] == [set(one.into) for one in models[1].regrouped]
        q, v, a = random_motion(np.random.default_rng(7), 2, 50)
        rounding = 10.0**-decimals
        assert_relative(leg.regressor(q, v, a) @ leg.parameters, leg.inverse_dynamics(q, v, a), 3.0 * rounding)


def test_numeric_parameters_of_a_planar_leg_are_the_documents(side):
    """X = −(mcz …), Y = mcx, J not cumulative."""
    leg = exoid.load_leg("cuhk", side=side)
    reduction = numeric(leg.model, ("thigh", "shank"))
    link_parameters = np.concatenate([leg.model.inertias[j].toDynamicParameters() for j in (1, 2)])
    Y1, X1, J1, Y2, X2, J2 = reduction.parameters(link_parameters)
    np.testing.assert_allclose([-X1, Y1, J1, -X2, Y2, J2], leg.parameters, rtol=1e-12)


def test_names_are_unique_and_each_begins_with_the_parameter_that_stands_for_the_sum(robot):
    _, leg = robot
    assert len(set(leg.parameter_names)) == len(leg.parameter_names)
    links = [leg.description.child_links[joint] for joint in leg.joint_names]
    for name, unit, row, column in zip(
        leg.parameter_names, leg.parameter_units, leg.reduction.collect, leg.reduction.spread.T, strict=True
    ):
        (kept,) = np.flatnonzero(column)
        assert name.split(" ")[0] == f"{LINK_PARAMETERS[kept % 10]}_{links[kept // 10]}"
        assert unit == LINK_UNITS[kept % 10]
        assert row[kept] == 1.0
        assert name.endswith("…") == (np.count_nonzero(row) > 4)


def test_a_link_and_a_fixed_joint_may_share_a_name():
    """As in the Z1, on whose gripper a moving joint hangs: locking joints of such a robot must not fail."""
    joints = ("joint2", "joint3", "jointGripper")
    leg = Leg.from_urdf(urdf_of("z1"), joints=joints, locked={"joint1": 0.4})
    assert leg.joint_names == joints
    q, v, a = random_motion(np.random.default_rng(5), 3)
    assert_relative(leg.regressor(q, v, a) @ leg.parameters, leg.inverse_dynamics(q, v, a), 1e-12)
