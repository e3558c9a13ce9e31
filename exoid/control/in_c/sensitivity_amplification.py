"""Sensitivity amplification with its motion filter in C."""

from __future__ import annotations

import numpy as np

from exoid.codegen import Dialect
from exoid.codegen.laws import ArrayInC, LawInC, Needed
from exoid.codegen.laws.safety import per_joint
from exoid.control.sensitivity_amplification import SensitivityAmplification

from .forms import register_law_in_c
from .leg import damping_of, leg_in_c
from .motion_filter import filter_tables
from .passive_friction import friction_of, passive, passive_in_words
from .steps import step_of

MEMORY = {
    "q": "filtered angles [rad]",
    "rate": "their rate of change [rad/s]",
    "v": "filtered velocities [rad/s]",
    "a": "their rate of change: accelerations [rad/s^2]",
    "q_read": "last reading of the angles [rad]",
    "v_read": "last reading of the velocities [rad/s]",
}
"""Memory of the motion filter."""


CALLED: tuple[Needed, ...] = ("gravity", "springs", "inverse_dynamics")
"""Functions of the leg that a step calls."""


@register_law_in_c(SensitivityAmplification)
def sensitivity_amplification_in_c(law: SensitivityAmplification, dialect: Dialect) -> LawInC:
    """Describe sensitivity amplification; it has no reference.

    Args:
        law: The law.
        dialect: Precision.

    Returns:
        The law for C.

    Raises:
        ExoidError: A term of the model has no form in C, or the amplification is for another number of joints.
    """
    n = law.model.n
    share = per_joint(law.share, "amplification", n)
    return LawInC(
        law.model.leg.joint_names,
        "tau = G(q) + springs(q) + (1 - 1/alpha) (M a + C v"
        f"{passive_in_words(law.friction, 'v')}) at filtered angles, velocities and accelerations",
        step_of("sensitivity_amplification").replace("{{friction}}", passive(law.friction, "state->v")),
        law.rate,
        damping_of(law.model),
        tables=(ArrayInC("share", "1 - 1/alpha", share), *filter_tables(law.filter)),
        memory=tuple(ArrayInC(name, what, np.zeros(n)) for name, what in MEMORY.items()),
        begin=step_of("sensitivity_amplification_begin"),
        leg=leg_in_c(law.model, CALLED, friction_of(law.friction), dialect),
    )
