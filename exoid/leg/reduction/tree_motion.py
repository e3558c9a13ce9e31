r"""Motion vectors s = (u, w) from body to body of a tree of joints, batched over samples, and Jacobians of frames.

The vectors of :mod:`exoid.leg.reduction.tree_regressor` are the twist of a body for a unit rate of each joint that
carries it (Featherstone 2008, ch. 2). Those of a floating base are six, before the joints.
"""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.leg.closure import BLOCK

from .planar import cosine_and_sine
from .tree import BASE_ROWS, Tree, TreeJoint

CYCLIC = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
"""Axes x, y, z and the two that follow each."""


def carry(joint: TreeJoint, parent: FloatArray, q: FloatArray) -> FloatArray:
    """Carry the motion vectors of the parent over to a body, before the constant rotation behind an oblique axis."""
    count = parent.shape[1]
    motion = np.empty((6, count + 1, len(q)))
    np.matmul(joint.into, parent.reshape(6, -1), out=motion.reshape(6, -1)[:, : parent[0].size])
    motion[:, -1] = joint.own_axis[:, None]
    _, j, k = CYCLIC[joint.axis]
    linear, angular = motion[:3, :count], motion[3:, :count]
    if not joint.turns:
        linear[j] += angular[k] * q
        linear[k] -= angular[j] * q
        return motion
    cosine, sine = np.empty((2, len(q)))
    cosine_and_sine(q, out=(cosine, sine))
    for first, second in ((linear[j], linear[k]), (angular[j], angular[k])):
        first[:], second[:] = first * cosine + second * sine, second * cosine - first * sine
    return motion


def turn_back(joint: TreeJoint, motion: FloatArray) -> None:
    """Turn the motion vectors of a body behind an oblique axis into its own axes."""
    if joint.after is not None:
        motion.reshape(6, -1)[:] = joint.after @ motion.reshape(6, -1)


def tree_jacobian(tree: Tree, q: FloatArray, body: int, into: FloatArray) -> FloatArray:
    """Compute the twist of a frame on a body per unit of each rate, (N, 6, rows)."""
    out, free = np.zeros((len(q), 6, tree.rows)), BASE_ROWS * tree.floating
    path: list[int] = []
    while body >= 0:
        path.insert(0, body)
        body = tree.joints[body].parent
    rows = tree.joints[path[-1]].carriers if path else tuple(range(free))
    for start in range(0, len(q), BLOCK):
        block = slice(start, start + BLOCK)
        motion = np.tile(np.eye(6)[:, :free, None], len(q[block]))
        for j in path:
            motion = carry(tree.joints[j], motion, tree.joints[j].sign * q[block, j])
            turn_back(tree.joints[j], motion)
        out[block][:, :, rows] = (into @ motion.reshape(6, -1)).reshape(motion.shape).transpose(2, 0, 1)
    return out
