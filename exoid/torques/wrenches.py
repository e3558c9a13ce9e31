"""Measured wrenches on links as torques of the rows of a leg."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg
from exoid.signals import Wrench


def wrench_torque(leg: Leg, q: FloatArray, wrenches: Mapping[str, Wrench]) -> FloatArray:
    """Compute Σ J_cᵀ w_c, what wrenches on links do to the rows of a leg."""
    total = np.zeros((len(q), len(leg.row_names)))
    for link, wrench in wrenches.items():
        if wrench.axes != "link":
            raise ExoidError(
                f"the wrench on {link} is in axes of the laboratory",
                remedy="turn it into those of the link: exoid.signals.wrenches_on_links(leg, recording)",
            )
        jacobian = leg.frame_jacobian(q, link, wrench.point)
        total += np.einsum("ncr,nc->nr", jacobian, np.hstack([wrench.force, wrench.moment]))
    return total
