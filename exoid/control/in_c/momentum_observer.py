"""Momentum observer in C: the torque of the wearer in place of a torque to command."""

from __future__ import annotations

import numpy as np

from exoid.codegen import Dialect
from exoid.codegen.laws import ArrayInC, LawInC
from exoid.control.observers import MomentumObserver

from .forms import register_law_in_c
from .observer import observer_in_c

FILTERED = """        tau[j] = {{p}}_b[j] * mean + state->filtered[j];
        state->filtered[j] = {{p}}_pole[j] * tau[j];"""


@register_law_in_c(MomentumObserver)
def momentum_observer_in_c(observer: MomentumObserver, dialect: Dialect) -> LawInC:
    """Describe a momentum observer with measured velocities. It gives the torque, without band and detection.

    Args:
        observer: The observer.
        dialect: Precision.

    Returns:
        The observer for C.

    Raises:
        ExoidError: Channels lag differently, or a term of the model has no form in C.
    """
    return observer_in_c(
        observer,
        dialect,
        equation="torque of the wearer = K (p - integral of (tau_m + C'v - G(q) - springs(q) - F(v) + torque of the "
        "wearer)), p = M(q) v",
        filtered=FILTERED,
        tables=(
            ArrayInC("b", "gain of the observer, 1 - exp(-K T)", observer.filters.b[0]),
            ArrayInC("pole", "exp(-K T)", -observer.filters.a[1]),
        ),
        memory=(ArrayInC("filtered", "memory of the observer [N m]", np.zeros(observer.model.n)),),
    )
