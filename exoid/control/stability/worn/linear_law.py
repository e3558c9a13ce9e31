"""Linearised controller with its memory: derivatives of one step by readings and memory."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.control.law import State
from exoid.control.stateful import AnyLaw, Memory, StatefulLaw, stateful
from exoid.errors import ExoidError
from exoid.rig import Target

from .linear_leg import SPEED

STEP = 1e-6
"""Step of central differences, relative to numbers above 1."""

SMOOTH = 1e-3
"""Largest relative difference of the derivatives with two steps, above which a controller counts as not smooth."""


class LinearLaw(NamedTuple):
    """One step of a controller, linearised: δτ = F δy + H δm and δm⁺ = E δy + N δm.

    The reading is y = (q, v, interaction torque). The memory m has r numbers, the last n of which are the last torque.

    Attributes:
        F: Torque by reading, (n, 3 n).
        H: Torque by memory, (n, r).
        E: Next memory by reading, (r, 3 n).
        N: Next memory by memory, (r, r).
    """

    F: FloatArray
    H: FloatArray
    E: FloatArray
    N: FloatArray

    def without_last(self) -> LinearLaw:
        """Take the last torque out of the memory if nothing depends on it.

        Returns:
            Such a controller; otherwise the same one. Matrices may have more axes in front.
        """
        n = self.F.shape[-2]
        if self.H[..., -n:].any() or self.N[..., -n:].any():
            return self
        return LinearLaw(self.F, self.H[..., :-n], self.E[..., :-n, :], self.N[..., :-n, :-n])


def linear_law(law: AnyLaw, q: FloatArray) -> LinearLaw:
    """Linearise a controller at a pose that is also its target.

    As for :class:`LinearLeg`, derivatives are the mean of those at +0.5 and −0.5 rad/s, where smooth friction
    compensation is constant. Limits of torque and of its rate count as inactive.

    Args:
        law: Any controller of one leg.
        q: Pose [rad], (n,).

    Returns:
        Derivatives of its step.

    Raises:
        ExoidError: The controller has no derivatives there.
    """
    full = stateful(law)
    first, second = (_derivatives(full, q, step) for step in (STEP, 2.0 * STEP))
    if np.abs(first - second).max() > SMOOTH * np.abs(first).max():
        raise ExoidError(
            f"{type(law).__name__} has no derivatives at {np.rad2deg(q).round(1)} deg and ±{SPEED:g} rad/s",
            remedy="use a smooth controller, and a pose away from its limits",
        )
    n = len(q)
    torque, memory = first[:n], first[n:]
    return LinearLaw(torque[:, : 3 * n], torque[:, 3 * n :], memory[:, : 3 * n], memory[:, 3 * n :])


def _derivatives(law: StatefulLaw, q: FloatArray, step: float) -> FloatArray:
    """Derivatives of (torque, next memory, torque) by (q, v, interaction, memory, last torque), (n + r, 3 n + r)."""
    return 0.5 * (_derivatives_at(law, q, SPEED, step) + _derivatives_at(law, q, -SPEED, step))


def _derivatives_at(law: StatefulLaw, q: FloatArray, speed: float, step: float) -> FloatArray:
    still = np.zeros_like(q)
    reading = np.concatenate([q, np.full_like(q, speed), still])
    target = Target(q, still, still)
    memory = law.begin(_state(reading))
    torque, _ = law.step(memory, _state(reading), target)
    operating = np.concatenate([reading, _numbers(memory), torque])

    def after(numbers: FloatArray) -> FloatArray:
        """Torque, memory and last torque after a step, as one vector."""
        state = _state(numbers[: len(reading)])._replace(last=numbers[-len(q) :])
        applied, then = law.step(_with_numbers(memory, iter(numbers[len(reading) :])), state, target)
        return np.concatenate([applied, _numbers(then), applied])

    columns = []
    for k, size in enumerate(step * np.maximum(1.0, np.abs(operating))):
        change = size * np.eye(len(operating))[k]
        columns.append((after(operating + change) - after(operating - change)) / (2.0 * size))
    return np.array(columns).T


def _state(reading: FloatArray) -> State:
    q, v, interaction = np.split(reading, 3)
    return State(q, v, interaction=interaction)


def _numbers(memory: Memory) -> FloatArray:
    """All floating-point numbers of a memory in order, (r,)."""
    if isinstance(memory, tuple):
        return np.concatenate([np.zeros(0), *map(_numbers, memory)])
    return np.ravel(memory) if _is_float(memory) else np.zeros(0)


def _with_numbers(memory: Memory, numbers: Iterator[float]) -> Memory:
    """Copy of a memory with other floating-point numbers."""
    if isinstance(memory, tuple):
        parts = [_with_numbers(part, numbers) for part in memory]
        return type(memory)(*parts) if hasattr(memory, "_fields") else tuple(parts)
    if not _is_float(memory):
        return memory
    return np.array([next(numbers) for _ in range(np.size(memory))]).reshape(np.shape(memory))


def _is_float(value: object) -> bool:
    return isinstance(value, float | np.ndarray | np.generic) and np.asarray(value).dtype.kind == "f"
