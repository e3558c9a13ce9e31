"""Motion that the torque of a leg depends on, sample by sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.torso import TorsoMotion

from .internal_state import InternalState


class Motion(NamedTuple):
    """Motion of a whole recording, or of some of its rows, from which regressors are formed.

    :meth:`TorqueModel.motion` makes it.

    Attributes:
        q: Joint angles [rad], (N, n).
        v: Joint velocities [rad/s], (N, n).
        a: Joint accelerations [rad/s²], (N, n).
        torso: Motion of the torso; None if it is upright and still.
        states: Internal states by joint, (N,) each.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    torso: TorsoMotion | None = None
    states: Mapping[tuple[int, InternalState], FloatArray] = MappingProxyType({})

    def rows(self, rows: slice) -> Motion:
        """Select consecutive rows without copying them.

        Args:
            rows: The rows.

        Returns:
            Their motion.
        """
        torso = None if self.torso is None else _torso_rows(self.torso, len(self.q), rows)
        states = {key: state[rows] for key, state in self.states.items()}
        return Motion(self.q[rows], self.v[rows], self.a[rows], torso, states)

    def __repr__(self) -> str:
        """Write the size in one line."""
        samples, joints = self.q.shape
        return f"Motion({samples} samples, {joints} joints, {len(self.states)} internal states)"


class JointMotion(NamedTuple):
    """Motion of one joint over N consecutive samples, as a term receives it.

    Attributes:
        q: Angle [rad], (N,).
        v: Velocity [rad/s], (N,).
        a: Acceleration [rad/s²], (N,).
        load: Rigid-body torque of the model at this joint [N·m], (N,); never the measured torque.
        state: Internal state of the term, (N,); None for a term without one.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    load: FloatArray
    state: FloatArray | None = None


def random_motion(samples: int, joints: int) -> FloatArray:
    """Draw independent normal angles, velocities and accelerations, always the same.

    Args:
        samples: Number of samples, N.
        joints: Number of joints, n.

    Returns:
        q [rad], v [rad/s] and a [rad/s²], (3, N, n).
    """
    motion = np.random.default_rng(0).standard_normal((3, samples, joints))
    return motion * [[[1.0]], [[2.0]], [[5.0]]]


def _torso_rows(torso: TorsoMotion, count: int, rows: slice) -> TorsoMotion:
    """Rows of the entries that have one value a sample."""
    entries = {field.name: np.asarray(getattr(torso, field.name), dtype=np.float64) for field in fields(torso)}
    constant = {"hip_acceleration": 1}
    return TorsoMotion(
        **{name: x[rows] if x.ndim > constant.get(name, 0) and len(x) == count else x for name, x in entries.items()}
    )
