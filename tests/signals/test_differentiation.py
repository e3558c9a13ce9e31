"""Finite differences: exact on polynomials, of the promised order elsewhere."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exoid.signals.differentiation import central_difference, second_difference

RATE = 40.0
TIME = np.arange(30) / RATE


def polynomial(coefficients):
    return np.polynomial.Polynomial(coefficients)


@given(coefficients=st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=5))
@settings(deadline=None)
def test_differences_are_exact_on_polynomials_up_to_the_order_promised_ends_included(coefficients):
    cases = [(central_difference, 1, 2, 3), (central_difference, 1, 4, 5)]
    cases += [(second_difference, 2, 2, 4), (second_difference, 2, 4, 5)]
    for difference, derivative, accuracy, terms in cases:
        curve = polynomial(coefficients[:terms])
        exact = curve.deriv(derivative)(TIME)
        np.testing.assert_allclose(difference(curve(TIME), RATE, accuracy), exact, atol=1e-8)


@pytest.mark.parametrize("accuracy", [2, 4])
@pytest.mark.parametrize("difference", [central_difference, second_difference])
@pytest.mark.parametrize("rows", [slice(None), slice(5, -5)], ids=["with ends", "inside"])
def test_halving_the_interval_divides_the_error_by_two_to_the_order(difference, accuracy, rows):
    omega = 2.0

    def error(rate):
        time = np.arange(int(3 * rate) + 1) / rate
        exact = omega * np.cos(omega * time) if difference is central_difference else -(omega**2) * np.sin(omega * time)
        return np.abs(difference(np.sin(omega * time), rate, accuracy) - exact)[rows].max()

    assert error(50.0) / error(100.0) == pytest.approx(2.0**accuracy, rel=0.2)


@pytest.mark.parametrize(
    ("difference", "accuracy", "power", "divisor"),
    [
        (central_difference, 2, 2, 6),
        (central_difference, 4, 4, 30),
        (second_difference, 2, 2, 12),
        (second_difference, 4, 4, 90),
    ],
)
def test_the_relative_error_on_a_sine_is_the_documented_one(difference, accuracy, power, divisor):
    omega, rate = 2.0 * np.pi, 100.0
    time = np.arange(200) / rate
    wave = np.exp(1j * omega * time)
    out = difference(wave.real, rate, accuracy) + 1j * difference(wave.imag, rate, accuracy)
    factor = 1j * omega if difference is central_difference else -(omega**2)
    error = 1.0 - (out / (factor * wave))[10:-10].real
    np.testing.assert_allclose(error, (omega / rate) ** power / divisor, rtol=0.01)


@pytest.mark.parametrize("difference", [central_difference, second_difference])
def test_columns_are_differenced_one_by_one(difference):
    x = np.random.default_rng(0).normal(size=(30, 2, 3))
    out = difference(x, RATE)
    assert out.shape == x.shape
    np.testing.assert_allclose(out[:, 1, 2], difference(x[:, 1, 2], RATE), rtol=1e-12)
