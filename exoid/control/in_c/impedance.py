"""Impedance control in C."""

from __future__ import annotations

from exoid.codegen import Dialect
from exoid.codegen.laws import MOTION, ArrayInC, LawInC
from exoid.codegen.laws.safety import per_joint
from exoid.control.impedance import Impedance

from .forms import register_law_in_c
from .leg import damping_of, leg_in_c
from .passive_friction import friction_of, passive, passive_in_words
from .steps import step_of


@register_law_in_c(Impedance)
def impedance_in_c(law: Impedance, dialect: Dialect) -> LawInC:
    """Describe impedance control.

    Args:
        law: The law.
        dialect: Precision.

    Returns:
        The law for C.

    Raises:
        ExoidError: A term of the model has no form in C, or gains are not those of one leg.
    """
    n = law.model.n
    stiffness, damping = per_joint(law.stiffness, "stiffness", n), per_joint(law.damping, "damping", n)
    return LawInC(
        law.model.leg.joint_names,
        "tau = K (q_d - q) + D (v_d - v) + M(q) a_d + C(q, v) v + G(q) + springs(q)"
        f"{passive_in_words(law.friction, 'v')}",
        step_of("impedance").replace("{{friction}}", passive(law.friction, "in->v")),
        law.rate,
        damping_of(law.model),
        MOTION,
        (ArrayInC("kp", "K [N m/rad]", stiffness), ArrayInC("kd", "D [N m s/rad]", damping)),
        leg=leg_in_c(law.model, ("inverse_dynamics",), friction_of(law.friction), dialect),
    )
