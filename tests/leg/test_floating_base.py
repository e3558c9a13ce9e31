"""A base that floats: rows of force and moment before those of the joints, equal to Pinocchio's free-flyer."""

import numpy as np
import pinocchio as pin
import pytest
from free_flyers import Flight, about_hip
from planar_chains import assert_relative
from planar_machines import random_machine
from public_robots import urdf_of

import exoid
from exoid import Leg, TorsoMotion
from exoid.leg.torso import base_kinematics

TOLERANCE = 1e-12
TALOS_LEGS = tuple(f"leg_{side}_{k}_joint" for side in ("left", "right") for k in range(1, 7))
EXOS = [("bleex", "cad"), ("bleex", "identified"), ("cuhk", "nominal")]


@pytest.fixture(scope="module", params=["solo12", "hyq", "talos"])
def robot(request):
    joints, locked = (TALOS_LEGS, {"torso_1_joint": 0.3}) if request.param == "talos" else (None, None)
    return Leg.from_urdf(urdf_of(request.param), joints, locked=locked, base="floating")


@pytest.mark.parametrize(("name", "inertias"), EXOS)
def test_an_exoskeleton_that_floats_has_the_rows_of_pinocchios_free_flyer(name, inertias):
    exo = exoid.load_exo(name, inertias, base="floating")
    flight = Flight.random(exo, np.random.default_rng(0), within_plane=True)
    expected = about_hip(exo, flight.rows())
    assert_relative(exo.inverse_dynamics(*flight.joints, flight.base), expected, TOLERANCE)
    assert_relative(exo.regressor(*flight.joints, flight.base) @ exo.parameters, expected, TOLERANCE)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("cumulative", [True, False])
def test_any_planar_machine_has_them_wherever_its_hips_are(seed, cumulative):
    rng = np.random.default_rng(seed)
    lengths, names = [((3, 2), ("left_", "right_")), ((1, 3, 2), ("a_", "b_", "c_")), ((2,), ("one_",))][seed % 3]
    leg = random_machine(rng, lengths, names).leg(cumulative=cumulative)
    flight = Flight.random(leg, rng, 30, within_plane=True)
    expected = about_hip(leg, flight.rows())
    W = leg.regressor(*flight.joints, flight.base)
    assert_relative(W @ leg.parameters, expected, TOLERANCE)
    assert_relative(leg.inverse_dynamics(*flight.joints, flight.base), expected, TOLERANCE)
    Y = np.stack([about_hip(leg, column) for column in np.moveaxis(flight.regressor(), 2, 0)], axis=2)
    assert_relative(W, leg.reduction.reduce(Y), TOLERANCE)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("cumulative", [True, False])
def test_m_x0_y0_and_j0_are_sums_over_points_of_the_torso_and_the_masses_at_the_hips(seed, cumulative):
    machine = random_machine(np.random.default_rng(seed))
    leg = machine.leg(cumulative=cumulative)
    names = [
        "M",
        "X0",
        "Y0",
        "J0",
        *(f"{s}{k}_{side}" for side, n in (("left", 3), ("right", 2)) for k in range(1, n + 1) for s in "XYJ"),
    ]
    assert list(leg.parameter_names) == names
    assert leg.parameter_units == ("kg", *("kg·m", "kg·m", "kg·m²") * 6)
    assert_relative(leg.parameters, machine.parameters(cumulative=cumulative), TOLERANCE)


@pytest.mark.parametrize("seed", range(6))
def test_all_of_them_are_independent_and_complete(seed):
    rng = np.random.default_rng(seed)
    leg = random_machine(rng, (2, 2)).leg()
    flight = Flight.random(leg, rng, 60, within_plane=True)
    W = leg.regressor(*flight.joints, flight.base).reshape(-1, 16)
    assert np.linalg.matrix_rank(W / np.linalg.norm(W, axis=0)) == 16


