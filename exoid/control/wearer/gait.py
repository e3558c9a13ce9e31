"""Phase of a cyclic motion, and a torque over it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.signals import Recording

CYCLES = 3
"""Fewest cycles of a motion whose period is looked for."""

REPEATS = 0.6
"""Least autocorrelation of the angles after a period."""

AS_GOOD = 0.9
"""A period is the first lag at which the autocorrelation reaches so much of its largest peak."""

PARTS = 4
"""Harmonics among which the one that gives the phase is chosen."""

FINE = 100
"""Parts of a cycle in which its largest angle is looked for."""


class Phase(NamedTuple):
    """Phase of each sample."""

    values: FloatArray  # phase, 0 to 1, (N,); not a number outside the strides
    period: float | None  # mean period [s]; None for no phase
    source: str  # what begins a cycle


class GaitProfile(NamedTuple):
    """Torque of the wearer over the phase, K bins.

    Attributes:
        phase: Centre of each bin, 0 to 1, (K,).
        mean: Mean torque [N·m], (K, n).
        rms: RMS torque [N·m], (K, n).
        power: Mean power of the wearer on the leg [W], (K, n); positive where the wearer drives it.
        samples: Number of samples, (K,).
    """

    phase: FloatArray
    mean: FloatArray
    rms: FloatArray
    power: FloatArray
    samples: FloatArray


def find_phase(recording: Recording, strides: ArrayLike | None = None) -> Phase | None:
    """Find the phase of each sample of a recording with even time stamps."""
    # Strides that are given count first, then touch-downs of the first link in `contacts`, then the period of the
    # angles. That period is the lag at which their autocorrelation peaks. The phase is that of the strongest harmonic
    # (its analytic signal), so that it follows a cadence that changes slowly.
    if strides is not None:
        return _of_strides(recording, _checked(recording, strides), "given strides")
    for link, flags in recording.contacts.items():
        touching = np.asarray(flags, dtype=np.int8)
        touch_downs = recording.time[1:][np.diff(touching) > 0]
        if len(touch_downs) > 1:
            return _of_strides(recording, touch_downs, f"touch-down of {link}")
    return _of_motion(recording)


def profile(torque: FloatArray, velocity: FloatArray, phase: FloatArray, bins: int = 20) -> GaitProfile:
    """Average a torque and its power over the phase."""
    if bins < 1:
        raise ExoidError(f"a profile of {bins} bins", remedy="ask for 20, or at least one")
    known = ~np.isnan(phase)
    place = np.minimum((phase[known] * bins).astype(np.intp), bins - 1)
    count = np.bincount(place, minlength=bins).astype(np.float64)
    tau, power = torque[known], torque[known] * velocity[known]

    def mean(x: FloatArray) -> FloatArray:
        """Mean over the strides in each bin."""
        sums = [np.bincount(place, weights=column, minlength=bins) for column in x.T]
        return np.array([np.divide(s, count, out=np.full(bins, np.nan), where=count > 0.0) for s in sums]).T

    return GaitProfile((np.arange(bins) + 0.5) / bins, mean(tau), np.sqrt(mean(tau**2)), mean(power), count)


def _checked(recording: Recording, strides: ArrayLike) -> FloatArray:
    """Check times of strides."""
    times = np.atleast_1d(np.asarray(strides, dtype=np.float64))
    rising = times.ndim == 1 and len(times) > 1 and np.isfinite(times).all() and bool((np.diff(times) > 0.0).all())
    if not rising or times[0] >= recording.time[-1] or times[-1] <= recording.time[0]:
        raise ExoidError(
            f"{np.size(times)} strides that do not rise, or are not within {recording.time[0]:g} to "
            f"{recording.time[-1]:g} s",
            where=recording.source.name if recording.source else "",
            remedy="give the times at which strides begin [s], two or more, in order",
        )
    return times


def _of_strides(recording: Recording, begins: Sequence[float] | FloatArray, source: str) -> Phase:
    """Interpolate between the beginnings of strides."""
    begins = np.asarray(begins)
    inside = (recording.time >= begins[0]) & (recording.time <= begins[-1])
    count = np.interp(recording.time, begins, np.arange(len(begins), dtype=np.float64))
    return Phase(np.where(inside, count % 1.0, np.nan), float(np.diff(begins).mean()), source)


def _of_motion(recording: Recording) -> Phase | None:
    """Find the period of the angles, and their phase."""
    q = scipy.signal.detrend(recording.q, axis=0, type="constant")
    lag = _period(q)
    if lag is None:
        return None
    joint = int(np.argmax(q.std(axis=0)))
    x, samples = q[:, joint], len(q)
    spectrum, cycles = np.fft.fft(x), samples / lag
    strengths = [(np.abs(spectrum[_band(cycles, k, samples)]) ** 2).sum() for k in range(1, PARTS + 1)]
    strongest = 1 + int(np.argmax(strengths))
    analytic = np.zeros_like(spectrum)
    band = _band(cycles, strongest, samples)
    analytic[band] = spectrum[band]
    turns = np.unwrap(np.angle(np.fft.ifft(analytic))) / (2.0 * np.pi * strongest)
    place = np.minimum((turns % 1.0 * FINE).astype(np.intp), FINE - 1)
    count = np.bincount(place, minlength=FINE)
    mean = np.divide(np.bincount(place, weights=x, minlength=FINE), count, out=np.full(FINE, -np.inf), where=count > 0)
    turns = turns - (np.argmax(mean) + 0.5) / FINE
    period = float(recording.duration / (turns[-1] - turns[0]))
    return Phase(turns % 1.0, period, f"largest angle of {recording.joint_names[joint]}")


def _band(cycles: float, harmonic: int, samples: int) -> slice:
    """Frequencies within half a harmonic of one, as indices of a Fourier transform."""
    low, high = ((harmonic + side) * cycles for side in (-0.5, 0.5))
    return slice(max(1, round(low)), min(max(2, round(high)), samples // 2))


def _period(q: FloatArray) -> float | None:
    """Lag at which all angles together repeat [samples]; None if they do not."""
    samples = len(q)
    longest = samples // CYCLES
    if longest < 4 or not q.any():
        return None
    padded = scipy.fft.next_fast_len(2 * samples)
    power = (np.abs(np.fft.rfft(q, padded, axis=0)) ** 2).sum(axis=1)
    sums = np.fft.irfft(power, padded)[:longest]
    correlation = sums / sums[0] * samples / (samples - np.arange(longest))
    below = np.flatnonzero(correlation < 0.0)
    if not len(below):
        return None
    inner = correlation[1:-1]
    peaks = 1 + np.flatnonzero((inner >= correlation[:-2]) & (inner > correlation[2:]))
    peaks = peaks[(peaks > below[0]) & (correlation[peaks] > REPEATS)]
    if not len(peaks):
        return None
    return float(peaks[np.argmax(correlation[peaks] >= AS_GOOD * correlation[peaks].max())])
