"""Support of the leg's weight in C."""

from __future__ import annotations

from exoid.codegen import Dialect
from exoid.codegen.laws import ArrayInC, LawInC
from exoid.codegen.laws.safety import per_joint
from exoid.control.gravity_support import GravitySupport

from .forms import register_law_in_c
from .leg import damping_of, leg_in_c
from .passive_friction import friction_of, passive, passive_in_words
from .steps import step_of


@register_law_in_c(GravitySupport)
def gravity_support_in_c(law: GravitySupport, dialect: Dialect) -> LawInC:
    """Describe support of weight; it has no reference.

    Args:
        law: The law.
        dialect: Precision.

    Returns:
        The law for C.

    Raises:
        ExoidError: A term of the model has no form in C, or the share is for another number of joints.
    """
    share = per_joint(law.share, "share", law.model.n)
    return LawInC(
        law.model.leg.joint_names,
        f"tau = share (G(q) + springs(q)){passive_in_words(law.friction, 'v')}",
        step_of("gravity_support").replace("{{friction}}", passive(law.friction, "in->v")),
        law.rate,
        damping_of(law.model),
        tables=(ArrayInC("share", "share of the weight", share),),
        leg=leg_in_c(law.model, ("gravity", "springs"), friction_of(law.friction), dialect),
    )
