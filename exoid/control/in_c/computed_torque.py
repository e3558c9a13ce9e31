"""Computed torque in C."""

from __future__ import annotations

import numpy as np

from exoid.codegen import Dialect
from exoid.codegen.laws import MOTION, ArrayInC, LawInC
from exoid.codegen.laws.safety import per_joint
from exoid.control.computed_torque import ComputedTorque

from .forms import register_law_in_c
from .leg import compensated, friction_in_words, leg_in_c
from .steps import step_of


@register_law_in_c(ComputedTorque)
def computed_torque_in_c(law: ComputedTorque, dialect: Dialect) -> LawInC:
    """Describe computed torque. The damping of its safe torque is kd times the diagonal of M at the zero pose.

    Args:
        law: The law.
        dialect: Precision.

    Returns:
        The law for C.

    Raises:
        ExoidError: A term of the model has no form in C, or gains are not those of one leg.
    """
    kp, kd = (per_joint(gain, name, law.model.n) for gain, name in ((law.kp, "kp"), (law.kd, "kd")))
    return LawInC(
        law.model.leg.joint_names,
        "tau = M(q) (a_d + kd (v_d - v) + kp (q_d - q)) + C(q, v) v + G(q) + springs(q)"
        f"{friction_in_words(law.friction)}",
        step_of("computed_torque").replace("{{friction}}", compensated(law.friction)),
        law.rate,
        kd * np.diagonal(law.model.mass_matrix(np.zeros(law.model.n))),
        MOTION,
        (ArrayInC("kp", "kp [1/s^2]", kp), ArrayInC("kd", "kd [1/s]", kd)),
        leg=leg_in_c(law.model, ("inverse_dynamics",), law.friction, dialect),
    )
