"""Lifted links are physically consistent, reproduce the parameters, and are those that a semidefinite program finds."""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree
from public_robots import urdf_of
from semidefinite import nearest_to_estimate, nearest_to_prior, nearest_with_pull

import exoid
from exoid import Leg
from exoid.leg.description import describe
from exoid.leg.lift import Lift, lift
from exoid.leg.lift.nearest_bodies import Problem, approach
from exoid.leg.lift.pseudo_inertia import (
    congruence,
    link_parameters,
    make_consistent,
    margins,
    pseudo_inertias,
    upper_factors,
)
from exoid.leg.model import dynamic_parameters
from exoid.leg.published import bleex_parameters
from exoid.leg.published.parameters import BLEEX_SETS

pytestmark = pytest.mark.slow


@cache
def robot_of(name):
    return Leg.from_urdf(urdf_of("ur5")) if name == "ur5" else exoid.load_leg(name)


def noisy(leg, rng, share):
    """Values with errors of a share of their size, and the covariance of the errors, which are correlated."""
    scale = share * np.maximum(np.abs(leg.parameters), 0.01 * np.abs(leg.parameters).max())
    mixing = np.eye(len(scale)) + 0.3 * rng.standard_normal((len(scale), len(scale)))
    root = scale[:, None] * mixing / np.linalg.norm(mixing, axis=1, keepdims=True)
    return leg.parameters + root @ rng.standard_normal(len(scale)), root @ root.T


def assert_possible(lifted: Lift):
    """Positive definite by Pinocchio's own pseudo-inertia, and triangle inequalities by principal inertias."""
    assert (margins(lifted.link_parameters) > 0.0).all()
    for parameters in lifted.link_parameters:
        P = pin.PseudoInertia.FromDynamicParameters(parameters).toMatrix()
        np.linalg.cholesky(P)
        body = pin.Inertia.FromDynamicParameters(parameters)
        a, b, c = np.linalg.eigvalsh(body.inertia)
        assert body.mass > 0.0
        assert 0.0 < a <= b <= c < a + b


