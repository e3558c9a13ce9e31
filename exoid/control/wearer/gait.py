"""Phase of a cyclic motion, and a torque over it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.signals import Recording
from exoid.tools.numbers import checked


class GaitProfile(NamedTuple):
    """Torque of the wearer over the phase, K = 20 bins.

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


def find_phase(recording: Recording, strides: ArrayLike | None = None) -> tuple[FloatArray, float | None, str]:
    """Find the phase of each sample, 0 to 1, NaN where nothing repeats; mean period [s]; what begins a cycle."""
    # Strides that are given count first, then touch-downs of the first link in `contacts`, then the period of the
    # angles. That period is the lag at which their autocorrelation peaks. The phase is that of the strongest harmonic
    # (its analytic signal), so that it follows a cadence that changes slowly.
    if strides is not None:
        times = np.atleast_1d(checked(strides, "the times of strides [s]"))
        rising = times.ndim == 1 and len(times) > 1 and np.isfinite(times).all() and bool((np.diff(times) > 0.0).all())
        if not rising or times[0] >= recording.time[-1] or times[-1] <= recording.time[0]:
            within = f"{recording.time[0]:g} to {recording.time[-1]:g} s"
            raise BadArgumentError(
                f"{np.size(times)} strides that do not rise, or are not within {within}",
                where=recording.file_name,
                remedy="give the times at which strides begin [s], two or more, in order",
            )
        return _of_strides(recording, times, "given strides")
    for link, flags in recording.contacts.items():
        touch_downs = recording.time[1:][np.diff(np.asarray(flags, dtype=np.int8)) > 0]
        if len(touch_downs) > 1:
            return _of_strides(recording, touch_downs, f"touch-down of {link}")
    return _of_motion(recording)


def profile(torque: FloatArray, velocity: FloatArray, phase: FloatArray) -> GaitProfile:
    """Average a torque and its power over twentieths of the phase."""
    known, bins = ~np.isnan(phase), 20
    place = np.minimum((phase[known] * bins).astype(np.intp), bins - 1)
    count = np.bincount(place, minlength=bins).astype(np.float64)
    tau, power = torque[known], torque[known] * velocity[known]

    def mean(x: FloatArray) -> FloatArray:
        """Mean over the strides in each bin."""
        sums = [np.bincount(place, weights=column, minlength=bins) for column in x.T]
        return np.array([np.divide(s, count, out=np.full(bins, np.nan), where=count > 0.0) for s in sums]).T

    return GaitProfile((np.arange(bins) + 0.5) / bins, mean(tau), np.sqrt(mean(tau**2)), mean(power), count)


def _of_strides(recording: Recording, begins: FloatArray, source: str) -> tuple[FloatArray, float, str]:
    """Interpolate between the beginnings of strides."""
    inside = (recording.time >= begins[0]) & (recording.time <= begins[-1])
    count = np.interp(recording.time, begins, np.arange(len(begins), dtype=np.float64))
    return np.where(inside, count % 1.0, np.nan), float(np.diff(begins).mean()), source


def _of_motion(recording: Recording) -> tuple[FloatArray, float | None, str]:
    """Find the period of the angles, and their phase by the strongest of four harmonics."""
    q, samples = recording.q - recording.q.mean(axis=0), len(recording)
    lag = _period(q)
    if lag is None:
        return np.full(samples, np.nan), None, ""
    joint, cycles = int(np.argmax(q.std(axis=0))), samples / lag
    x = q[:, joint]
    spectrum = np.fft.fft(x)

    def band(harmonic: int) -> slice:
        """Frequencies within half a harmonic of one."""
        low, high = ((harmonic + side) * cycles for side in (-0.5, 0.5))
        return slice(max(1, round(low)), min(max(2, round(high)), samples // 2))

    strongest = max(range(1, 5), key=lambda harmonic: float((np.abs(spectrum[band(harmonic)]) ** 2).sum()))
    analytic = np.zeros_like(spectrum)
    analytic[band(strongest)] = spectrum[band(strongest)]
    turns = np.unwrap(np.angle(np.fft.ifft(analytic))) / (2.0 * np.pi * strongest)
    fine = 100  # parts of a cycle in which its largest angle is looked for
    place = np.minimum((turns % 1.0 * fine).astype(np.intp), fine - 1)
    count = np.bincount(place, minlength=fine)
    mean = np.divide(np.bincount(place, weights=x, minlength=fine), count, out=np.full(fine, -np.inf), where=count > 0)
    turns = turns - (np.argmax(mean) + 0.5) / fine
    period = float(recording.duration / (turns[-1] - turns[0]))
    return turns % 1.0, period, f"largest angle of {recording.joint_names[joint]}"


def _period(q: FloatArray) -> float | None:
    """Lag at which all angles together repeat [samples], at least three times; None if they do not."""
    samples = len(q)
    longest = samples // 3
    if longest < 4 or not q.any():
        return None
    padded = scipy.fft.next_fast_len(2 * samples)
    power = (np.abs(np.fft.rfft(q, padded, axis=0)) ** 2).sum(axis=1)
    sums = np.fft.irfft(power, padded)[:longest]
    correlation = sums / sums[0] * samples / (samples - np.arange(longest))
    peaks, _ = scipy.signal.find_peaks(correlation, height=0.6)
    peaks = peaks[np.minimum.accumulate(correlation)[peaks] < 0.0]  # behind half a period, where angles are opposite
    if not len(peaks):
        return None
    # the first peak that reaches nine tenths of the largest: later ones are several periods
    return float(peaks[np.argmax(correlation[peaks] >= 0.9 * correlation[peaks].max())])
