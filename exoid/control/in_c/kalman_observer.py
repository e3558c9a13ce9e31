"""Kalman observer in C: the torque of the wearer by a filter of second order."""

from __future__ import annotations

import numpy as np

from exoid.codegen import Dialect
from exoid.codegen.laws import ArrayInC, LawInC
from exoid.control.observers import KalmanObserver

from .forms import register_law_in_c
from .observer import observer_in_c

FILTERED = """        tau[j] = {{p}}_b[j] * mean + state->filtered[j];
        state->filtered[j] = state->late[j] - {{p}}_a1[j] * tau[j];
        state->late[j] = -{{p}}_a2[j] * tau[j];"""


@register_law_in_c(KalmanObserver)
def kalman_observer_in_c(observer: KalmanObserver, dialect: Dialect) -> LawInC:
    """Describe a Kalman observer with measured velocities. It gives the torque, without band and detection.

    Its gains are those of the steady state, so that no Riccati equation is solved in C.

    Args:
        observer: The observer.
        dialect: Precision.

    Returns:
        The observer for C.

    Raises:
        ExoidError: Channels lag differently, or a term of the model has no form in C.
    """
    (b, _, _), (_, a1, a2) = observer.filters.b, observer.filters.a
    nothing = np.zeros(observer.model.n)
    return observer_in_c(
        observer,
        dialect,
        equation="torque of the wearer by a steady Kalman filter of p' = tau_m + C'v - G(q) - springs(q) - F(v) + "
        "torque of the wearer, a random walk, p = M(q) v",
        filtered=FILTERED,
        tables=(
            ArrayInC("b", "gain of the balance, L2 T", b),
            ArrayInC("a1", "denominator of the filter, L1 + L2 T - 2", a1),
            ArrayInC("a2", "denominator of the filter, 1 - L1", a2),
        ),
        memory=(
            ArrayInC("filtered", "memory of the observer [N m]", nothing),
            ArrayInC("late", "memory of the observer, one sample older [N m]", nothing),
        ),
    )
