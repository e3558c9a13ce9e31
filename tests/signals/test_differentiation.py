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
