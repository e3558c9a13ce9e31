"""Limits of torque and of its rate in C."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from exoid.codegen import Dialect
from exoid.codegen.laws import LawInC
from exoid.control.limited import Limited

from .forms import law_in_c, register_law_in_c


@register_law_in_c(Limited)
def limited_in_c(law: Limited, dialect: Dialect) -> LawInC:
    """Describe a law within limits; as in Python, the torque before the first sample is zero.

    Args:
        law: The law.
        dialect: Precision.

    Returns:
        The law for C.

    Raises:
        ExoidError: The other law has no form in C.
    """
    inner = law_in_c(law.law, dialect)
    return replace(
        inner, limit=np.minimum(inner.limit, np.asarray(law.limit)), slew=np.minimum(inner.slew, np.asarray(law.slew))
    )
