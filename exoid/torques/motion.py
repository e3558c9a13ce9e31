"""The motion that the torque of a leg depends on, sample by sample."""

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
    """Whole recording of what a regressor is formed from, or some rows of it; made by :meth:`TorqueModel.motion`.

    Attributes:
        q: Joint angles [rad], (N, n).
        v: Joint velocities [rad/s], (N, n).
        a: Joint accelerations [rad/s²], (N, n).
        torso: Motion of the torso, if it moves.
        states: Hidden states of joints by joint and memory, (N,) each.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    torso: TorsoMotion | None = None
    states: Mapping[tuple[int, InternalState], FloatArray] = MappingProxyType({})

    def rows(self, rows: slice) -> Motion:
        """Cut some rows out; nothing is copied."""
        torso = None if self.torso is None else _cut(self.torso, len(self.q), rows)
        states = {key: state[rows] for key, state in self.states.items()}
        return Motion(self.q[rows], self.v[rows], self.a[rows], torso, states)


class JointMotion(NamedTuple):
    """Motion of one joint over consecutive samples, and what comes with it: what a term may know.

    Attributes:
        q: Angle [rad], (N,).
        v: Velocity [rad/s], (N,).
        a: Acceleration [rad/s²], (N,).
        load: Rigid-body torque of the model at this joint [N·m], (N,): never the measured one.
        state: State that depends on all samples before, of terms that have a memory, (N,).
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    load: FloatArray
    state: FloatArray | None = None


def _cut(torso: TorsoMotion, count: int, rows: slice) -> TorsoMotion:
    """Rows of those entries that change from sample to sample."""
    entries = {field.name: np.asarray(getattr(torso, field.name), dtype=np.float64) for field in fields(torso)}
    constant = {"hip_acceleration": 1}
    return TorsoMotion(
        **{name: x[rows] if x.ndim > constant.get(name, 0) and len(x) == count else x for name, x in entries.items()}
    )