@pytest.mark.parametrize("cumulative", [True, False])
def test_other_parameters_are_those_of_the_changed_leg(cumulative):
    rng = np.random.default_rng(5)
    leg = random_machine(rng).leg(cumulative=cumulative)
    values = leg.parameters + rng.normal(size=len(leg.parameters))
    changed = leg.with_parameters(values)
    np.testing.assert_allclose(changed.parameters, values, rtol=0, atol=1e-13)
    flight = Flight.random(leg, rng, 20, within_plane=True)
    rows = changed.inverse_dynamics(*flight.joints, flight.base)
    assert_relative(leg.regressor(*flight.joints, flight.base) @ values, rows, TOLERANCE)


def test_the_planar_equation_takes_the_part_of_a_motion_that_lies_in_the_plane():
    exo, rng = exoid.load_exo("bleex", base="floating"), np.random.default_rng(3)
    flight = Flight.random(exo, rng)
    within = flight.base.within_plane(exo.plane, exo.hip)
    W = exo.regressor(*flight.joints, flight.base)
    assert_relative(W, exo.regressor(*flight.joints, within), TOLERANCE)
    assert_relative(W @ exo.parameters, exo.inverse_dynamics(*flight.joints, within), TOLERANCE)
    assert_relative(exo.inverse_dynamics(*flight.joints, flight.base), about_hip(exo, flight.rows()), TOLERANCE)


def test_a_torso_motion_is_one_of_the_base_in_axes_that_turn_with_it():
    exo, rng = exoid.load_exo("cuhk", base="floating"), np.random.default_rng(4)
    q, v, a = rng.normal(size=(3, 25, 4))
    torso = TorsoMotion(*rng.normal(size=(3, 25)), rng.normal(size=(25, 2)))
    base = base_kinematics(torso, 25, exo.plane, exo.hip)
    assert_relative(exo.regressor(q, v, a, torso), exo.regressor(q, v, a, base), TOLERANCE)
    assert_relative(exo.inverse_dynamics(q, v, a, torso), exo.inverse_dynamics(q, v, a, base), TOLERANCE)
    W = exo.regressor(q, v, a, torso)
    np.testing.assert_allclose(exo.gravity(q, torso), exo.inverse_dynamics(q, 0 * v, 0 * a, TorsoMotion(torso.pitch)))
    np.testing.assert_allclose(W[:, 3:, 4:], exoid.load_exo("cuhk").regressor(q, v, a, torso), atol=1e-12)


def test_many_samples_are_those_of_single_ones():
    exo, rng = exoid.load_exo("bleex", base="floating"), np.random.default_rng(6)
    flight = Flight.random(exo, rng, 9000, within_plane=True)
    W = exo.regressor(*flight.joints, flight.base)
    rows = np.array([0, 8191, 8192, 8999])
    np.testing.assert_array_equal(W[rows], exo.regressor(*(x[rows] for x in flight.joints), flight.base.rows(rows)))


@pytest.mark.parametrize("seed", range(6))
def test_limbs_keep_documented_names_on_a_base_that_moves_within_the_plane(seed):
    rng = np.random.default_rng(seed)
    machine = random_machine(rng)
    leg = machine.leg(base="fixed")
    assert leg.parameter_names == machine.leg().parameter_names[4:]
    assert leg.base_rows == 0
    assert leg.row_names == leg.joint_names
    flight = Flight.random(leg, rng, 20, within_plane=True)
    assert_relative(leg.regressor(*flight.joints, flight.base) @ leg.parameters, flight.rows()[:, 6:], TOLERANCE)
    assert_relative(leg.inverse_dynamics(*flight.joints, flight.base), flight.rows()[:, 6:], TOLERANCE)
    torso = TorsoMotion(*rng.normal(size=(3, 20)), rng.normal(size=(20, 2)))
    W = leg.regressor(*flight.joints, torso)
    assert_relative(W @ leg.parameters, leg.inverse_dynamics(*flight.joints, torso), TOLERANCE)
    assert_relative(leg.regressor(*flight.joints) @ leg.parameters, leg.inverse_dynamics(*flight.joints), TOLERANCE)


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_both_legs_have_the_regressors_of_single_ones(name):
    exo, rng = exoid.load_exo(name), np.random.default_rng(7)
    n = len(exo.joint_names) // 2
    q, v, a = rng.normal(size=(3, 30, 2 * n))
    W = exo.regressor(q, v, a)
    for k, side in enumerate(("left", "right")):
        one, joints, columns = exoid.load_leg(name, side), exo.limbs[k].joints, exo.limbs[k].parameters
        assert exo.limbs[k].label == side
        np.testing.assert_array_equal(W[:, joints, columns], one.regressor(*(x[:, joints] for x in (q, v, a))))
        W[:, joints, columns] = 0.0
        np.testing.assert_array_equal(exo.parameters[columns], one.parameters)
    assert not W.any()


