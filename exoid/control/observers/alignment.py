"""Filters of an observer: of each joint, and of its channels, which get one common delay."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray


@dataclass(frozen=True, eq=False)
class JointFilter:
    """Filter y = b(z) / a(z) x of order m, of all joints alike, in transposed direct form II."""

    b: FloatArray  # numerator, powers of z⁻¹ rising, (m + 1,)
    a: FloatArray  # denominator, the first coefficient 1, (m + 1,)

    def settled(self, x: FloatArray) -> FloatArray:
        """Make the memory after an input that was constant for ever, (m, *x.shape)."""
        return np.multiply.outer(scipy.signal.lfilter_zi(self.b, self.a), x)

    def run(self, memory: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Filter consecutive samples (N, ...); also the memory after them."""
        y, after = scipy.signal.lfilter(self.b, self.a, x, axis=0, zi=memory)
        return y, after

    def impulse_response(self, x: FloatArray) -> FloatArray:
        """Filter a short input (k,) until the output is over."""
        radius = float(np.abs(np.roots(self.a)).max(initial=0.0))
        longest = 200_000  # samples, after which the response counts as over
        rings = longest if radius >= 1.0 else int(np.ceil(-30.0 / np.log(max(radius, 1e-3))))  # to e⁻³⁰
        inputs = np.zeros(min(len(x) + rings, longest))
        inputs[: len(x)] = x
        return self.run(np.zeros(len(self.b) - 1), inputs)[0]


class AlignmentMemory(NamedTuple):
    """Memory of an :class:`Alignment`; empty arrays where a part does not act."""

    past: FloatArray  # last readings of angles, velocities and torques, the newest first, (D, 3, n)
    low_pass: FloatArray  # memory of the low-pass of the three channels, (m, 3, n)
    slope: FloatArray  # memory of the filter that derives the velocity from the angle, (m, n)


@dataclass(frozen=True, eq=False)
class Alignment:
    """Delays all channels alike: angles, velocities and torques of n joints, rows of (3, n)."""

    # Each channel waits for the one that lags most: a reading of lag l is delayed by L − l, with L the largest lag.
    # Parts of a sample are interpolated linearly. Then a low-pass of second order (Butterworth, bilinear) passes over
    # all channels. A velocity that is not measured is the derivative of the filtered angle, by the same low-pass times
    # (2/T)(1 − z⁻¹)/(1 + z⁻¹): exactly the velocity whose trapezoidal sum is the filtered angle.

    n: int  # number of joints
    rate: float  # sampling rate [Hz]
    cutoff: float  # −3 dB frequency of the low-pass [Hz]; inf for none
    lags: FloatArray  # lags of velocities and torques behind the angles [s], (2, n)

    @property
    def delay(self) -> float:
        """Common delay of all channels behind the angles [s]: that of slow signals."""
        half_angle = np.pi * self.cutoff / self.rate
        filtered = 0.0 if self.filters is None else np.sqrt(2.0) / (2.0 * self.rate * np.tan(half_angle))
        return self.waiting + float(filtered)

    @property
    def history(self) -> int:
        """Number of samples after which the filters have forgotten: ten delays."""
        return 2 + int(np.ceil(10.0 * self.delay * self.rate))

    @property
    def waiting(self) -> float:
        """Largest lag of a channel, for which the others wait [s]."""
        return max(0.0, float(self.lags.max()))

    @cached_property
    def filters(self) -> tuple[JointFilter, JointFilter] | None:
        """Low-pass, and its derivative; None without a cut-off."""
        if not np.isfinite(self.cutoff):
            return None
        b, a = scipy.signal.butter(2, self.cutoff, fs=self.rate)
        slope = 2.0 * self.rate * b[0] * np.array([1.0, 0.0, -1.0])
        return JointFilter(b, a), JointFilter(slope, a)

    @cached_property
    def weights(self) -> FloatArray:
        """Weight of each of the newest readings in an aligned one, (D + 1, 3, n)."""
        waits = (self.waiting - np.vstack([np.zeros(self.n), self.lags])) * self.rate
        waits = np.where(waits < 1e-9, 0.0, waits)
        ages = np.arange(np.ceil(waits.max()) + 1.0)[:, None, None]
        return np.asarray(np.clip(1.0 - np.abs(ages - waits), 0.0, None))

    def begin(self, first: FloatArray) -> tuple[FloatArray, AlignmentMemory]:
        """Come to the first reading (3, n) at constant velocity and torque: aligned reading before it, and memory."""
        before = np.tile(first, (self.history, 1, 1))
        before[:, 0] += np.arange(-self.history, 0.0)[:, None] / self.rate * first[1]
        past = np.tile(before[0], (len(self.weights) - 1, 1, 1))
        if self.filters is None:
            rest = AlignmentMemory(past, np.zeros((0, 3, self.n)), np.zeros((0, self.n)))
        else:
            low_pass, slope = self.filters
            rest = AlignmentMemory(past, low_pass.settled(before[0]), slope.settled(before[0, 0]))
        aligned, memory = self.run(rest, before, derived=False)
        return aligned[-1], memory

    def run(self, memory: AlignmentMemory, rows: FloatArray, *, derived: bool) -> tuple[FloatArray, AlignmentMemory]:
        """Align consecutive readings (N, 3, n), velocities measured or derived; also the memory after them."""
        past, low_pass, slope = memory
        depth = len(self.weights) - 1
        if depth:
            line = np.concatenate([past[::-1], rows])
            windows = [line[depth - d : len(line) - d] for d in range(depth + 1)]
            rows = np.sum([weight * window for weight, window in zip(self.weights, windows, strict=True)], axis=0)
            past = line[: -depth - 1 : -1]
        if self.filters is None:
            return rows, AlignmentMemory(past, low_pass, slope)
        smooth, differentiate = self.filters
        aligned, low_pass = smooth.run(low_pass, rows)
        velocity, slope = differentiate.run(slope, rows[:, 0])
        if derived:
            aligned[:, 1] = velocity
        return aligned, AlignmentMemory(past, low_pass, slope)
