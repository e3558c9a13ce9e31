"""Linearised wearer at a pose: limb, cuffs and muscles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.control.model import ControlModel
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
    """
    M, D, K = (each[0] for each in linear_leg(ControlModel.of(wearer.limb), q))
    muscles = np.diag(wearer.muscle_damping), np.diag(wearer.muscle_stiffness)
    return LinearWearer(M, D + muscles[0], K + muscles[1], wearer.cuff_stiffness, wearer.cuff_damping)
