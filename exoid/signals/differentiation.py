"""Finite differences along the first axis."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .recording import Recording

Accuracy = Literal[2, 4]


class Stencil(NamedTuple):
    """Weights of a finite difference.

    Attributes:
        centre: Weights of a sample and its m neighbours on each side, (2 m + 1,).
        ends: One-sided weights of the first w samples for the derivative at the first m samples, (m, w).
    """

    centre: FloatArray
    ends: FloatArray


FIRST: dict[Accuracy, Stencil] = {
    2: Stencil(np.array([-1, 0, 1]) / 2, np.array([[-3, 4, -1]]) / 2),
    4: Stencil(np.array([1, -8, 0, 8, -1]) / 12, np.array([[-25, 48, -36, 16, -3], [-3, -10, 18, -6, 1]]) / 12),
}
SECOND: dict[Accuracy, Stencil] = {
    2: Stencil(np.array([1.0, -2.0, 1.0]), np.array([[2.0, -5.0, 4.0, -1.0]])),
    4: Stencil(
        np.array([-1, 16, -30, 16, -1]) / 12,
        np.array([[45, -154, 214, -156, 61, -10], [10, -15, -4, 14, -6, 1]]) / 12,
    ),
}


class Kinematics(NamedTuple):
    """Angles, velocities and accelerations of a recording.

    Attributes:
        q: Angles [rad], (N, n).
        v: Velocities [rad/s], (N, n).
        a: Accelerations [rad/s²], (N, n).
        valid: Rows that are not affected by the ends of the record.
    """

    q: FloatArray
    v: FloatArray
    a: FloatArray
    valid: slice

    def __repr__(self) -> str:
        """Write the size in one line."""
        samples, joints = self.q.shape
        return f"Kinematics({samples} samples, {joints} joints, valid: {self.valid.start} to {self.valid.stop})"


def central_difference(x: FloatArray, rate: float, accuracy: Accuracy = 2) -> FloatArray:
    """Compute the first derivative by central differences (doc. 1, sec. III-B), one-sided at the ends.

    ẋ_k = (x_{k+1} − x_{k−1})·rate/2 + O(dt²), or over five points + O(dt⁴). On a sine of ω the relative
    error is (ω dt)²/6 or (ω dt)⁴/30.

    Args:
        x: Samples [u], (N, ...).
        rate: Sampling rate [Hz].
        accuracy: Order of the error in dt.

    Returns:
        Derivative [u/s], of the shape of ``x``.

    Raises:
        ExoidError: There are too few samples.
    """
    return rate * _apply(FIRST[accuracy], x)


def second_difference(x: FloatArray, rate: float, accuracy: Accuracy = 2) -> FloatArray:
    """Compute the second derivative by central differences (doc. 1, sec. III-B), one-sided at the ends.

    ẍ_k = (x_{k+1} − 2 x_k + x_{k−1})·rate² + O(dt²), or over five points + O(dt⁴). On a sine of ω the
    relative error is (ω dt)²/12 or (ω dt)⁴/90.

    Args:
        x: Samples [u], (N, ...).
        rate: Sampling rate [Hz].
        accuracy: Order of the error in dt.

    Returns:
        Second derivative [u/s²], of the shape of ``x``.

    Raises:
        ExoidError: There are too few samples.
    """
    return rate**2 * _apply(SECOND[accuracy], x)


def _apply(stencil: Stencil, x: FloatArray) -> FloatArray:
    """Apply a stencil to each sample; the weights at the far end are those of the near end reversed."""
    margin, width = len(stencil.ends), stencil.ends.shape[1]
    samples = len(x)
    if samples < max(width, 2 * margin + 1):
        raise ExoidError(f"{samples} samples are too few for a difference over {width}", remedy="record longer")
    signals = x.reshape(samples, -1).T
    out = np.empty(signals.shape)
    parity = 1.0 if stencil.centre[0] == stencil.centre[-1] else -1.0
    for signal, derived in zip(signals, out, strict=True):
        derived[margin : samples - margin] = np.correlate(signal, stencil.centre, "valid")
        derived[:margin] = stencil.ends @ signal[:width]
        derived[samples - margin :] = parity * (stencil.ends @ signal[: -width - 1 : -1])[::-1]
    return out.T.reshape(x.shape)


def derive(
    recording: Recording, smooth: Callable[[FloatArray], FloatArray], valid: slice, accuracy: Accuracy
) -> Kinematics:
    """Smooth the recorded quantities and derive the others from q.

    The acceleration is derived from q even if v was recorded, because drives filter the velocity they report. On the
    DFKI double pendulum, a delay of 1 ms costs more accuracy than the noise of a second difference.
    """
    rate, q = recording.sample_rate, smooth(recording.q)
    v = central_difference(q, rate, accuracy) if recording.v is None else smooth(recording.v)
    a = second_difference(q, rate, accuracy) if recording.a is None else smooth(recording.a)
    return Kinematics(q, v, a, valid)


def inner_samples(recording: Recording, head: int, tail: int) -> slice:
    """Rows between the ends; a recording without such rows is refused."""
    samples = len(recording)
    if samples <= head + tail:
        raise ExoidError(
            f"{samples} samples are too few: the filters distort {head} at the beginning and {tail} at the end",
            where=recording.source.name if recording.source else "",
            remedy="record longer or choose a higher cut-off; of a longer log, pass all with Recording.segments",
        )
    return slice(head, samples - tail)
