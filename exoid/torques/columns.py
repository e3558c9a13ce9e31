"""Regressor columns of the terms of a leg, joint by joint, and which of their parameters others include."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.leg import Leg

from .internal_state import InternalState
from .term import JointMotion, Motion, Term, random_motion

DEPENDENT = 2e-4
"""A unit column this close to the span of the columns before it is linearly dependent on them.

A URDF with four decimals misplaces joint axes by up to 5e-5 rad and m, and columns of inertias by a few times as much.
At a threshold of floating-point precision a rotor would not merge into its link there. Its standard deviation would
then be thousands of times that of the link's inertia.
"""


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


def regroup(
    leg: Leg, blocks: Sequence[JointTerm], rigid: FloatArray | None = None, *, separate: Sequence[str] = ()
) -> tuple[Regrouped, ...]:
    """Find parameters of terms that depend linearly on others for every motion, such as a rotor at the hip on J1.

    Each column over random motion is compared with those before it. Terms that depend on the load are left to the fit:
    their columns depend on the parameters.

    Args:
        leg: The leg.
        blocks: Terms at joints, in the order of their columns.
        rigid: Rigid-body parameters whose torque loads the joints, (p,); None for the leg's own.
        separate: Names of parameters that are not regrouped, as their values are known.

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
            if names[k] in separate:
                continue
            coefficients = zip(kept, share, share * scale[k] / scale[kept], strict=True)
            into = {names[i]: float(c) for i, part, c in coefficients if abs(part) > DEPENDENT}
            regrouped.append(Regrouped(names[k], into))
        else:
            kept.append(k)
    return tuple(regrouped)
