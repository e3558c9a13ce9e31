"""Motion of a leg, and of one of its joints, from which columns of the torque model are formed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.closure import Closure
from exoid.leg.torso import MovingBase, TorsoMotion

from .presliding import Presliding

STEPS = (1e-5, 1e-5, 1e-3)
"""Halves of central differences by angle, velocity and acceleration; torques are linear in the last."""

BLOCK = 32768
"""Samples whose torques are computed at once."""


class Motion(NamedTuple):
    """Motion of a whole recording, or of some of its rows, from which regressors are formed.

    :meth:`TorqueModel.motion` makes it.

    Attributes:
        q: Joint angles [rad], (N, n).
        v: Joint velocities [rad/s], (N, n).
        a: Joint accelerations [rad/s²], (N, n).
        torso: Motion of the torso, or of the base; None if it is upright and still.
        states: Internal states by joint, (N,) each.
        payload: Torque of payloads less Σ Jᵀw of measured wrenches w on links [N·m], (N, n); None without both.
        computed: Joints whose torque follows from the reading of their drive, (n,); None for none.
        measured: Measured torque [N·m], (N, n), on which no column of a parameter depends; None if nobody needs it.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    torso: MovingBase | None = None
    states: Mapping[tuple[int, Presliding], FloatArray] = MappingProxyType({})
    payload: FloatArray | None = None
    computed: NDArray[np.bool_] | None = None
    measured: FloatArray | None = None

    def rows(self, rows: slice | NDArray[np.intp]) -> Motion:
        """Select rows; consecutive ones are not copied.

        Args:
            rows: The rows.

        Returns:
            Their motion.
        """
        torso = self.torso
        if isinstance(torso, TorsoMotion):  # entries that have one value a sample
            entries = {field.name: np.asarray(getattr(torso, field.name), dtype=np.float64) for field in fields(torso)}
            for name, x in entries.items():
                if x.ndim > (name == "hip_acceleration") and len(x) == len(self.q):
                    entries[name] = x[rows]
            torso = TorsoMotion(**entries)
        elif torso is not None:
            torso = torso.rows(rows)
        states = {key: state[rows] for key, state in self.states.items()}
        payload, measured = (None if x is None else x[rows] for x in (self.payload, self.measured))
        return Motion(self.q[rows], self.v[rows], self.a[rows], torso, states, payload, self.computed, measured)


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


class LoadedMotion(NamedTuple):
    """Motion of all joints over some samples, with the rigid-body torques that load them, (n, N) each."""

    q: FloatArray  # angles [rad]
    v: FloatArray  # velocities [rad/s]
    a: FloatArray  # accelerations [rad/s²]
    load: FloatArray  # rigid-body torques, those of payloads and wrenches included [N·m]
    payload: FloatArray  # torques of payloads less those of measured wrenches [N·m], part of `load`
    states: Mapping[tuple[int, Presliding], FloatArray]  # internal states, (N,) each


class ExtraColumns(Protocol):
    """K columns behind those of a torque model's parameters, such as faults of a log or other friction."""

    @property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint, (n, K)."""

    @property
    def states(self) -> Iterable[tuple[int, Presliding]]:
        """Internal states that they depend on: joint and kind."""

    def fill(self, motion: Motion, columns: FloatArray, out: FloatArray) -> None:
        """Write them, (K, n, N), beside those of the parameters, (P, n, N)."""


def random_motion(samples: int, joints: int, closure: Closure | None = None) -> FloatArray:
    """Draw normal angles, velocities and accelerations, always the same; loops close, away from dead centres."""
    motion = np.random.default_rng(0).standard_normal((3, samples, joints)) * [[[1.0]], [[2.0]], [[5.0]]]
    if closure is not None:
        motion *= closure.sizes
        motion[0] = closure.reachable(motion[0])
    return motion


def random_base(samples: int) -> BaseKinematics:
    """Draw a motion of the base, always the same."""
    motion = np.random.default_rng(1).standard_normal((3, samples, 3))
    return BaseKinematics(2.0 * motion[0], 5.0 * motion[1], 10.0 * motion[2])
