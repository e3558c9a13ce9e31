"""Protocol of a controller: a pure function from state and target to torque, with a sampling rate."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Target

RATE = 100.0
"""Rate of document 2's nonlinear controller (sec. IV) [Hz]."""


class State(NamedTuple):
    """Input of a controller at a sample, (n,) each, or (n, B) for B legs at once.

    Attributes:
        q: Measured angles [rad].
        v: Measured velocities [rad/s].
        time: Time since the reference began [s].
        last: Torque commanded at the previous sample [N·m]; None at the first.
        interaction: Torque of the wearer on the leg, by sensors in the cuffs or an observer [N·m]; None if unknown.
    """

    q: FloatArray
    v: FloatArray
    time: float = 0.0
    last: FloatArray | None = None
    interaction: FloatArray | None = None


class Law(Protocol):
    """A controller; the same object runs on the virtual rig and in the control loop of a real machine.

    It has no memory of earlier samples; :class:`exoid.control.StatefulLaw` has one. It may use Pinocchio's work memory:
    make one for each thread.

    Attributes:
        rate: Sampling rate [Hz].
    """

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        ...

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque to hold until the next sample.

        Args:
            state: Measured state, (n,) or (n, B).
            target: Reference at this moment, likewise.

        Returns:
            Torque [N·m], of the shape of ``state.q``.
        """
        ...


def gains(value: ArrayLike, name: str) -> FloatArray:
    """Check gains."""
    array = np.array(value, dtype=np.float64)
    if array.ndim > 2 or not np.isfinite(array).all() or (array < 0.0).any():
        raise BadArgumentError(f"{name} = {value!r}", remedy="give finite gains ≥ 0, one number or one for each joint")
    array.flags.writeable = False
    return array


def freeze_gains(law: object, *names: str) -> None:
    """Check gains of a controller when it is made, and replace them by read-only arrays."""
    for name in names:
        object.__setattr__(law, name, gains(getattr(law, name), name))


def refuse_rate(rate: float) -> None:
    """Refuse a rate that is not positive and finite."""
    if not 0.0 < rate < np.inf:
        raise BadArgumentError(f"a controller at {rate:g} Hz", remedy="give a positive rate in Hz")


def spread(values: FloatArray, like: FloatArray) -> FloatArray:
    """Turn one value for each joint into a column if the state has columns."""
    if values.shape == like.shape:  # first: a step from Python is mostly such small calls
        return values
    if values.ndim > 0 and values.shape[0] != like.shape[0]:
        raise BadArgumentError(
            f"{values.shape[0]} gains or limits for {like.shape[0]} joints", remedy="give one for each joint"
        )
    return values[:, None] if values.ndim == 1 and like.ndim == 2 else values


def acceleration(target: Target) -> FloatArray:
    """Take the acceleration of a target."""
    if target.a is None:
        raise BadArgumentError(
            "the reference has no acceleration, which this controller needs",
            remedy="give Target(q, v, a), or use a controller that needs none, such as gravity_friction_pd",
        )
    return target.a
