"""PD control with feedforward of the inverse dynamics in C."""

from __future__ import annotations

from exoid.codegen import Dialect
from exoid.codegen.laws import MOTION, LawInC
from exoid.control.feedforward_pd import FeedforwardPD

from .forms import register_law_in_c
from .leg import compensated, friction_in_words, leg_in_c
from .pd import gain_tables
from .steps import step_of


@register_law_in_c(FeedforwardPD)
def feedforward_pd_in_c(law: FeedforwardPD, dialect: Dialect) -> LawInC:
    """Describe PD control with feedforward.

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
        "tau = Kp (q_d - q) + Kd (v_d - v) + M(q_d) a_d + C(q_d, v_d) v_d + G(q_d) + springs(q_d)"
        f"{friction_in_words(law.friction)}",
        step_of("feedforward_pd").replace("{{friction}}", compensated(law.friction)),
        law.rate,
        kd.values,
        MOTION,
        (kp, kd),
        leg=leg_in_c(law.model, ("inverse_dynamics",), law.friction, dialect),
    )
