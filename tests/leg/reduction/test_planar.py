"""The batched closed form against Pinocchio: its RNEA and its regressor, on every leg and on random chains."""

from dataclasses import replace

import numpy as np
import pytest
from planar_chains import assert_relative, joint_torque_regressor, random_chain, random_motion
from small_urdfs import OFFSET_BODY as BODY

import exoid
from exoid import Leg, TorsoMotion
from exoid.leg.model import with_dynamic_parameters
from exoid.leg.reduction import planar
from exoid.leg.reduction.planar_machine import PlanarMachine

TOLERANCE = 1e-12
CUMULATIVE = pytest.mark.parametrize("cumulative", [True, False])


def with_definition(leg: Leg, *, cumulative: bool) -> Leg:
    return Leg.from_description(leg.description, leg.joint_names, cumulative=cumulative)


def check_against_pinocchio(leg: Leg, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> None:
    W = leg.regressor(q, v, a)
    assert W.shape == (*q.shape, 3 * q.shape[1])
    assert_relative(W @ leg.parameters, leg.inverse_dynamics(q, v, a), TOLERANCE)
    assert_relative(W, leg.reduction.reduce(joint_torque_regressor(leg.model, q, v, a)), TOLERANCE)


@CUMULATIVE
def test_built_in_legs_have_pinocchios_torques_and_regressor(built_in_leg, cumulative):
    leg = with_definition(built_in_leg, cumulative=cumulative)
    assert leg.chain is not None
    check_against_pinocchio(leg, *random_motion(np.random.default_rng(0), len(leg.joint_names), 200))


@CUMULATIVE
def test_random_planar_chains_have_pinocchios_torques_and_regressor(cumulative):
    rng = np.random.default_rng(1)
    for number in range(120):
        chain = random_chain(rng, 1 + number % 5, continuous=True)
        leg = chain.leg(cumulative=cumulative)
        assert leg.chain is not None, chain.text
        check_against_pinocchio(leg, *random_motion(rng, chain.n, 15))


@CUMULATIVE
def test_random_planar_chains_have_the_parameters_of_their_point_masses(cumulative):
    rng = np.random.default_rng(2)
    for number in range(100):
        chain = random_chain(rng, 1 + number % 5)
        np.testing.assert_allclose(
            chain.leg(cumulative=cumulative).parameters, chain.parameters(cumulative=cumulative), rtol=0, atol=1e-12
        )


def test_a_chain_of_either_world_axis_and_any_sign_is_read_as_planar():
    rng = np.random.default_rng(4)
    for axis, lateral in (("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0])):
        for _ in range(10):
            chain = random_chain(rng, 4, axis=axis)
            read = chain.leg().chain
            np.testing.assert_array_equal(read.signs, [segment.sign for segment in chain.segments])
            np.testing.assert_allclose(read.plane.lateral, lateral, atol=1e-12)
            offsets = [segment.offset[[0, 2]] for segment in chain.segments[1:]]
            np.testing.assert_allclose(read.offsets, offsets, atol=1e-12)


@pytest.mark.parametrize("samples", [1, 8191, 8192, 8193, 20000])
def test_a_batch_is_the_same_as_its_samples_one_by_one(samples, leg):
    assert planar.BLOCK == 8192
    q, v, a = random_motion(np.random.default_rng(samples), 3, samples)
    W = leg.regressor(q, v, a)
    assert W.shape == (samples, 3, 9)
    some = np.unique(np.clip([0, 1, 8190, 8191, 8192, 8193, 16383, 16384, 19999], 0, samples - 1))
    assert_relative(W[some], np.concatenate([leg.regressor(q[i], v[i], a[i]) for i in some]), 1e-15)
    assert_relative(W @ leg.parameters, leg.inverse_dynamics(q, v, a), TOLERANCE)


@CUMULATIVE
@pytest.mark.parametrize("turns", [10, 1000])
def test_many_turns_lose_no_more_accuracy_than_the_angles_have(cumulative, turns):
    """Sums of large angles are rounded: 1000 turns carry about 1e-12 rad."""
    leg = with_definition(exoid.load_leg("bleex"), cumulative=cumulative)
    q, v, a = random_motion(np.random.default_rng(8), 3, 300, turns=turns)
    expected = leg.inverse_dynamics(q, v, a)
    assert_relative(leg.regressor(q, v, a) @ leg.parameters, expected, TOLERANCE * turns)


@pytest.mark.parametrize("base", [0.0, np.pi / 2, np.pi, -np.pi, 2 * np.pi, 3 * np.pi])
def test_angles_at_and_near_the_pole_of_the_half_angle_tangent_are_accurate(base, leg):
    near = base + np.array([0.0, 1e-300, 1e-16, -1e-16, 1e-12, -1e-12, 1e-8, -1e-8, 1e-4, -1e-4])
    beside = [np.nextafter(base, np.inf), np.nextafter(base, -np.inf)]
    angles = np.concatenate([near, beside])
    q = np.zeros((3 * len(angles), 3))
    for joint in range(3):
        q[joint * len(angles) : (joint + 1) * len(angles), joint] = angles
    v, a = np.random.default_rng(9).uniform(-5, 5, (2, *q.shape))
    check_against_pinocchio(leg, q, v, a)


def two_joints(first: str, second: str, *, kind: str = "revolute", parent: str = "b", rpy: str = "0 0 0") -> Leg:
    """Two joints with the given axes, the second on link ``parent``; rpy turns the first joint's frame."""
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    return Leg.from_description(
        exoid.leg.description.describe(
            f'<robot name="r"><link name="a"/><link name="b">{BODY}</link><link name="c">{BODY}</link>'
            f'<joint name="one" type="{kind}"><origin xyz="0 0 1" rpy="{rpy}"/><parent link="a"/><child link="b"/>'
            f'<axis xyz="{first}"/>{limit}</joint>'
            f'<joint name="two" type="revolute"><origin xyz="0.1 0.2 -0.3"/><parent link="{parent}"/><child link="c"/>'
            f'<axis xyz="{second}"/>{limit}</joint></robot>'
        )
    )


@pytest.mark.parametrize(
    "arguments",
    [
        {"first": "0 0 1", "second": "0 0 1"},
        {"first": "0 -1 0", "second": "0 -1 0.001"},
        {"first": "0 -1 0", "second": "1 0 0"},
        {"first": "0 -1 0", "second": "0 -1 0", "rpy": "0.001 0 0"},
        {"first": "0 -1 0", "second": "0 -1 0", "kind": "prismatic"},
        {"first": "0 -1 0", "second": "0 -1 0", "parent": "a"},
    ],
    ids=["vertical axes", "slanted knee", "crossed axes", "slanted hip", "prismatic hip", "two legs"],
)
def test_other_robots_are_not_taken_for_planar_chains(arguments):
    leg = two_joints(**arguments)
    assert leg.chain is None
    q, v, a = random_motion(np.random.default_rng(10), 2)
    assert_relative(leg.regressor(q, v, a) @ leg.parameters, leg.inverse_dynamics(q, v, a), 1e-9)
    minus = replace(leg, model=with_dynamic_parameters(leg.model, -leg.link_parameters))  # as of estimates
    assert_relative(minus.inverse_dynamics(q, v, a, TorsoMotion()), -leg.inverse_dynamics(q, v, a), 1e-9)


def test_another_gravity_is_not_taken_for_the_documents(built_in_leg):
    """The closed form knows 9.81 m/s² only."""
    model = built_in_leg.model.copy()
    model.gravity.linear = np.array([0.0, 0.0, -1.62])
    assert PlanarMachine.from_model(model) is None
