"""Momentum observer in C: the torque of the wearer in place of a torque to command."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.codegen import Dialect
from exoid.codegen.laws import ArrayInC, InputInC, LawInC, Needed
from exoid.control.friction import FrictionCompensation
from exoid.control.observers import MomentumObserver
from exoid.control.observers.alignment import HISTORY
from exoid.errors import ExoidError

from .forms import register_law_in_c
from .leg import leg_in_c
from .steps import step_of

MEASURED = InputInC("tau_m", "measured torques of the actuators [N m]", "reading")

CALLED: tuple[Needed, ...] = ("gravity", "springs", "rigid_bodies", "mass_matrix")
"""Functions of the leg that a step calls."""

MEMORY = {
    "p": "last momentum [N m s]",
    "u": "last sum of the torques that change it [N m]",
    "filtered": "memory of the observer [N m]",
}
"""Memory beside that of the channels' filters."""


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
    alignment, n = observer.alignment, observer.model.n
    if alignment.waiting > 0.0 or alignment.lags.any():
        raise ExoidError(
            "channels that lag behind each other have no form in C",
            remedy="align them where they are read, and give the observer torque_delay=0.0 and velocity_delay=0.0",
        )
    friction = FrictionCompensation("measured", observer.width)
    memory = [ArrayInC(name, what, np.zeros(n)) for name, what in MEMORY.items()]
    tables = [
        ArrayInC("rate", "sampling rate [Hz]", np.array(float(observer.rate))),
        ArrayInC("b", "gain of the observer, 1 - exp(-K T)", observer.filters.b[0]),
        ArrayInC("pole", "exp(-K T)", -observer.filters.a[1]),
    ]
    count = 2 + int(np.ceil(HISTORY * alignment.delay * observer.rate))
    begin = step_of("momentum_observer_begin").replace("{{count}}", str(count))
    low_pass = step_of("no_low_pass")
    if alignment.filters is not None:
        tables += _low_pass(alignment.filters[0].b[:, 0], alignment.filters[0].a[:, 0])
        low_pass = step_of("low_pass")
        memory.append(ArrayInC("low_pass", "memory of the low-pass of q, v and tau_m", np.zeros((n, 3, 2))))
    return LawInC(
        observer.model.leg.joint_names,
        "torque of the wearer = K (p - integral of (tau_m + C'v - G(q) - springs(q) - F(v) + torque of the wearer)), "
        "p = M(q) v",
        step_of("momentum_observer"),
        observer.rate,
        np.zeros(n),
        (MEASURED,),
        tuple(tables),
        tuple(memory),
        begin,
        step_of("momentum_observer_helpers").replace("{{low_pass}}", low_pass),
        "torque of the wearer on the leg",
        leg_in_c(observer.model, CALLED, friction, dialect),
    )


def _low_pass(b: FloatArray, a: FloatArray) -> list[ArrayInC]:
    """Coefficients of the low-pass of second order."""
    return [
        ArrayInC("low_b", "numerator of the low-pass", b),
        ArrayInC("low_a", "denominator of the low-pass, the first coefficient 1", a),
    ]
