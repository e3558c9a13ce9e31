"""Motion vectors from body to body of a tree of joints, batched over samples."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .tree import TreeJoint

BLOCK = 4096
"""Samples computed at once: enough that the interpreter costs little, few enough for the processor's cache."""

CYCLIC = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
"""Axes x, y, z and the two that follow each."""


def carry(
    joint: TreeJoint, parent: FloatArray, motion: FloatArray, q: FloatArray, scratch: FloatArray, turn: FloatArray
) -> None:
    """Carry the motion vectors of the parent over to a body, before the constant rotation behind an oblique axis."""
    count = parent.shape[1]
    np.matmul(joint.into, parent.reshape(6, -1), out=motion.reshape(6, -1)[:, : parent[0].size])
    motion[:, -1] = joint.own_axis[:, None]
    _, j, k = CYCLIC[joint.axis]
    linear, angular = motion[:3, :count], motion[3:, :count]
    if not joint.turns:
        linear[j] += angular[k] * q
        linear[k] -= angular[j] * q
        return
    cosine, sine = _direct(q, turn)
    to_first, to_second = scratch[:, :count]
    for first, second in ((linear[j], linear[k]), (angular[j], angular[k])):
        np.multiply(second, sine, out=to_first)
        np.multiply(first, sine, out=to_second)
        np.multiply(first, cosine, out=first)
        np.multiply(second, cosine, out=second)
        np.add(first, to_first, out=first)
        np.subtract(second, to_second, out=second)


def turned(joint: TreeJoint, motion: FloatArray) -> None:
    """Turn the motion vectors of a body behind an oblique axis into its own axes."""
    if joint.after is not None:
        motion.reshape(6, -1)[:] = joint.after @ motion.reshape(6, -1)


def _direct(angle: FloatArray, turn: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cosine and sine from t = tan(φ/2): 2/(1 + t²) − 1 and 2t/(1 + t²); a third of the time of cos and sin."""
    cosine, sine, t, double = turn
    np.tan(np.multiply(angle, 0.5, out=t), out=t)
    np.multiply(t, t, out=double)
    np.add(double, 1.0, out=double)
    np.divide(2.0, double, out=double)
    return np.subtract(double, 1.0, out=cosine), np.multiply(double, t, out=sine)
