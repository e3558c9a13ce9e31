"""Linearised wearer at a pose: limb, cuffs and muscles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.control.model import ControlModel
from exoid.errors import ExoidError
from exoid.rig import Wearer

from .linear_leg import linear_leg


class LinearWearer(NamedTuple):
    """Limb of a wearer, M δa + D δv + K δq = −δτ_wearer, with muscles that hold it near its intention."""

    # The torque on the leg is δτ_wearer = k (δq_limb − δq) + d (δv_limb − δv).

    M: FloatArray  # mass matrix of the limb [kg·m²], (n, n)
    D: FloatArray  # damping by muscles [N·m·s/rad], (n, n)
    K: FloatArray  # stiffness of gravity and muscles [N·m/rad], (n, n)
    stiffness: FloatArray  # stiffness k of the cuffs [N·m/rad], (n,)
    damping: FloatArray  # damping d of the cuffs [N·m·s/rad], (n,)


def linear_wearer(wearer: Wearer, q: FloatArray) -> LinearWearer:
    """Linearise a wearer."""
    if len(q) != len(wearer.limb.joint_names):
        raise ExoidError(
            f"a wearer with {len(wearer.limb.joint_names)} joints in a leg with {len(q)}",
            remedy="make the wearer of the same leg, Wearer.build(leg)",
        )
    M, D, K = (each[0] for each in linear_leg(ControlModel.of(wearer.limb), q))
    D = D + np.diag(_each(wearer.muscle_damping, q))
    K = K + np.diag(_each(wearer.muscle_stiffness, q))
    return LinearWearer(M, D, K, _each(wearer.cuff_stiffness, q), _each(wearer.cuff_damping, q))


def _each(value: ArrayLike, q: FloatArray) -> FloatArray:
    """One number for each joint, (n,)."""
    array = np.asarray(value, dtype=np.float64)
    if array.ndim == 2 and array.shape[1] > 1:
        raise ExoidError(f"a wearer of {array.shape[1]} rigs", remedy="give a wearer with one number for each joint")
    return np.array(np.broadcast_to(array.reshape(-1), q.shape))
