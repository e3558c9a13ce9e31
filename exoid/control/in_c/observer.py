"""Observers in C: what momentum and Kalman observer share, which is all but the filter behind the balance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.codegen import Dialect
from exoid.codegen.laws import ArrayInC, InputInC, LawInC, Needed
from exoid.control.friction import FrictionCompensation
from exoid.control.observers import TorqueObserver
from exoid.control.observers.alignment import HISTORY
from exoid.errors import ExoidError

from .leg import leg_in_c
from .steps import step_of

MEASURED = InputInC("tau_m", "measured torques of the actuators [N m]", "reading")

CALLED: tuple[Needed, ...] = ("gravity", "springs", "rigid_bodies", "mass_matrix")
"""Functions of the leg that a step calls."""

MEMORY = {"p": "last momentum [N m s]", "u": "last sum of the torques that change it [N m]"}
"""Memory beside that of the filters."""


def observer_in_c(
    observer: TorqueObserver,
    dialect: Dialect,
    *,
    equation: str,
    filtered: str,
    tables: Sequence[ArrayInC],
    memory: Sequence[ArrayInC],
) -> LawInC:
    """Describe an observer with measured velocities. It gives the torque, without band and detection."""
    alignment, n = observer.alignment, observer.model.n
    if alignment.waiting > 0.0 or alignment.lags.any():
        raise ExoidError(
            "channels that lag behind each other have no form in C",
            remedy="align them where they are read, and give the observer torque_delay=0.0 and velocity_delay=0.0",
        )
    friction = FrictionCompensation("measured", observer.width)
    constants = [ArrayInC("rate", "sampling rate [Hz]", np.array(float(observer.rate))), *tables]
    remembered = [*(ArrayInC(name, what, np.zeros(n)) for name, what in MEMORY.items()), *memory]
    count = 2 + int(np.ceil(HISTORY * alignment.delay * observer.rate))
    low_pass = step_of("no_low_pass")
    if alignment.filters is not None:
        constants += _low_pass(alignment.filters[0].b[:, 0], alignment.filters[0].a[:, 0])
        low_pass = step_of("low_pass")
        remembered.append(ArrayInC("low_pass", "memory of the low-pass of q, v and tau_m", np.zeros((n, 3, 2))))
    return LawInC(
        observer.model.leg.joint_names,
        equation,
        step_of("observer").replace("{{filtered}}", filtered),
        observer.rate,
        np.zeros(n),
        (MEASURED,),
        tuple(constants),
        tuple(remembered),
        step_of("observer_begin").replace("{{count}}", str(count)),
        step_of("observer_helpers").replace("{{low_pass}}", low_pass),
        "torque of the wearer on the leg",
        leg_in_c(observer.model, CALLED, friction, dialect),
    )


def _low_pass(b: FloatArray, a: FloatArray) -> list[ArrayInC]:
    """Coefficients of the low-pass of second order."""
    return [
        ArrayInC("low_b", "numerator of the low-pass", b),
        ArrayInC("low_a", "denominator of the low-pass, the first coefficient 1", a),
    ]
