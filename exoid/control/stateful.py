"""Protocol of a controller with memory, such as a filter: pure functions, with the memory as input and output."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Target

from .law import Law, State

Memory = Any
"""Memory of a controller: a NamedTuple of arrays that only the controller itself looks into."""


@runtime_checkable
class StatefulLaw(Protocol):
    """A controller whose torque depends on earlier samples.

    The memory is a ``NamedTuple`` of arrays, (n,) or (n, B) each. The object does not change: one object may control
    several legs at once, each with its own memory.

    Attributes:
        rate: Sampling rate [Hz].
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
        >>> import numpy as np
        >>> from exoid.control import State, pd, stateful
        >>> from exoid.rig import Target
        >>> law, state = stateful(pd(10.0, 1.0)), State(np.zeros(2), np.zeros(2))
        >>> torque, memory = law.step(law.begin(state), state, Target(np.ones(2), np.zeros(2)))
        >>> torque, memory
        (array([10., 10.]), ())
    """
    if isinstance(law, StatefulLaw):
        return law
    if not callable(getattr(law, "torque", None)):
        raise BadArgumentError(
            f"{type(law).__name__} is no controller", remedy="give an object with rate and torque, or begin and step"
        )
    return Memoryless(law)


def name_of(law: AnyLaw) -> str:
    """Name of a controller in tables: its own, or that of its class."""
    return str(getattr(law, "name", type(law).__name__))


def torque_without_memory(law: AnyLaw, state: State, target: Target) -> FloatArray:
    """Compute the torque of a controller that must not have memory."""
    if not callable(getattr(law, "torque", None)):
        raise BadArgumentError(
            f"{type(law).__name__} has memory, which torque() cannot keep",
            remedy="call begin(state) once, then torque, memory = step(memory, state, target) at each sample",
        )
    return law.torque(state, target)  # type: ignore[union-attr]
