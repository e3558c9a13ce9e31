"""Regrouping: parameters of terms that no motion can distinguish from others are included in these."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.leg import Leg

from .columns import JointTerm, fill_terms, internal_states, load_motion
from .motion import Motion, random_motion

DEPENDENT = 1e-9
"""A unit column this close to the span of the columns before it is linearly dependent on them."""


class Regrouped(NamedTuple):
    """A parameter that no motion can distinguish from others, which therefore include it.

    Attributes:
        name: Name of the parameter.
        into: Names of the parameters that include it, with its coefficient in each.
    """

    name: str
    into: dict[str, float]

    def __str__(self) -> str:
        """Write one sentence."""
        into = ", ".join(n if abs(c - 1.0) < 1e-6 else f"{n} (× {c:.3g})" for n, c in self.into.items())
        return f"{self.name} is regrouped into {into}: no motion distinguishes them"


def regroup(leg: Leg, blocks: Sequence[JointTerm], rigid: FloatArray | None = None) -> tuple[Regrouped, ...]:
    """Find parameters of terms that depend linearly on others for every motion, such as a rotor at the hip on J1.

    Each column over random motion is compared with those before it. Terms that depend on the load are left to the fit:
    their columns depend on the parameters.

    Args:
        leg: The leg.
        blocks: Terms at joints, in the order of their columns.
        rigid: Rigid-body parameters whose torque loads the joints, (p,); None for the leg's own.

    Returns:
        Parameters that are regrouped, in the order of their columns.
    """
    count = len(leg.parameter_names)
    names = (*leg.parameter_names, *(name for block in blocks for name in block.names))
    loaded = {name for block in blocks if block.term.loaded for name in block.names}
    q, v, a = random_motion(10 * len(names), len(leg.joint_names))
    columns = np.zeros((len(names), *q.shape[::-1]))
    leg.fill_regressor(q, v, a, columns[:count])
    motion = Motion(q, v, a, None, internal_states(blocks, q, v))
    fill_terms(
        blocks, load_motion(blocks, motion, columns, leg.parameters if rigid is None else rigid), columns[count:], names
    )
    W = columns.transpose(2, 1, 0).reshape(-1, len(names))
    scale = np.linalg.norm(W, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    R = np.asarray(np.linalg.qr(W / scale, mode="r"))  # small: a seven-joint arm has 80 columns
    kept, regrouped = list(range(count)), []
    for k in (k for k in range(count, len(names)) if names[k] not in loaded):
        share, *_ = np.linalg.lstsq(R[:, kept], R[:, k])
        if R[:, k].any() and np.linalg.norm(R[:, k] - R[:, kept] @ share) < DEPENDENT:
            shares = zip(kept, share * scale[k] / scale[kept], strict=True)
            regrouped.append(Regrouped(names[k], {names[i]: float(s) for i, s in shares if abs(s) > DEPENDENT}))
        else:
            kept.append(k)
    return tuple(regrouped)
