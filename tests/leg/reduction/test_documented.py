"""X, Y and J as a linear map of link parameters: consistent, complete and minimal."""

import numpy as np
import pytest
from planar_chains import assert_relative, joint_torque_regressor, random_chain, random_motion

import exoid
from exoid import Leg
from exoid.leg.reduction.numeric import numeric

CUMULATIVE = pytest.mark.parametrize("cumulative", [True, False])


def labels_of(leg: Leg) -> list[str]:
    return [f"link{k}" for k in range(1, len(leg.joint_names) + 1)]


@CUMULATIVE
def test_spreading_and_collecting_parameters_is_the_identity(cumulative):
    rng = np.random.default_rng(0)
    for number in range(20):
        reduction = random_chain(rng, 1 + number % 5).leg(cumulative=cumulative).reduction
        p = len(reduction.names)
        np.testing.assert_allclose(reduction.collect @ reduction.spread, np.eye(p), rtol=0, atol=1e-14)


@pytest.mark.parametrize(("name", "count"), [("bleex", 9), ("cuhk", 6)])
@CUMULATIVE
def test_the_documents_claim_of_nine_and_six_parameters_is_true(name, count, cumulative, side):
    """As many as independent columns of Pinocchio's regressor, and in the same space of link parameters."""
    built_in = exoid.load_leg(name, side=side)
    leg = Leg.from_description(built_in.description, built_in.joint_names, cumulative=cumulative)
    base = numeric(leg.model, labels_of(leg))
    documented = leg.reduction.collect
    assert (len(base.names), len(leg.parameters), np.linalg.matrix_rank(documented)) == (count, count, count)
    assert np.linalg.matrix_rank(np.vstack([documented, base.collect]), tol=1e-8) == count


@CUMULATIVE
def test_random_chains_have_three_parameters_a_joint_neither_more_nor_fewer(cumulative):
    rng = np.random.default_rng(1)
    for number in range(15):
        leg = random_chain(rng, 1 + number % 5).leg(cumulative=cumulative)
        n = len(leg.joint_names)
        base = numeric(leg.model, labels_of(leg), seed=number)
        assert len(base.names) == len(leg.parameters) == 3 * n
        assert np.linalg.matrix_rank(leg.reduction.collect) == 3 * n
        both = np.vstack([leg.reduction.collect, base.collect])
        assert np.linalg.matrix_rank(both, tol=1e-7 * np.linalg.norm(both, 2)) == 3 * n


def test_the_two_definitions_of_j_differ_by_the_j_below(built_in_leg):
    legs = [
        Leg.from_description(built_in_leg.description, built_in_leg.joint_names, cumulative=c) for c in (True, False)
    ]
    with_below, own = (leg.parameters.reshape(-1, 3) for leg in legs)
    np.testing.assert_array_equal(with_below[:, :2], own[:, :2])
    np.testing.assert_allclose(with_below[:, 2], np.cumsum(own[::-1, 2])[::-1], rtol=1e-14)
    assert with_below[0, 2] > 1.1 * own[0, 2]
    q, v, a = random_motion(np.random.default_rng(3), len(legs[0].joint_names))
    torques = [leg.regressor(q, v, a) @ leg.parameters for leg in legs]
    assert_relative(torques[0], torques[1], 1e-13)


@CUMULATIVE
def test_the_reduction_of_pinocchios_regressor_keeps_every_torque(cumulative):
    """Y π = (Y S)(K π) also for link parameters other than the model's."""
    rng = np.random.default_rng(4)
    leg = random_chain(rng, 4).leg(cumulative=cumulative)
    Y = joint_torque_regressor(leg.model, *random_motion(rng, 4))
    for link_parameters in rng.standard_normal((5, 40)):
        reduced = leg.reduction.reduce(Y) @ leg.reduction.parameters(link_parameters)
        assert_relative(reduced, Y @ link_parameters, 1e-12)
