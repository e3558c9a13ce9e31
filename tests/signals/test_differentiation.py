"""Finite differences: exact on polynomials, of the promised order elsewhere."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exoid.signals.differentiation import difference

RATE = 40.0
TIME = np.arange(30) / RATE


def polynomial(coefficients):
    return np.polynomial.Polynomial(coefficients)


@given(coefficients=st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=5))
@settings(deadline=None)
def test_differences_are_exact_on_polynomials_up_to_the_order_promised_ends_included(coefficients):
    for order, accuracy, terms in [(1, 2, 3), (1, 4, 5), (2, 2, 4), (2, 4, 5)]:
        curve = polynomial(coefficients[:terms])
        exact = curve.deriv(order)(TIME)
        np.testing.assert_allclose(difference(curve(TIME), RATE, order, accuracy), exact, atol=1e-8)


@pytest.mark.parametrize(("order", "accuracy", "divisor"), [(1, 2, 6), (1, 4, 30), (2, 2, 12), (2, 4, 90)])
def test_the_relative_error_on_a_sine_is_the_documented_one(order, accuracy, divisor):
    omega, rate = 2.0 * np.pi, 100.0
    time = np.arange(200) / rate
    wave = np.exp(1j * omega * time)
    out = difference(wave.real, rate, order, accuracy) + 1j * difference(wave.imag, rate, order, accuracy)
    factor = (1j * omega) ** order
    error = 1.0 - (out / (factor * wave))[10:-10].real
    np.testing.assert_allclose(error, (omega / rate) ** accuracy / divisor, rtol=0.01)