def lifts(leg, seed, count, share, *, feasible, **options):
    """Those of so many noisy estimates, of which some at least are feasible, or not, with their covariance and lift."""
    rng, found = np.random.default_rng(seed), []
    for _ in range(count):
        values, covariance = noisy(leg, rng, share)
        lifted = lift(leg, values, covariance, **options)
        if lifted.feasible == feasible:
            assert_possible(lifted)
            found.append((values, covariance, lifted))
    assert len(found) >= max(2, count // 4)
    return found


def test_the_legs_own_parameters_lift_to_its_own_links(built_in_leg):
    lifted = lift(built_in_leg, built_in_leg.parameters)
    assert lifted.feasible
    assert lifted.distance == 0.0
    assert lifted.divergence == pytest.approx(0.0, abs=1e-12)
    own = dynamic_parameters(built_in_leg.model)
    np.testing.assert_allclose(lifted.link_parameters.ravel(), own, rtol=0, atol=1e-12 * np.abs(own).max())


@pytest.mark.parametrize("name", BLEEX_SETS)
def test_published_parameters_are_reproduced_to_rounding(leg, name):
    values = np.array(list(bleex_parameters(name).values()))
    lifted = lift(leg, values)
    assert lifted.feasible
    np.testing.assert_allclose(lifted.values, values, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(leg.reduction.parameters(lifted.link_parameters.ravel()), values, rtol=1e-13)
    assert_possible(lifted)


@pytest.mark.parametrize("robot", ["bleex", "cuhk", "ur5"])
def test_feasible_estimates_lift_to_the_optimum_of_the_semidefinite_program(robot):
    leg = robot_of(robot)
    for values, _, lifted in lifts(leg, 1, 8, 0.004 if robot == "ur5" else 0.2, feasible=True):
        np.testing.assert_allclose(lifted.values, values, rtol=0, atol=1e-12 * np.abs(values).max())
        optimum = nearest_to_prior(leg, values)
        assert lifted.divergence == pytest.approx(optimum.value, rel=1e-4, abs=1e-6)
        size = np.abs(optimum.links.reshape(-1, 10)).max(axis=1, keepdims=True)
        np.testing.assert_allclose(lifted.link_parameters / size, optimum.links.reshape(-1, 10) / size, atol=1e-3)


@pytest.mark.parametrize("pull", [0.0, 1e3])
def test_neither_covariance_nor_pull_matters_where_the_estimate_is_feasible(leg, pull):
    values, covariance = noisy(leg, np.random.default_rng(3), 0.05)
    with_, without = lift(leg, values, covariance, pull=pull), lift(leg, values)
    assert with_.feasible
    np.testing.assert_array_equal(with_.link_parameters, without.link_parameters)


@pytest.mark.parametrize("robot", ["bleex", "cuhk", "ur5"])
def test_infeasible_estimates_lift_to_the_optimum_of_the_semidefinite_program(robot):
    leg = robot_of(robot)
    for values, covariance, lifted in lifts(leg, 4, 6 if robot == "ur5" else 12, 0.8, feasible=False):
        optimum = nearest_to_estimate(leg, values, covariance, lifted.mass_limits)
        assert lifted.distance == pytest.approx(optimum.value, rel=1e-4, abs=1e-4)
        difference = lifted.values - leg.reduction.parameters(optimum.links)
        assert np.sqrt(difference @ np.linalg.solve(covariance, difference)) < 1e-2 * max(optimum.value, 1.0)
        missed = lifted.values - values
        assert np.sqrt(missed @ np.linalg.solve(covariance, missed)) == pytest.approx(lifted.distance, rel=1e-9)


@pytest.mark.parametrize("pull", [0.1, 1.0, 30.0])
@pytest.mark.parametrize("robot", ["bleex", "ur5"])
def test_a_pull_finds_the_optimum_of_the_semidefinite_program(robot, pull):
    leg = robot_of(robot)
    for values, covariance, lifted in lifts(leg, 6, 4, 0.8, feasible=False, pull=pull):
        optimum = nearest_with_pull(leg, values, covariance, pull)
        masses = lifted.link_parameters[:, 0]
        reached = 0.5 * lifted.distance**2 + pull * lifted.divergence
        assert reached == pytest.approx(optimum.value, rel=1e-6, abs=1e-6)
        np.testing.assert_allclose(masses, optimum.links[::10], rtol=1e-3)


def test_a_mass_factor_finds_lighter_links_with_exactly_the_same_values(leg):
    """Nearest are links up to so many times as heavy; others with the same values may be lighter."""
    values, _ = noisy(leg, np.random.default_rng(0), 0.2)
    free = lift(leg, values)
    assert free.feasible
    change = free.link_parameters[:, 0] / dynamic_parameters(leg.model)[::10]
    factor = 0.85 * change.max()
    lighter = lift(leg, values, np.eye(9), mass_factor=factor)
    assert lighter.feasible
    assert lighter.divergence > free.divergence
    np.testing.assert_allclose(lighter.values, values, rtol=0, atol=1e-12 * np.abs(values).max())
    assert (lighter.link_parameters[:, 0] / dynamic_parameters(leg.model)[::10]).max() <= factor
    assert_possible(lighter)


def test_values_that_only_lighter_links_have_are_not_feasible_within_a_mass_factor(leg):
    light = 0.1 * leg.parameters
    assert lift(leg, light).feasible
    assert not lift(leg, light, np.diag((0.01 * np.abs(light) + 1e-3) ** 2), mass_factor=5.0).feasible


def rod(inertia):
    body = f'<inertial><origin xyz="0 0 -0.2"/><mass value="2"/><inertia {inertia}/></inertial>'
    joint = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint>'
    text = f'<robot name="r"><link name="a"/><link name="b">{body}</link>{joint}</robot>'
    return Leg.from_description(describe(text))


@pytest.mark.parametrize(
    "inertia",
    [
        'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"',
        'ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0"',
        'ixx="0.1" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"',
    ],
    ids=["point", "rod", "no triangle"],
)
def test_links_without_a_mass_distribution_get_a_small_extent(inertia):
    leg = rod(inertia)
    own = dynamic_parameters(leg.model)
    repaired = make_consistent(own)
    assert margins(own)[0] < 1e-9 < margins(repaired)[0]
    np.testing.assert_array_equal(repaired[:4], own[:4])
    np.testing.assert_array_equal(make_consistent(repaired), repaired)
    lifted = lift(leg, leg.parameters * [1.0, 1.0, 1.2])
    assert lifted.feasible
    assert_possible(lifted)


@pytest.mark.parametrize("factor", [1e-4, 1.0, 1e4])
def test_thin_bodies_are_as_thick_as_rounding_needs_whatever_the_prior(leg, factor):
    """The bodies of an infeasible estimate are sheets: 1e-10 of their own extent, in units of the prior's."""
    poor = Leg.from_description(describe(with_masses(leg.description.text, factor)), leg.joint_names)
    problem = Problem.around(dynamic_parameters(poor.model), poor.reduction)
    infeasible = leg.parameters.copy()
    infeasible[-1] *= -1.0
    bodies = approach(problem, infeasible, np.diag(1.0 / np.abs(infeasible)), np.full(problem.links, 1e12))
    eigenvalues = np.linalg.eigvalsh(pseudo_inertias(bodies.unit))
    assert (eigenvalues[:, 0] / eigenvalues[:, -1]).min() == pytest.approx(1e-10, rel=1e-3)


def with_masses(text, factor):
    root = etree.fromstring(text.encode())
    for inertial in root.iter("inertial"):
        for element in (inertial.find("mass"), inertial.find("inertia")):
            for name, value in element.attrib.items():
                element.set(name, repr(factor * float(value)))
    return etree.tostring(root, encoding="unicode")


def test_pseudo_inertias_are_pinocchios():
    rng = np.random.default_rng(6)
    bodies = [pin.Inertia.Random() for _ in range(5)]
    parameters = np.array([body.toDynamicParameters() for body in bodies])
    P = pseudo_inertias(parameters)
    for body, matrix in zip(bodies, P, strict=True):
        np.testing.assert_allclose(matrix, pin.PseudoInertia.FromInertia(body).toMatrix(), atol=1e-14)
    np.testing.assert_allclose(link_parameters(P), parameters.ravel(), atol=1e-14)
    place = pin.SE3.Random()
    moved = congruence(place.homogeneous[None])[0] @ parameters[0]
    np.testing.assert_allclose(moved, place.act(bodies[0]).toDynamicParameters(), atol=1e-13)
    A = rng.standard_normal((1, 4, 4))
    P = A @ A.transpose(0, 2, 1)
    U = upper_factors(P)[0]
    np.testing.assert_allclose(U @ U.T, P[0], atol=1e-13)
    np.testing.assert_array_equal(np.tril(U, -1), 0.0)
