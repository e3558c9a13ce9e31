"""Hypotheses of the change detection: sets of parameters that change together, such as a payload's."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.torques import Armature, Offset, Stiffness, Term, TorqueModel

SPANNED = 1e-6
"""Singular values below this part of the largest count as zero."""

KINDS: dict[type[Term], str] = {Offset: "offset", Armature: "inertia", Stiffness: "stiffness"}
"""Kinds of changes of terms that are no friction."""


class Hypothesis(NamedTuple):
    """Parameters that change together.

    Attributes:
        kind: "load" (of a segment: a payload), "friction", "offset", "inertia" (of a rotor), "stiffness", or the name
            of another term.
        joint: Joint of the term, or the joint that carries the segment.
        basis: Orthonormal basis of the changes, (P, d).
        parameters: Names of the parameters.
    """

    kind: str
    joint: str
    basis: FloatArray
    parameters: tuple[str, ...]


def hypotheses_of(model: TorqueModel) -> tuple[Hypothesis, ...]:
    """List what may change in a leg.

    Args:
        model: Leg and terms.

    Returns:
        Friction of each joint, load of each segment, and each other term at each joint.
    """
    leg, names = model.leg, model.names
    found: dict[tuple[str, str], list[str]] = {}
    for block in model.blocks:
        kind = "friction" if block.term.friction else KINDS.get(type(block.term), type(block.term).__name__.lower())
        kept = [name for name in block.names if name in names]
        if kept:
            found.setdefault((kind, leg.joint_names[block.joints[0]]), []).extend(kept)
    columns = np.eye(len(names))
    hypotheses = [
        Hypothesis(kind, joint, columns[:, [names.index(name) for name in of_kind]], tuple(of_kind))
        for (kind, joint), of_kind in found.items()
    ]
    for k, joint in enumerate(leg.joint_names):
        added = leg.reduction.collect[:, 10 * k : 10 * k + 10]
        U, sizes, _ = np.linalg.svd(added, full_matrices=False)
        basis = np.zeros((len(names), int(np.count_nonzero(sizes > SPANNED * sizes[0]))))
        basis[: len(added)] = U[:, : basis.shape[1]]
        moved = np.abs(basis).max(axis=1) > SPANNED
        parameters = tuple(name for name, is_moved in zip(names, moved, strict=True) if is_moved)
        hypotheses.append(Hypothesis("load", joint, basis, parameters))
    return tuple(hypotheses)
