"""Terms of a controller's model that have no closed form there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.torques import Term
from exoid.torques.motion import LoadedMotion, random_motion
from exoid.torques.term import TermBlock
from exoid.torques.terms import SIGN_WIDTH


class OtherTerm(NamedTuple):
    """A term at one joint, or at the joints that it couples, for which this package has no closed form."""

    term: Term  # the term
    joints: tuple[int, ...]  # indices of its joints, m of them
    values: FloatArray  # values of the term's parameters
    radian: float  # what counts as a radian at the first of them, in m where it slides
    inertial: bool = False  # whether its torque depends on accelerations

    @classmethod
    def of(cls, term: Term, joints: tuple[int, ...], values: FloatArray, radian: FloatArray) -> OtherTerm:
        """Make it, and find out whether it depends on accelerations."""
        other = cls(term, joints, values, float(radian[joints[0]]))
        q, v, a = random_motion(10, len(radian)).transpose(0, 2, 1)
        load = np.zeros_like(q)
        return other._replace(inertial=not np.array_equal(other.torque(q, v, a, load), other.torque(q, v, load, load)))

    def torque(self, q: FloatArray, v: FloatArray, a: FloatArray, load: FloatArray) -> FloatArray:
        """Compute the torque of the term."""
        # The distance since the last reversal is unknown, so presliding contacts count as sliding.
        first, state = self.joints[0], self.term.internal_state
        states = {} if state is None else {(first, state): np.tanh(v[first] / (SIGN_WIDTH * self.radian))}
        motion = LoadedMotion(q, v, a, load, np.zeros_like(load), states)
        columns = TermBlock(self.term, self.joints, self.term.symbols).columns(motion)
        return np.asarray(np.tensordot(self.values, columns, axes=1))


def torque_of(
    others: Sequence[OtherTerm],
    q: FloatArray,
    v: FloatArray | None = None,
    a: FloatArray | None = None,
    load: FloatArray | None = None,
) -> FloatArray:
    """Sum up the torques of terms at angles (n,) or (n, B), and at motions and loads that are zero where None."""
    torque, angles = np.zeros(np.shape(q)), q.reshape(len(q), -1)
    motion = [np.zeros_like(angles) if x is None else x.reshape(angles.shape) for x in (v, a, load)]
    for other in others:
        torque[list(other.joints)] += other.torque(angles, *motion).reshape(-1, *torque.shape[1:])
    return torque
