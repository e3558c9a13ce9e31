"""Channels of an observer with one common delay: low-pass of all, velocity from the filtered angle, lags of sensors."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .joint_filters import JointFilters, of_all_joints

HISTORY = 10.0
"""Delays of the channels after which their filters have forgotten."""


class Channels(NamedTuple):
    """Readings of all joints, (n,) or (N, n) each.

    Attributes:
        q: Angles [rad].
        v: Velocities [rad/s]; None to derive them from the angles.
        tau: Torques of the actuators [N·m].
    """

    q: FloatArray
    v: FloatArray | None
    tau: FloatArray


class AlignmentMemory(NamedTuple):
    """Memory of an :class:`Alignment`; empty arrays where a part does not act."""

    past: FloatArray  # last readings of angles, velocities and torques, the newest first, (D, 3, n)
    low_pass: FloatArray  # memory of the low-pass of the three channels, (m, 3, n)
    derivative: FloatArray  # memory of the filter that gives the velocity, (m, n)


@dataclass(frozen=True, eq=False)
class Alignment:
    """Delays all channels alike.

    Each channel waits for the one that lags most: a reading of lag l is delayed by L − l, with L the largest lag. Parts
    of a sample are interpolated linearly. Then a low-pass of second order (Butterworth, bilinear) passes over all
    channels. A velocity that is not measured is the derivative of the filtered angle, by the same low-pass times
    (2/T)(1 − z⁻¹)/(1 + z⁻¹): exactly the velocity whose trapezoidal sum is the filtered angle.

    Attributes:
        n: Number of joints.
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the low-pass [Hz]; inf for none.
        lags: Lags of velocities and torques behind the angles [s], (2, n).
    """

    n: int
    rate: float
    cutoff: float
    lags: FloatArray

    @property
    def delay(self) -> float:
        """Common delay of all channels behind the angles [s]: that of slow signals."""
        filtered = 0.0 if self.filters is None else np.sqrt(2.0) / (2.0 * self.rate * np.tan(self._half_angle))
        return self.waiting + float(filtered)

    @property
    def waiting(self) -> float:
        """Largest lag of a channel, for which the others wait [s]."""
        return max(0.0, float(self.lags.max()))

    @cached_property
    def filters(self) -> tuple[JointFilters, JointFilters] | None:
        """Low-pass, and its derivative; None without a cut-off."""
        if not np.isfinite(self.cutoff):
            return None
        b, a = scipy.signal.butter(2, self.cutoff, fs=self.rate)
        slope = 2.0 * self.rate * b[0] * np.array([1.0, 0.0, -1.0])
        return of_all_joints(b, a, self.n), of_all_joints(slope, a, self.n)

    def begin(self, q: FloatArray, v: FloatArray, tau: FloatArray) -> tuple[Channels, AlignmentMemory]:
        """Make the memory of a leg that came to the first reading at constant velocity and torque.

        Args:
            q: First angles [rad], (n,).
            v: Velocities [rad/s], (n,), measured or not.
            tau: Torques [N·m], (n,).

        Returns:
            Aligned channels one sample before the first reading, (n,), and the memory for it.
        """
        count = 2 + int(np.ceil(HISTORY * self.delay * self.rate))
        past = np.arange(-count, 0.0)[:, None]
        angles = q + past / self.rate * v
        rest = self._rest(angles[0], v, tau)
        speeds, torques = (np.tile(x, (count, 1)) for x in (v, tau))
        aligned, memory = self.run(rest, Channels(angles, speeds, torques))
        assert aligned.v is not None
        if self.filters is not None:
            _, of_angles = self.run(rest, Channels(angles, None, torques))
            memory = memory._replace(derivative=of_angles.derivative)
        return Channels(aligned.q[-1], aligned.v[-1], aligned.tau[-1]), memory

    def _rest(self, q: FloatArray, v: FloatArray, tau: FloatArray) -> AlignmentMemory:
        """Memory of a leg whose readings were constant."""
        row = np.stack([q, v, tau])
        past = np.tile(row, (self._depth, 1, 1))
        if self.filters is None:
            return AlignmentMemory(past, np.zeros((0, 3, self.n)), np.zeros((0, self.n)))
        low_pass, derivative = self.filters
        return AlignmentMemory(past, low_pass.settled(row), derivative.settled(q))

    def step(self, memory: AlignmentMemory, reading: Channels) -> tuple[Channels, AlignmentMemory]:
        """Align one reading.

        Args:
            memory: The memory.
            reading: The reading, (n,).

        Returns:
            Aligned channels, (n,), and the memory for the next sample.
        """
        past, low_pass, derivative = memory
        row = _stacked(reading)
        if self._depth:
            line = np.concatenate([row[None], past])
            row, past = np.einsum("dcn,dcn->cn", self._weights, line), line[:-1]
        if self.filters is None:
            return Channels(*row), AlignmentMemory(past, low_pass, derivative)
        slow, slope = self.filters
        filtered, low_pass = slow.step(low_pass, row)
        v = filtered[1]
        if reading.v is None:
            v, derivative = slope.step(derivative, row[0])
        return Channels(filtered[0], v, filtered[2]), AlignmentMemory(past, low_pass, derivative)

    def run(self, memory: AlignmentMemory, readings: Channels) -> tuple[Channels, AlignmentMemory]:
        """Align consecutive readings.

        Args:
            memory: The memory before the first.
            readings: The readings, (N, n).

        Returns:
            Aligned channels, (N, n), and the memory after the last sample.
        """
        past, low_pass, derivative = memory
        rows = _stacked(readings)
        if self._depth:
            line = np.concatenate([past[::-1], rows])
            windows = [line[self._depth - d : len(line) - d] for d in range(self._depth + 1)]
            rows = sum(weight * window for weight, window in zip(self._weights, windows, strict=True))
            past = line[: -self._depth - 1 : -1]
        if self.filters is None:
            q, v, tau = rows.transpose(1, 0, 2)
            return Channels(q, v, tau), AlignmentMemory(past, low_pass, derivative)
        slow, slope = self.filters
        filtered, low_pass = slow.run(low_pass, rows)
        v = filtered[:, 1]
        if readings.v is None:
            v, derivative = slope.run(derivative, rows[:, 0])
        return Channels(filtered[:, 0], v, filtered[:, 2]), AlignmentMemory(past, low_pass, derivative)

    @cached_property
    def _half_angle(self) -> float:
        return float(np.pi * self.cutoff / self.rate)

    @cached_property
    def _depth(self) -> int:
        """Past samples that are needed."""
        waits = self._waits
        return int(np.ceil(waits.max())) if waits.any() else 0

    @cached_property
    def _waits(self) -> FloatArray:
        """Delay of each channel [samples], (3, n)."""
        lags = np.vstack([np.zeros(self.n), self.lags])
        waits = np.asarray((self.waiting - lags) * self.rate)
        return np.where(waits < 1e-9, 0.0, waits)

    @cached_property
    def _weights(self) -> FloatArray:
        """Weight of each of the newest samples, (D + 1, 3, n)."""
        ages = np.arange(self._depth + 1.0)[:, None, None]
        return np.asarray(np.clip(1.0 - np.abs(ages - self._waits), 0.0, None))


def _stacked(reading: Channels) -> FloatArray:
    """Angles, velocities and torques, (3, n) or (N, 3, n); zeros where there are no velocities."""
    v = np.zeros_like(reading.q) if reading.v is None else reading.v
    return np.stack([reading.q, v, reading.tau], axis=-2)
