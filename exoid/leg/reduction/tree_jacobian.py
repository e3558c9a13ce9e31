r"""Jacobian of a frame on any body of a tree of joints, batched over samples.

The columns are the motion vectors s = (u, w) of :mod:`exoid.leg.reduction.tree_regressor`: the twist of the frame for a
unit rate of each joint that carries it (Featherstone 2008, ch. 2). Those of a floating base are six, before the joints.
"""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray

from .tree import BASE_ROWS, Tree
from .tree_motion import BLOCK, carry, turned


def tree_jacobian(tree: Tree, q: FloatArray, body: int, into: FloatArray) -> FloatArray:
    """Compute the twist of a frame per unit of each rate."""
    out = np.zeros((len(q), 6, tree.rows))
    path = []
    while body >= 0:
        path.append(body)
        body = tree.joints[body].parent
    rows = tree.joints[path[0]].carriers if path else tuple(range(BASE_ROWS * tree.floating))
    for start in range(0, len(q), BLOCK):
        block = slice(start, start + BLOCK)
        angles = q[block]
        motion = np.tile(np.eye(6)[:, : BASE_ROWS * tree.floating, None], len(angles))
        work = np.empty((2, len(rows), len(angles))), np.empty((4, len(angles)))
        for j in reversed(path):
            joint, parent = tree.joints[j], motion
            motion = np.empty((6, parent.shape[1] + 1, len(angles)))
            carry(joint, parent, motion, joint.sign * angles[:, j], *work)
            turned(joint, motion)
        out[block][:, :, rows] = (into @ motion.reshape(6, -1)).reshape(motion.shape).transpose(2, 0, 1)
    return out
