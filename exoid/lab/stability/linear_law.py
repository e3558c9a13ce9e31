"""Linearised controller with its memory, and the closed loop with a worn leg as one matrix."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.control.law import AnyLaw, Memory, State, StatefulLaw, stateful
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.rig import Target

from .worn_leg import SPEED, HeldLeg


class LinearLaw(NamedTuple):
    """One step of a controller, linearised: δτ = F δy + H δm and δm⁺ = E δy + N δm."""

    # The reading is y = (q, v, interaction torque). The memory m has r numbers, the last n of which are the
    # last torque.

    F: FloatArray  # torque by reading, (n, 3 n)
    H: FloatArray  # torque by memory, (n, r)
    E: FloatArray  # next memory by reading, (r, 3 n)
    N: FloatArray  # next memory by memory, (r, r)

    def without_last(self) -> LinearLaw:
        """Take the last torque out of the memory if nothing depends on it."""
        n = self.F.shape[-2]
        if self.H[..., -n:].any() or self.N[..., -n:].any():
            return self
        return LinearLaw(self.F, self.H[..., :-n], self.E[..., :-n, :], self.N[..., :-n, :-n])


def linear_law(law: AnyLaw, q: FloatArray) -> LinearLaw:
    """Linearise a controller at a pose that is also its target."""
    # As for `LinearLeg`, derivatives are the mean of those at +0.5 and −0.5 rad/s, where smooth friction
    # compensation is constant. Limits of torque and of its rate count as inactive.
    full, n = stateful(law), len(q)
    found, again = (  # by steps relative to numbers above 1 [rad, rad/s]
        0.5 * (_derivatives(full, q, SPEED, step) + _derivatives(full, q, -SPEED, step)) for step in (1e-6, 2e-6)
    )
    if np.abs(found - again).max() > 1e-3 * np.abs(found).max():
        raise NotSupportedError(
            f"{type(law).__name__} has no derivatives at {np.rad2deg(q).round(1)} deg and ±{SPEED:g} rad/s",
            remedy="use a smooth controller, and a pose away from its limits",
        )
    torque, memory = found[:n], found[n:]
    return LinearLaw(torque[:, : 3 * n], torque[:, 3 * n :], memory[:, : 3 * n], memory[:, 3 * n :])


def loop_matrices(leg: HeldLeg, law: LinearLaw, delay: int) -> FloatArray:
    """Form the matrix of one period for the state (x_k, y_{k−1}, …, y_{k−d}, m_k)."""
    #     x⁺ = A x + B (F y_{k−d} + H m),      m⁺ = E y_{k−d} + N m
    if delay < 0 or delay != int(delay):
        raise BadArgumentError(f"a delay of {delay} periods", remedy="give a whole number")
    count, size, n = leg.B.shape
    F, H, E, N = (np.broadcast_to(each, (count, *each.shape[-2:])) for each in law)
    read = slice(None) if F[..., 2 * n :].any() or E[..., 2 * n :].any() else slice(2 * n)  # interaction or not
    F, E, C = F[..., read], E[..., read], leg.C[read]
    width, rank = len(C), N.shape[-1]
    past = size + delay * width
    loop = np.zeros((count, past + rank, past + rank))
    if delay:
        late = slice(past - width, past)
        loop[:, size : size + width, :size] = C
        for k in range(size + width, past):
            loop[:, k, k - width] = 1.0
    else:
        F, E, late = F @ C, E @ C, slice(size)
    loop[:, :size, :size] = leg.A
    loop[:, :size, late] += leg.B @ F
    loop[:, past:, late] += E
    loop[:, :size, past:] = leg.B @ H
    loop[:, past:, past:] = N
    return loop


def _derivatives(law: StatefulLaw, q: FloatArray, speed: float, step: float) -> FloatArray:
    """Derivatives of (torque, next memory, torque) by (q, v, interaction, memory, last torque), (n + r, 3 n + r)."""
    still = np.zeros_like(q)
    reading = np.concatenate([q, np.full_like(q, speed), still])
    target = Target(q, still, still)
    memory = law.begin(_state(reading))
    torque, _ = law.step(memory, _state(reading), target)
    operating = np.concatenate([reading, _numbers(memory), torque])
    sizes = step * np.maximum(1.0, np.abs(operating))
    tried = operating + np.vstack([np.diag(sizes), -np.diag(sizes)])
    if _is_of_joints(memory, q.shape):  # all in one step of B legs
        columns = Target(*(np.broadcast_to(x[:, None], (len(x), len(tried))) for x in target if x is not None))
        after = _after(law, memory, np.ascontiguousarray(tried.T), columns).T
    else:
        after = np.array([_after(law, memory, numbers, target) for numbers in tried])
    ahead, behind = np.split(after, 2)
    return np.asarray((ahead - behind).T / (2.0 * sizes))


def _after(law: StatefulLaw, memory: Memory, numbers: FloatArray, target: Target) -> FloatArray:
    """Torque, next memory and torque after readings, memory and last torque, (n + r,) or (n + r, B)."""
    n = len(target.q)
    state = _state(numbers[: 3 * n])._replace(last=numbers[-n:])
    applied, then = law.step(_with_numbers(memory, iter(numbers[3 * n :])), state, target)
    return np.concatenate([applied, _numbers(then, numbers.shape[1:]), applied])


def _state(reading: FloatArray) -> State:
    q, v, interaction = np.split(reading, 3)
    return State(q, v, interaction=interaction)


def _numbers(memory: Memory, legs: tuple[int, ...] = ()) -> FloatArray:
    """All floating-point numbers of a memory in order, (r,), or (r, B) of B legs."""
    if isinstance(memory, tuple):
        return np.concatenate([np.zeros((0, *legs)), *(_numbers(part, legs) for part in memory)])
    return np.reshape(memory, (-1, *legs)) if _is_float(memory) else np.zeros((0, *legs))


def _with_numbers(memory: Memory, numbers: Iterator[FloatArray]) -> Memory:
    """Copy of a memory with other floating-point numbers."""
    if isinstance(memory, tuple):
        parts = [_with_numbers(part, numbers) for part in memory]
        return type(memory)(*parts) if hasattr(memory, "_fields") else tuple(parts)
    if not _is_float(memory):
        return memory
    found = np.array([next(numbers) for _ in range(np.size(memory))])
    return found.reshape(*np.shape(memory), *found.shape[1:])


def _is_of_joints(memory: Memory, shape: tuple[int, ...]) -> bool:
    """Whether a memory holds nothing but numbers of joints, so that it may hold those of many legs."""
    if isinstance(memory, tuple):
        return all(_is_of_joints(part, shape) for part in memory)
    return _is_float(memory) and np.shape(memory) == shape


def _is_float(value: object) -> bool:
    return isinstance(value, float | np.ndarray | np.generic) and np.asarray(value).dtype.kind == "f"
