"""The motion that the torque of a leg depends on, sample by sample."""

from __future__ import annotations

from dataclasses import fields
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.torso import TorsoMotion


class Motion(NamedTuple):
    """Whole recording of what a regressor is formed from, or some rows of it; made by :meth:`TorqueModel.motion`.

    Attributes:
        q: Joint angles [rad], (N, n).
        v: Joint velocities [rad/s], (N, n).
        a: Joint accelerations [rad/s²], (N, n).
        torso: Motion of the torso, if it moves.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    torso: TorsoMotion | None = None

    def rows(self, rows: slice) -> Motion:
        """Cut some rows out; nothing is copied."""
        torso = None if self.torso is None else _cut(self.torso, len(self.q), rows)
        return Motion(self.q[rows], self.v[rows], self.a[rows], torso)


def _cut(torso: TorsoMotion, count: int, rows: slice) -> TorsoMotion:
    """Rows of those entries that change from sample to sample."""
    entries = {field.name: np.asarray(getattr(torso, field.name), dtype=np.float64) for field in fields(torso)}
    constant = {"hip_acceleration": 1}
    return TorsoMotion(
        **{name: x[rows] if x.ndim > constant.get(name, 0) and len(x) == count else x for name, x in entries.items()}
    )
