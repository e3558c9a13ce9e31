"""The momentum observer in C."""

from __future__ import annotations

import numpy as np

from exoid.codegen import ArrayInC, Dialect, InputInC, LawInC
from exoid.codegen.templates import step_of
from exoid.control.c_description import leg_in_c
from exoid.control.friction import FrictionCompensation
from exoid.control.model import ControlModel
from exoid.errors import NotSupportedError
from exoid.signals.checks import FASTEST

from .alignment import HISTORY, Alignment, JointFilter

MEASURED = InputInC("tau_m", "measured torques of the actuators [N m]", "reading")

MEMORY = {
    "p": "last momentum [N m s]",
    "u": "last sum of the torques that change it [N m]",
    "filtered": "memory of the observer [N m]",
}
"""Memory beside that of the low-pass."""


def observer_in_c(
    model: ControlModel, alignment: Alignment, one: JointFilter, settling: int, width: float, dialect: Dialect
) -> LawInC:
    """Describe an observer with measured velocities. It gives the torque, without band and detection."""
    n, rate, friction = model.n, alignment.rate, FrictionCompensation("measured", width)
    if alignment.waiting > 0.0 or alignment.lags.any():
        remedy = "align them where they are read, and give the observer torque_delay=0.0 and velocity_delay=0.0"
        raise NotSupportedError("channels that lag behind each other have no form in C", remedy=remedy)
    constants = {
        "rate": (np.array(float(rate)), "sampling rate [Hz]"),
        "b": (np.full(n, one.b[0]), "gain of the observer, 1 - exp(-K T)"),
        "pole": (np.full(n, -one.a[1]), "exp(-K T)"),
    }
    remembered = [ArrayInC(name, what, np.zeros(n)) for name, what in MEMORY.items()]
    count = 2 + int(np.ceil(HISTORY * alignment.delay * rate))
    low_pass = step_of("no_low_pass")
    if alignment.filters is not None:
        low_pass = step_of("low_pass")
        b, a = alignment.filters[0].b, alignment.filters[0].a
        constants["low_b"] = b, "numerator of the low-pass"
        constants["low_a"] = a, "denominator of the low-pass, the first coefficient 1"
        remembered.append(ArrayInC("low_pass", "memory of the low-pass of q, v and tau_m", np.zeros((n, 3, 2))))
    return LawInC(
        model.leg.joint_names,
        "torque of the wearer = K (p - integral of (tau_m + C'v - G(q) - springs(q) - F(v) + torque of the wearer)), "
        "p = M(q) v",
        step_of("observer"),
        rate,
        np.zeros(n),
        (MEASURED,),
        tuple(ArrayInC(name, what, values) for name, (values, what) in constants.items()),
        tuple(remembered),
        step_of("observer_begin").replace("{{count}}", str(count)),
        step_of("observer_helpers").replace("{{low_pass}}", low_pass),
        "torque of the wearer on the leg",
        leg_in_c(model, ("gravity", "springs", "rigid_bodies", "mass_matrix"), friction, dialect),
        settling=settling,
        farthest=FASTEST / rate,
    )
