"""Assistance as needed with its learnt torque in C."""

from __future__ import annotations

import numpy as np

from exoid.codegen import Dialect
from exoid.codegen.laws import REFERENCE, ArrayInC, LawInC
from exoid.codegen.laws.safety import per_joint
from exoid.control.assist_as_needed import AssistAsNeeded

from .forms import register_law_in_c
from .leg import damping_of, leg_in_c
from .passive_friction import friction_of, passive, passive_in_words
from .steps import step_of


@register_law_in_c(AssistAsNeeded)
def assist_as_needed_in_c(law: AssistAsNeeded, dialect: Dialect) -> LawInC:
    """Describe assistance as needed.

    Args:
        law: The law.
        dialect: Precision.

    Returns:
        The law for C.

    Raises:
        ExoidError: A term of the model has no form in C, or numbers are not those of one leg.
    """
    n = law.model.n
    stiffness, damping, tunnel, learning = (
        per_joint(getattr(law, name), name, n) for name in ("stiffness", "damping", "tunnel", "learning")
    )
    kept = float(np.exp(-1.0 / (law.rate * law.forgetting)))
    tables = {
        "kp": (stiffness, "K beyond the tunnel [N m/rad]"),
        "kd": (damping, "D beyond the tunnel [N m s/rad]"),
        "tunnel": (tunnel, "half width of the tunnel [rad]"),
        "gained": (law.forgetting * (1.0 - kept) * learning, "learnt in one step [N m/rad]"),
        "kept": (np.array(kept), "share of the learnt torque that one step keeps"),
    }
    return LawInC(
        law.model.leg.joint_names,
        f"tau = G(q) + springs(q){passive_in_words(law.friction, 'v')} + K e' + w D (v_d - v) + learnt, "
        "e' the error beyond the tunnel",
        step_of("assist_as_needed").replace("{{friction}}", passive(law.friction, "in->v")),
        law.rate,
        damping_of(law.model),
        REFERENCE,
        tuple(ArrayInC(name, what, values) for name, (values, what) in tables.items()),
        (ArrayInC("learnt", "learnt assistance [N m]", np.zeros(n)),),
        leg=leg_in_c(law.model, ("gravity", "springs"), friction_of(law.friction), dialect),
    )
