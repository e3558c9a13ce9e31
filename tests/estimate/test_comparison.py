"""Two estimates are compared by a test that is right as often as it says."""

import dataclasses

import numpy as np
import pytest
from made_estimates import made
from scipy import stats
from swings import TERMS, Swing
from unchecked import identify

import exoid
from exoid import Viscous
from exoid.estimate.finding import Finding
from exoid.signals import FiniteDifference
from exoid.torques.model import TorqueModel

EXACT = FiniteDifference()


def estimate_of(leg, seed, terms=TERMS, **changes):
    swing = dataclasses.replace(Swing(leg, 50.0, 12.0, base=0.2), **changes)
    return identify(leg, swing.with_noise(np.random.default_rng(seed), 0.3), terms, preparation=EXACT)


@pytest.fixture(scope="module")
def leg():
    return exoid.load_leg("bleex", "left", "identified")


@pytest.fixture(scope="module")
def heavier(leg):
    """The same with 6 % more knee and shank inertia J2."""
    values = leg.parameters.copy()
    values[5] *= 1.06
    return leg.with_parameters(values)


def test_a_heavier_shank_is_found_and_nothing_else(leg, heavier):
    one, other = estimate_of(leg, 3), estimate_of(heavier, 4)
    comparison = exoid.compare(one, other)
    assert comparison.different == ("J2",)
    assert not comparison.notes
    doubt = Finding("play", "left_knee", 0.01, "rad", "warning", "", "", parameters=("J1", "J2"))
    (note,) = exoid.compare(one, dataclasses.replace(other, findings=(doubt,))).notes
    assert note.startswith("J2 may differ by what was found in the logs (play)")
    assert comparison.difference[5] == pytest.approx(0.06 * leg.parameters[5], rel=0.4)
    assert "different at 5 % of all: J2" in str(comparison)
    assert "the estimates differ" in str(comparison)
    assert "J2" in repr(comparison)


@pytest.mark.slow
def test_equal_legs_differ_as_rarely_as_they_should(leg):
    """60 pairs: each parameter in 5 %, any of them (Holm) and all together (Hotelling) in 5 % of the pairs."""
    pairs = [exoid.compare(estimate_of(leg, 2 * k), estimate_of(leg, 2 * k + 1)) for k in range(60)]
    assert 0.02 < np.mean([pair.p_values < 0.05 for pair in pairs]) < 0.09
    assert np.mean([(pair.adjusted < 0.05).any() for pair in pairs]) < 0.15
    assert np.mean([pair.differ for pair in pairs]) < 0.15
    assert stats.kstest([pair.p_value for pair in pairs], "uniform").pvalue > 0.001


def test_the_figures_are_those_of_the_formulas(leg):
    one, other = estimate_of(leg, 3), estimate_of(leg, 4)
    comparison = exoid.compare(one, other)
    difference, C = other.values - one.values, one.covariance + other.covariance
    np.testing.assert_array_equal(comparison.difference, difference)
    np.testing.assert_allclose(comparison.std, np.sqrt(np.diag(C)), rtol=1e-12)
    dof, P = min(one.dof, other.dof), len(difference)
    F = difference @ np.linalg.solve(C, difference) * (dof - P + 1) / (P * dof)
    assert comparison.statistic == pytest.approx(F, rel=1e-6)
    assert comparison.p_value == pytest.approx(stats.f.sf(F, P, dof - P + 1), rel=1e-6)
    spread = [np.diag(each.covariance) ** 2 / each.dof_each for each in (one, other)]
    welch = np.diag(C) ** 2 / sum(spread)
    expected = 2.0 * stats.t.sf(np.abs(difference) / np.sqrt(np.diag(C)), welch)
    np.testing.assert_allclose(comparison.p_values, expected, rtol=1e-9)


def with_prior(leg, seed, noise=0.3, **options):
    swing = Swing(leg, 50.0, 6.0, seed, base=0.2)
    options = {"prior": {"X3": (0.26, 0.02), "J3": (0.05, 0.01)}, "preparation": EXACT, **options}
    return identify(leg, swing.with_noise(np.random.default_rng(seed), noise), TERMS, **options)


def test_a_prior_of_both_counts_as_two_and_is_named(leg):
    one, other = (with_prior(leg, seed, 3.0) for seed in (1, 2))
    comparison = exoid.compare(one, other)
    np.testing.assert_allclose(comparison.std**2, one.std**2 + other.std**2, rtol=1e-6)
    assert "same prior of X3, J3" in " ".join(str(comparison).split())


def test_what_was_held_is_not_tested_and_two_values_are_named(leg):
    one, same = (with_prior(leg, seed, prior=None, known={"X1": 8.0}) for seed in (1, 2))
    other = with_prior(leg, 2, prior=None, known={"X1": 8.5})
    X1 = one.names.index("X1")
    for comparison in (exoid.compare(one, same), exoid.compare(one, other)):
        assert comparison.p_values[X1] == 1.0
        assert "X1" not in repr(comparison)
    assert not exoid.compare(one, same).notes
    assert "X1 (8 and 8.5) held at different values" in exoid.compare(one, other).notes[0]
    assert "note: X1 (8 and 8.5)" in " ".join(str(exoid.compare(one, other)).split())


def test_exact_models_differ_if_a_number_does(leg, heavier):
    exact, same, other = (
        made(TorqueModel(each, ()), each.parameters, np.zeros((9, 9))) for each in (leg, leg, heavier)
    )
    assert exoid.compare(exact, same).p_value == 1.0
    comparison = exoid.compare(exact, other)
    assert comparison.differ
    assert comparison.to_json()["p_value"] == 0.0


@pytest.mark.parametrize(
    "estimators",
    [("wls", "huber"), *(pytest.param(each, marks=pytest.mark.slow) for each in (("ols", "huber"), ("wls", "wls")))],
    ids="-".join,
)
def test_two_estimators_of_one_recording_differ_by_no_more_than_the_sum_of_their_errors(leg, estimators):
    """p-values are upper bounds: of 8 recordings none is called different, and the note says why."""
    swing = Swing(leg, 50.0, 12.0, base=0.2)
    for seed in range(8):
        log = swing.with_noise(np.random.default_rng(seed), 0.3)
        one, other = (identify(leg, log, TERMS, each, preparation=EXACT) for each in estimators)
        found = exoid.compare(one, other)
        np.testing.assert_allclose(found.std, one.std + other.std)
        np.testing.assert_array_equal(found.difference, other.values - one.values)
        assert not found.differ
        assert found.adjusted.min() > 0.05
        assert "their errors depend on each other" in found.notes[0]


def test_two_estimators_that_disagree_by_more_than_that_are_found(leg):
    """A term that is missing in one of them moves what stands for it."""
    log = Swing(leg, 50.0, 12.0, base=0.2).with_noise(np.random.default_rng(1), 0.05)
    one, other = (identify(leg, log, terms, preparation=EXACT) for terms in (TERMS, (Viscous(),)))
    found = exoid.compare(one, other)
    assert found.differ
    assert found.adjusted[found.names.index("d_ankle")] < 0.01
