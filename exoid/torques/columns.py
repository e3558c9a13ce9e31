"""Regressor columns of the terms of a leg, joint by joint."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.leg import Leg

from .internal_state import InternalState
from .motion import JointMotion, Motion
from .term import Term


class JointTerm(NamedTuple):
    """One term at one joint.

    Attributes:
        term: The term.
        joint: Index of the joint.
        names: Names of its parameters, ``symbol_joint``.
    """

    term: Term
    joint: int
    names: tuple[str, ...]


class LoadedMotion(NamedTuple):
    """Motion of all joints over some samples, with the rigid-body torques that load them, (n, N) each.

    Attributes:
        q: Angles [rad].
        v: Velocities [rad/s].
        a: Accelerations [rad/s²].
        load: Rigid-body torques [N·m].
        states: Internal states, (N,) each.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    load: FloatArray
    states: Mapping[tuple[int, InternalState], FloatArray]

    def at(self, block: JointTerm) -> JointMotion:
        """Motion of the joint of a term, with the term's internal state."""
        joint, state = block.joint, block.term.internal_state
        found = None if state is None else self.states[joint, state]
        return JointMotion(self.q[joint], self.v[joint], self.a[joint], self.load[joint], found)


def joint_terms(leg: Leg, terms: Iterable[Term]) -> tuple[JointTerm, ...]:
    """Put terms at the joints of a leg, in the order of their columns.

    Args:
        leg: The leg.
        terms: The terms.

    Returns:
        Each term at each of its joints.

    Raises:
        ExoidError: A term acts on a joint that the leg does not have.
    """
    names, labels = leg.joint_names, leg.joint_labels
    return tuple(
        JointTerm(term, joint, tuple(f"{symbol}_{labels[joint]}" for symbol in term.symbols))
        for term in terms
        for joint in term.joint_indices(names, labels)
    )


def internal_states(
    blocks: Iterable[JointTerm], q: FloatArray, v: FloatArray
) -> dict[tuple[int, InternalState], FloatArray]:
    """Compute the internal states of terms over a whole recording.

    Args:
        blocks: Terms at joints; equal states of one joint are computed once.
        q: Joint angles [rad], (N, n), in time order.
        v: Joint velocities [rad/s], (N, n).

    Returns:
        Internal state of each joint that has one, (N,) each.
    """
    needed = {(block.joint, block.term.internal_state) for block in blocks}
    return {(j, state): state.states(q[:, j], v[:, j]) for j, state in needed if state is not None}


def load_motion(blocks: Sequence[JointTerm], motion: Motion, columns: FloatArray, rigid: FloatArray) -> LoadedMotion:
    """Add rigid-body torques to a motion, if a term depends on them; they are zero otherwise.

    Args:
        blocks: Terms at joints.
        motion: Motion of N samples.
        columns: Columns of the rigid-body parameters, followed by any others, (p or more, n, N).
        rigid: Values of the rigid-body parameters, (p,).

    Returns:
        The motion with its loads.
    """
    load = np.broadcast_to(0.0, motion.q.shape[::-1])
    if any(block.term.loaded for block in blocks):
        load = np.tensordot(rigid, columns[: len(rigid)], axes=1)
    return LoadedMotion(motion.q.T, motion.v.T, motion.a.T, load, motion.states)


def fill_terms(blocks: Iterable[JointTerm], motion: LoadedMotion, out: FloatArray, names: Sequence[str]) -> None:
    """Write the columns of terms one below the other.

    Args:
        blocks: Terms at joints.
        motion: Motion of N samples.
        out: Receives the columns of the requested parameters, zeroed, (number of them or more, n, N).
        names: Names of the requested parameters; others are left out.
    """
    row = 0
    for block in blocks:
        kept = [k for k, name in enumerate(block.names) if name in names]
        rows = slice(row, row + len(kept))
        whole = len(kept) == len(block.names)
        columns = out[rows, block.joint] if whole else np.zeros((len(block.names), out.shape[2]))
        block.term.fill(motion.at(block), columns)
        if not whole:
            out[rows, block.joint] = columns[kept]
        row = rows.stop
