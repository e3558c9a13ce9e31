"""PD control in C."""

from __future__ import annotations

import numpy as np

from exoid.codegen import Dialect
from exoid.codegen.laws import REFERENCE, ArrayInC, LawInC
from exoid.codegen.laws.safety import per_joint
from exoid.control.pd import PD
from exoid.errors import ExoidError

from .forms import register_law_in_c
from .steps import step_of


@register_law_in_c(PD)
def pd_in_c(law: PD, dialect: Dialect) -> LawInC:
    """Describe PD control; it has no model, so it must have one gain for each joint.

    Args:
        law: The law.
        dialect: Not used.

    Returns:
        The law for C.

    Raises:
        ExoidError: Both gains are single numbers, so that the number of joints is unknown.
    """
    sizes = [gain.size for gain in (law.kp, law.kd) if gain.ndim == 1]
    if not sizes:
        raise ExoidError("PD control of an unknown number of joints", remedy="give one gain for each joint")
    kp, kd = gain_tables(law, sizes[0])
    joints = tuple(f"joint {k}" for k in range(sizes[0]))
    return LawInC(joints, "tau = Kp (q_d - q) + Kd (v_d - v)", step_of("pd"), law.rate, kd.values, REFERENCE, (kp, kd))


def gain_tables(law: PD, n: int) -> tuple[ArrayInC, ArrayInC]:
    """Write the gains of PD feedback."""
    kp, kd = (np.asarray(per_joint(gain, name, n)) for gain, name in ((law.kp, "kp"), (law.kd, "kd")))
    return ArrayInC("kp", "Kp [N m/rad]", kp), ArrayInC("kd", "Kd [N m s/rad]", kd)
