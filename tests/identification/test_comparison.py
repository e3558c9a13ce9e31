"""Two estimates are compared by a test that is right as often as it says."""

import dataclasses
import json

import numpy as np
import pytest
from scipy import stats
from swings import TERMS, Swing

import exoid
from exoid import ExoidError, Offset, Viscous
from exoid.identification import comparison_to_json
from exoid.signals import FiniteDifference

EXACT = FiniteDifference()


def estimate_of(leg, seed, terms=TERMS, **changes):
    swing = dataclasses.replace(Swing(leg, 50.0, 12.0, base=0.2), **changes)
    return exoid.identify(leg, swing.with_noise(np.random.default_rng(seed), 0.3), terms, preparation=EXACT)


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
    comparison = exoid.compare(estimate_of(leg, 3), estimate_of(heavier, 4))
    assert comparison.differ
    assert [n for n, p in zip(comparison.names, comparison.adjusted, strict=True) if p < 0.05] == ["J2"]
    assert comparison.difference[5] == pytest.approx(0.06 * leg.parameters[5], rel=0.4)
    assert "different at 5 % of all: J2" in str(comparison)
    assert "the estimates differ" in str(comparison)
    assert "J2" in repr(comparison)


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


def test_the_order_changes_only_the_sign(leg):
    one, other = estimate_of(leg, 5), estimate_of(leg, 6)
    forth, back = exoid.compare(one, other), exoid.compare(other, one)
    np.testing.assert_array_equal(forth.difference, -back.difference)
    assert forth.p_value == pytest.approx(back.p_value)
    assert (forth.adjusted >= forth.p_values).all()


def test_only_common_parameters_are_compared(leg):
    comparison = exoid.compare(estimate_of(leg, 7), estimate_of(leg, 8, (Viscous(), Offset())))
    assert comparison.names == (*leg.parameter_names, "d_hip", "d_knee", "d_ankle")


def test_estimates_from_one_recording_are_refused(leg):
    estimate = estimate_of(leg, 9)
    with pytest.raises(ExoidError, match=r"both estimates were made from array.*different recordings"):
        exoid.compare(estimate, estimate)


def test_a_comparison_is_json_and_cannot_be_changed(leg):
    comparison = exoid.compare(estimate_of(leg, 10), estimate_of(leg, 11))
    data = json.loads(json.dumps(comparison_to_json(comparison), allow_nan=False))
    assert data["difference"]["J1"] == comparison.difference[2]
    with pytest.raises(ValueError, match="read-only"):
        comparison.difference[0] = 0.0
