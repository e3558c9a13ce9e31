"""PD control with gravity and friction compensation in C."""

from __future__ import annotations

from exoid.codegen import Dialect
from exoid.codegen.laws import REFERENCE, LawInC
from exoid.control.gravity_friction_pd import GravityFrictionPD

from .forms import register_law_in_c
from .leg import compensated, friction_in_words, leg_in_c
from .pd import gain_tables
from .steps import step_of


@register_law_in_c(GravityFrictionPD)
def gravity_friction_pd_in_c(law: GravityFrictionPD, dialect: Dialect) -> LawInC:
    """Describe document 2's nonlinear controller, eq. (25).

    Args:
        law: The law.
        dialect: Precision.

    Returns:
        The law for C.

    Raises:
        ExoidError: A term of the model has no form in C, or gains are not those of one leg.
    """
    kp, kd = gain_tables(law.feedback, law.model.n)
    return LawInC(
        law.model.leg.joint_names,
        f"tau = Kp (q_d - q) + Kd (v_d - v) + G(q) + springs(q){friction_in_words(law.friction)}",
        step_of("gravity_friction_pd").replace("{{friction}}", compensated(law.friction)),
        law.rate,
        kd.values,
        REFERENCE,
        (kp, kd),
        leg=leg_in_c(law.model, ("gravity", "springs"), law.friction, dialect),
    )
