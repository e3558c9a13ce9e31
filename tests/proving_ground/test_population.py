"""A small population, on seeds to tune on: what exoid gets right on machines that nobody tuned it for."""

from __future__ import annotations

import numpy as np
import pytest

from .population import best_for_all, population

OF_TORQUES = "sign of one torque", "one torque 40 ms late", "two far joints swapped", "velocity 5 ms late"


@pytest.fixture(scope="module")
def outcomes():
    return list(population((5, 21, 22), seconds=8.0))


@pytest.mark.nightly
def test_small_machines_are_identified_by_their_log_and_a_wrong_cad(outcomes):
    for outcome in outcomes:
        assert not outcome.refused
        assert outcome.nrmse["joint by joint"] <= outcome.nrmse["default"]
        assert outcome.named["sign of one torque"]
        assert outcome.named["velocity 5 ms late"]
    assert np.mean(np.concatenate([outcome.inside for outcome in outcomes])) >= 0.8


@pytest.mark.nightly
def test_the_choice_is_not_far_from_the_best_model_for_all_joints(outcomes):
    assert np.mean([outcome.nrmse["joint by joint"] / best_for_all(outcome) for outcome in outcomes]) < 1.1


@pytest.mark.nightly
def test_the_same_seed_gives_the_same_figures():
    one, same = (next(iter(population((5,), seconds=4.0, features=("fit",)))) for _ in range(2))
    assert one.nrmse == same.nrmse
    assert one.nrmse["default"] < 0.5


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*(pytest.param(k, marks=pytest.mark.nightly) for k in (6, 9)), 25])
def test_faults_of_torques_are_named_on_a_floating_base(seed):
    """Rows of the base are beside those of the joints: the doctor looks at both."""
    (outcome,) = population((seed,), features=("doctor",), mistakes=OF_TORQUES)
    assert all(outcome.named[mistake] for mistake in OF_TORQUES)


@pytest.mark.slow
def test_faults_of_one_torque_of_six_are_named():
    (outcome,) = population((3,), features=("doctor",), mistakes=OF_TORQUES[::2])
    assert all(outcome.named.values())
    assert len(outcome.named) == 2
