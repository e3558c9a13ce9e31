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
    """Limb of a wearer, M δa + D δv + K δq = −δτ_wearer, with muscles that hold it near its intention.

    The torque on the leg is δτ_wearer = k (δq_limb − δq) + d (δv_limb − δv).

    Attributes:
        M: Mass matrix of the limb [kg·m²], (n, n).
        D: Damping by muscles [N·m·s/rad], (n, n).
        K: Stiffness of gravity and muscles [N·m/rad], (n, n).
        stiffness: Stiffness k of the cuffs [N·m/rad], (n,).
        damping: Damping d of the cuffs [N·m·s/rad], (n,).
    """

    M: FloatArray
    D: FloatArray
    K: FloatArray
    stiffness: FloatArray
    damping: FloatArray


def linear_wearer(wearer: Wearer, q: FloatArray) -> LinearWearer:
    """Linearise a wearer.

    Args:
        wearer: The wearer.
        q: Pose of limb and leg [rad], (n,).

    Returns:
        Matrices of the limb.

    Raises:
        ExoidError: The limb has other joints than the pose, or the wearer is that of several rigs.
    """
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
