"""What a control law is: a pure function from state and target to torque, with a rate at which it is sampled."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

RATE = 100.0
"""At which document 2 runs its nonlinear controller (sec. IV) [Hz]."""


class State(NamedTuple):
    """What a law is told at a sample, (n,) each, or (n, B) for B legs at once.

    Attributes:
        q: Measured angles [rad].
        v: Measured velocities [rad/s].
        time: Since the reference began [s].
        last: Torque that was commanded at the sample before [N·m]; None at the first one. Laws have no memory of their
            own: this is all there is.
    """

    q: FloatArray
    v: FloatArray
    time: float = 0.0
    last: FloatArray | None = None


class Law(Protocol):
    """A control law; the same object runs on the virtual rig and in one's own control loop.

    A law holds no state that changes, but the scratch memory of Pinocchio: give each thread a law of its own.

    Attributes:
        rate: At which it is sampled [Hz].
    """

    @property
    def rate(self) -> float:
        """At which it is sampled [Hz]."""
        ...

    def torque(self, state: State, target: Target) -> FloatArray:
        """Torque to hold until the next sample [N·m], of the shape of ``state.q``."""
        ...


def gains(value: ArrayLike, name: str) -> FloatArray:
    """Check gains: a number, one for each joint, (n,), or one for each joint of each leg, (n, B).

    Raises:
        ExoidError: They are not finite, or negative, which destabilises.
    """
    array = np.array(value, dtype=np.float64)
    if array.ndim > 2 or not np.isfinite(array).all() or (array < 0.0).any():
        raise ExoidError(f"{name} = {value!r}", remedy="give finite gains ≥ 0, one number or one for each joint")
    array.flags.writeable = False
    return array


def refuse_rate(rate: float) -> None:
    """Refuse a rate that is none.

    Raises:
        ExoidError: It is not positive and finite.
    """
    if not 0.0 < rate < np.inf:
        raise ExoidError(f"a law at {rate:g} Hz", remedy="give a positive rate in Hz")


def spread(values: FloatArray, like: FloatArray) -> FloatArray:
    """One value for each joint as a column where the state has columns.

    Raises:
        ExoidError: They are for another number of joints.
    """
    if values.ndim > 0 and values.shape[0] != like.shape[0]:
        raise ExoidError(f"{values.shape[0]} gains or limits for {like.shape[0]} joints", remedy="give one a joint")
    return values[:, None] if values.ndim == 1 and like.ndim == 2 else values


def acceleration(target: Target) -> FloatArray:
    """Acceleration of a target.

    Raises:
        ExoidError: The reference does not know it.
    """
    if target.a is None:
        raise ExoidError(
            "the reference has no acceleration, which this law needs",
            remedy="give Target(q, v, a), or use a law that does without, such as gravity_friction_pd",
        )
    return target.a
