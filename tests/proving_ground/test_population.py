"""A small population, on seeds to tune on: what exoid gets right on machines that nobody tuned it for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import exoid

from .machine import Body, draw
from .population import ESTIMATORS, best_for_all, population
from .simulate import simulate

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
    for estimator in ESTIMATORS:
        assert np.mean(np.concatenate([outcome.inside[estimator] for outcome in outcomes])) >= 0.8


@pytest.mark.nightly
def test_the_choice_is_not_far_from_the_best_model_for_all_joints(outcomes):
    assert np.mean([outcome.nrmse["joint by joint"] / best_for_all(outcome) for outcome in outcomes]) < 1.1


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


@pytest.mark.slow
def test_no_number_depends_on_the_size_of_a_machine():
    """All masses and torques 2¹⁰ times as large: so are parameters and deviations, and findings are the same."""
    machine = draw(926)
    log = simulate(machine, 12.0).recording
    found = exoid.identify(machine.leg(), log)

    def larger(bodies: tuple[Body, ...]) -> tuple[Body, ...]:
        return tuple(replace(body, mass=1024.0 * body.mass, inertia=1024.0 * body.inertia) for body in bodies)

    heavy = replace(machine, bodies=larger(machine.bodies), believed=larger(machine.believed))
    again = exoid.identify(heavy.leg(), replace(log, tau=1024.0 * log.tau))
    np.testing.assert_allclose(again.values, 1024.0 * found.values, rtol=1e-12)
    np.testing.assert_allclose(again.std, 1024.0 * found.std, rtol=1e-12)
    assert [(one.kind, one.joint) for one in again.findings] == [(one.kind, one.joint) for one in found.findings]
    assert found.findings
