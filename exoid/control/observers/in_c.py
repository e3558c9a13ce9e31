"""The momentum observer in C."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from exoid._typing import FloatArray
from exoid.codegen import ArrayInC, Dialect, InputInC, LawInC
from exoid.codegen.templates import step_of
from exoid.control.c_description import describe
from exoid.control.friction import FrictionCompensation
from exoid.control.model import ControlModel
from exoid.errors import NotSupportedError
from exoid.signals.checks import FASTEST

from .alignment import Alignment, JointFilter


def observer_in_c(
    model: ControlModel, alignment: Alignment, one: JointFilter, settling: int, width: float, dialect: Dialect
) -> LawInC:
    """Describe an observer with measured velocities. It gives the torque, without band and detection."""
    n, rate = model.n, alignment.rate
    if alignment.waiting > 0.0 or alignment.lags.any():
        remedy = "align them where they are read, and give the observer torque_delay=0.0 and velocity_delay=0.0"
        raise NotSupportedError("channels that lag behind each other have no form in C", remedy=remedy)
    tables: dict[str, tuple[FloatArray | float, str]] = {
        "rate": (rate, "sampling rate [Hz]"),
        "b": (np.full(n, one.b[0]), "gain of the observer, 1 - exp(-K T)"),
        "pole": (np.full(n, -one.a[1]), "exp(-K T)"),
    }
    unfiltered = np.array([1.0, 0.0, 0.0])  # as a low-pass that leaves channels as they are
    low_pass = JointFilter(unfiltered, unfiltered) if alignment.filters is None else alignment.filters[0]
    tables["low_b"] = low_pass.b, "numerator of the low-pass"
    tables["low_a"] = low_pass.a, "denominator of the low-pass, the first coefficient 1"
    remembered = ArrayInC("low_pass", "memory of the low-pass of q, v and tau_m", np.zeros((n, 3, 2)))
    law = describe(
        model,
        FrictionCompensation("measured", width),
        rate,
        dialect,
        equation="torque of the wearer = K (p - integral of (tau_m + C'v - G(q) - springs(q) - F(v) + torque of the "
        "wearer)), p = M(q) v",
        step=step_of("observer"),
        calls=("springs", "bodies"),
        inputs=(InputInC("tau_m", "measured torques of the actuators [N m]", "reading"),),
        tables=tables,
        memory={
            "p": "last momentum [N m s]",
            "u": "last sum of the torques that change it [N m]",
            "filtered": "memory of the observer [N m]",
        },
        begin=step_of("observer_begin").replace("{{count}}", str(alignment.history)),
        damping=np.zeros(n),
    )
    return replace(
        law,
        memory=(*law.memory, remembered),
        helpers=step_of("observer_helpers"),
        gives="torque of the wearer on the leg",
        limit=np.inf,  # he may turn passive joints, too
        settling=settling,
        farthest=FASTEST / rate,
    )