@pytest.mark.parametrize(
    ("names", "labels"),
    [
        (("left_", "right_"), ("left", "right")),
        (("back_", "front_"), ("back_hip", "front_hip")),
        (("back_", "left_"), ("back_hip", "left")),
        (("left_a_", "left_b_"), ("left_a_hip", "left_b_hip")),
    ],
)
def test_limbs_are_named_by_their_side_or_their_first_joint(names, labels):
    leg = random_machine(np.random.default_rng(0), (2, 2), names).leg()
    assert tuple(limb.label for limb in leg.limbs) == labels
    assert leg.parameter_names[4] == f"X1_{labels[0]}"
    assert leg.parameter_names[-1] == f"J2_{labels[1]}"


def test_any_robot_that_floats_has_the_rows_of_pinocchios_free_flyer(robot):
    flight = Flight.random(robot, np.random.default_rng(1))
    assert_relative(robot.inverse_dynamics(*flight.joints, flight.base), flight.rows(), TOLERANCE)
    W = robot.regressor(*flight.joints, flight.base)
    assert_relative(W, robot.reduction.reduce(flight.regressor()), TOLERANCE)
    assert_relative(W @ robot.parameters, flight.rows(), 1e-10)  # rounding of the URDF's numbers is grouped
    assert robot.row_names[:6] == ("base_fx", "base_fy", "base_fz", "base_mx", "base_my", "base_mz")


def test_a_floating_tree_of_n_revolute_joints_has_10_and_7_n_parameters(robot):
    assert len(robot.parameter_names) == 10 + 7 * len(robot.joint_names)
    assert robot.parameter_names[0].startswith(f"m_{robot.description.root_link} + m_")
    mass = robot.parameters[0]
    assert mass == pytest.approx(pin.computeTotalMass(Flight.random(robot, np.random.default_rng(0), 1).model))


@pytest.mark.parametrize("planar", [True, False])
def test_the_mass_matrix_has_rows_of_the_base(planar):
    leg = exoid.load_exo("cuhk", base="floating") if planar else Leg.from_urdf(urdf_of("solo12"), base="floating")
    rng = np.random.default_rng(3)
    q = rng.normal(size=(5, len(leg.joint_names)))
    M = leg.mass_matrix(q)
    np.testing.assert_allclose(M, M.swapaxes(1, 2), atol=1e-13)
    assert np.linalg.eigvalsh(M).min() > 0.0
    a = rng.normal(size=(5, len(leg.row_names)))
    n, b = len(leg.joint_names), leg.base_rows
    flight = Flight.random(leg, rng, 5)
    twist = a[:, :b] if not planar else a[:, :b] @ leg.frame_jacobian(q, "torso")[0, :, :b].T
    slopes = np.hstack([twist, a[:, b:]])
    upright = np.hstack([np.tile([0, 0, 0, 0, 0, 0, 1.0], (5, 1)), q])
    moved = Flight(flight.model, upright, np.zeros((5, 6 + n)), slopes)
    inertial = leg.inverse_dynamics(q, 0 * q, a[:, b:], moved.base) - leg.gravity(q)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", M, a), inertial, atol=1e-11)
    if planar:
        np.testing.assert_allclose(M[:, 0, 0], leg.parameters[0])
        held = exoid.load_exo("cuhk")
        np.testing.assert_allclose(M[:, 3:, 3:], held.mass_matrix(q), atol=1e-12)
