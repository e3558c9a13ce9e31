"""Linear-quadratic regulation about a trajectory in C."""

from __future__ import annotations

import numpy as np

from exoid.codegen import Dialect
from exoid.codegen.laws import MOTION, ArrayInC, InputInC, LawInC
from exoid.control.lqr import LQR

from .forms import register_law_in_c
from .leg import compensated, damping_of, friction_in_words, leg_in_c
from .steps import step_of

TIME = InputInC("time", "time since the reference began, less any number of periods [s]", scalar=True)


@register_law_in_c(LQR)
def lqr_in_c(law: LQR, dialect: Dialect) -> LawInC:
    """Describe LQR: the gain is that of the nearest instant of the period.

    Args:
        law: The law.
        dialect: Precision.

    Returns:
        The law for C.

    Raises:
        ExoidError: A term of the model has no form in C.
    """
    instants = len(law.gains)
    return LawInC(
        law.model.leg.joint_names,
        f"tau = M(q_d) a_d + C(q_d, v_d) v_d + G(q_d) + springs(q_d){friction_in_words(law.friction)} "
        "+ K(t) (x_d - x), x = (q, v)",
        step_of("lqr").replace("{{friction}}", compensated(law.friction)),
        law.rate,
        damping_of(law.model),
        (*MOTION, TIME),
        (
            ArrayInC("gain", f"K at {instants} instants of the period [N m/rad, N m s/rad]", law.gains),
            ArrayInC("instants", "number of instants", np.array(float(instants))),
            ArrayInC("period", "period [s]", np.array(law.period)),
        ),
        leg=leg_in_c(law.model, ("inverse_dynamics",), law.friction, dialect),
    )
