"""Protocols of controllers, without and with memory: pure functions from state and target to torque."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Target
from exoid.tools.numbers import checked

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


Memory = Any
"""Memory of a controller: a NamedTuple of arrays that only the controller itself looks into."""


@runtime_checkable
class StatefulLaw(Protocol):
    """A controller whose torque depends on earlier samples.

    The memory is a ``NamedTuple`` of arrays, (n,) or (n, B) each. The object does not change: one object may control
    several legs at once, each with its own memory.
    """

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        ...

    def begin(self, state: State) -> Memory:
        """Compute the memory before the first sample.

        Args:
            state: Measured state at the first sample, (n,) or (n, B).

        Returns:
            The memory, as if the leg had been at rest in this state.
        """
        ...

    def step(self, memory: Memory, state: State, target: Target) -> tuple[FloatArray, Memory]:
        """Compute the torque to hold until the next sample.

        Args:
            memory: Memory from the previous sample, or from :meth:`begin`.
            state: Measured state, (n,) or (n, B).
            target: Reference at this moment, likewise.

        Returns:
            Torque [N·m], of the shape of ``state.q``, and the memory for the next sample.
        """
        ...


AnyLaw = Law | StatefulLaw
"""A controller with or without memory."""


@dataclass(frozen=True)
class Memoryless:
    """A controller without memory, as a :class:`StatefulLaw` whose memory is empty."""

    law: Law  # the controller

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.law.rate

    def begin(self, state: State) -> tuple[()]:
        """Return the empty memory."""
        return ()

    def step(self, memory: tuple[()], state: State, target: Target) -> tuple[FloatArray, tuple[()]]:
        """Compute the torque of the controller."""
        return self.law.torque(state, target), ()


def stateful(law: AnyLaw) -> StatefulLaw:
    """Make a controller with memory of any controller, so that one loop runs both kinds.

    Args:
        law: A controller with or without memory.

    Returns:
        The controller itself if it has ``begin`` and ``step``; otherwise a :class:`Memoryless` one.

    Raises:
        ExoidError: It is no controller.

    Example:
        >>> from exoid.control import State, pd, stateful
        >>> stateful(pd(10.0, 1.0)).begin(State(np.zeros(2), np.zeros(2)))  # its memory is empty
        ()
    """
    if isinstance(law, StatefulLaw):
        return law
    if not callable(getattr(law, "torque", None)):
        what = f"{type(law).__name__} is no controller"
        raise BadArgumentError(what, remedy="give an object with rate and torque, or begin and step")
    return Memoryless(law)


class RunningLaw:
    """A controller in one run: keeps its memory, the time and the last torque."""

    def __init__(self, law: AnyLaw, first: int = 0) -> None:
        self._law, self._count = stateful(law), first
        self._last: FloatArray | None = None
        self._memory: Memory = None  # before the first sample

    def command(
        self, q: FloatArray, v: FloatArray, target: Target, interaction: FloatArray | None = None
    ) -> FloatArray:
        """Compute the torque to hold until the next sample."""
        state = State(q, v, self._count / self._law.rate, self._last, interaction)
        memory = self._law.begin(state) if self._memory is None else self._memory
        self._last, self._memory = self._law.step(memory, state, target)
        self._count += 1
        return self._last


def name_of(law: AnyLaw) -> str:
    """Name of a controller in tables: its own, or that of its class."""
    return str(getattr(law, "name", type(law).__name__))


def gains(value: ArrayLike, name: str) -> FloatArray:
    """Check gains, which may differ from leg to leg."""
    return checked(value, name, least=0.0, ndim=2)


def refuse_rate(rate: float) -> None:
    """Refuse a rate that is not positive and finite."""
    checked(rate, "the rate of a controller [Hz]", above=0.0, ndim=0)


def sound(torque: FloatArray, state: State, target: Target | None = None) -> FloatArray:
    """Return the torque; refuse other shapes, which numpy would spread, and values that are not finite."""
    alike = torque.shape == state.q.shape == state.v.shape == (torque if state.last is None else state.last).shape
    for x in () if target is None else target:
        alike &= x is None or (x.ndim == torque.ndim and len(x) == len(torque))
    if not alike or not math.isfinite(np.vdot(torque, state.v)):  # one product for both: a step has no time for two
        raise unsound(state, target, torque)
    return torque


def unsound(state: State, target: Target | None, torque: FloatArray | None = None) -> BadArgumentError:
    """Name the first number of a sample that is not finite, or say what its channels are."""
    aims = {} if target is None else {f"target.{name}": x for name, x in target._asdict().items()}
    channels = {**state._asdict(), **aims, "torque": torque}
    known = [(name, x) for name, x in channels.items() if x is not None]
    wrong = [f"{name}{place} is not finite" for name, x in known for place in np.argwhere(~np.isfinite(x)).tolist()]
    kinds = [f"{name} {getattr(x, 'shape', type(x).__name__)}" for name, x in known] + ["no target"] * (target is None)
    remedy = "give arrays of finite numbers, one for each joint; without readings stop the leg"
    return BadArgumentError(wrong[0] if wrong else f"a sample of {', '.join(kinds)}", remedy=remedy)


def refuse_shape(state: State, n: int, legs: tuple[int, ...]) -> None:
    """Refuse a state that is not of n joints of as many legs, () or (B,)."""
    if not getattr(state.q, "shape", None) == getattr(state.v, "shape", None) == (n, *legs):
        what = f"q of shape {np.shape(state.q)} and v of shape {np.shape(state.v)} instead of arrays {(n, *legs)}"
        raise BadArgumentError(what, remedy="give one number for each joint, of as many legs as at the beginning")


def spread(values: FloatArray, like: FloatArray) -> FloatArray:
    """Turn one value for each joint into a column if the state has columns."""
    if values.shape == like.shape:  # first: a step from Python is mostly such small calls
        return values
    if values.ndim > like.ndim or (values.ndim > 0 and values.shape[0] != like.shape[0]):
        what = f"gains or limits of shape {values.shape} for {like.shape[0]} joints"
        raise BadArgumentError(what, remedy="give one for each joint")
    return values[:, None] if values.ndim == 1 and like.ndim == 2 else values


def acceleration(target: Target) -> FloatArray:
    """Take the acceleration of a target."""
    if target.a is None:
        remedy = "give Target(q, v, a), or use a controller that needs none, such as gravity_friction_pd"
        raise BadArgumentError("the reference has no acceleration, which this controller needs", remedy=remedy)
    return target.a
