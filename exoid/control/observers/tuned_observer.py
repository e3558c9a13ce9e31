"""Bandwidth of an observer by a log: least expected error at the same time, with a bound on the delay."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.signals import Recording

from .checks import observed_channels
from .noise_band import filtered_noise
from .observer import LARGEST, SLOWEST, TorqueObserver
from .sensor_noise import SensorNoise

DELAY = 0.025
"""Largest delay by default [s]."""

SLOW, FAST = 4.0, 100.0
"""Smallest and largest bandwidth that are compared [Hz], the latter at most a fifth of the rate;"""

STEPS = 12
"""number of bandwidths, evenly spaced in their logarithm,"""

LOW_PASSES = 5
"""and number of cut-offs of the channels."""

TWICE = 2.0
"""Where the reading has less than so many times the power of its noise, nothing is known of a torque."""

UPPER = 0.25
"""Frequencies above this part of the widest bandwidth show the level of the noise."""

BINS = 80
"""Frequencies at which errors are summed up."""

PASSED = 0.5
"""Gain of the widest observer down to which its reading shows the torque."""

Observer = TypeVar("Observer", bound=TorqueObserver)


class _Spectrum(NamedTuple):
    """Power of the torque in bins of frequency, noise taken away."""

    frequency: FloatArray  # [Hz], (K,)
    power: FloatArray  # [N²·m²], (K, n); zero where noise hides it


def tuned_observer(observer: Observer, recording: Recording, delay: float = DELAY) -> Observer:
    """Choose bandwidths and the low-pass of the channels for torques like those of a log.

    The observer with the widest bandwidth reads the log. The spectrum of its reading less that of the noise is the
    spectrum P of the torque, where it is at least as large as the noise. An observer with response R(f) then errs by

        E = Σ |1 − R|² P + σ²

    in the mean square, with σ² the variance of its reading by noise: a delay counts as an error. Each joint gets the
    bandwidth of least E among those whose delay is allowed. The low-pass is common to all joints: the mean of E over
    the power of the torque decides. Errors of the model, such as friction that sticks, do not depend much on the
    bandwidth and are left out.

    Args:
        observer: Observer, whose bandwidth and cut-off are replaced.
        recording: A worn log at the observer's rate, with motions as abrupt as those to come.
        delay: Largest delay of any joint [s].

    Returns:
        The observer with a bandwidth for each joint.

    Raises:
        ExoidError: No bandwidth below a fifth of the rate has so short a delay, or the log cannot be read, see
            :meth:`.TorqueObserver.run`.

    Example:
        >>> import exoid
        >>> from exoid.control import MomentumObserver, tuned_observer
        >>> data = exoid.datasets.bleex_swing()
        >>> observer = MomentumObserver(exoid.identify(data.leg, data.train), bandwidth=16.0, rate=100.0)
        >>> bool(tuned_observer(observer, data.train).delay.max() <= 0.025)
        True
    """
    if observer.noise is None:
        observer = replace(observer, noise=SensorNoise.of(recording))
    derived, widest = recording.v is None, min(FAST, LARGEST * observer.rate)
    wide = replace(observer, bandwidth=widest, cutoff=widest)
    q = observed_channels(observer.source, recording, observer.rate)[1].q
    M = wide.terms.over(q, np.zeros_like(q)).M
    inertia = np.sqrt((M**2).mean(axis=0))
    spectrum = _spectrum(wide, recording, inertia, derived=derived)
    best: tuple[float, FloatArray, float] | None = None
    for cutoff in np.geomspace(min(SLOWEST, widest), widest, LOW_PASSES).tolist():
        bandwidths, errors = _of_cutoff(observer, cutoff, spectrum, inertia, delay, derived=derived)
        if np.isfinite(errors).all():
            mean = float(np.mean(errors / np.maximum(spectrum.power.sum(axis=0), 1e-12)))
            if best is None or mean < best[0]:
                best = mean, bandwidths, cutoff
    if best is None:
        raise ExoidError(
            f"no bandwidth up to {widest:g} Hz has a delay of at most {1e3 * delay:g} ms",
            remedy="sample faster, or allow a longer delay",
        )
    return replace(observer, bandwidth=best[1], cutoff=best[2])


def _of_cutoff(
    observer: TorqueObserver, cutoff: float, spectrum: _Spectrum, inertia: FloatArray, delay: float, *, derived: bool
) -> tuple[FloatArray, FloatArray]:
    """Best bandwidth of each joint with a low-pass of the channels, and its error, infinite where all lag too much."""
    widest = min(FAST, LARGEST * observer.rate)
    bandwidths = np.geomspace(min(SLOW, widest), widest, STEPS)
    errors = np.full((STEPS, len(inertia)), np.inf)
    for k, bandwidth in enumerate(bandwidths.tolist()):
        tried = replace(observer, bandwidth=bandwidth, cutoff=cutoff)
        if (allowed := tried.delay <= delay).any():
            R = np.array([tried.response(f) for f in spectrum.frequency.tolist()])
            missed = (np.abs(1.0 - R) ** 2 * spectrum.power).sum(axis=0)
            errors[k] = np.where(allowed, missed + tried.band.variance(inertia, derived=derived), np.inf)
    best = errors.argmin(axis=0)
    return bandwidths[best], errors[best, np.arange(len(inertia))]


def _spectrum(wide: TorqueObserver, recording: Recording, inertia: FloatArray, *, derived: bool) -> _Spectrum:
    """Spectrum of the torque of a log, by the reading of the widest observer."""
    found = wide.run(recording)
    y = found.torque[found.settling :]
    y = y - y.mean(axis=0)
    count, window = len(y), np.hanning(len(y))[:, None]
    power = np.abs(np.fft.rfft(y * window, axis=0)) ** 2 / (window**2).sum() / count
    power[1 : (count + 1) // 2] *= 2.0
    frequency = np.fft.rfftfreq(count, 1.0 / wide.rate)
    noise = _noise_power(wide, inertia, count, derived=derived)
    edges = np.concatenate([[0.0], np.geomspace(1.0 / count, 0.5, BINS)]) * wide.rate
    place = np.clip(np.searchsorted(edges, frequency, side="right") - 1, 0, BINS - 1)
    lines = np.bincount(place, minlength=BINS)
    middle = np.bincount(place, frequency, BINS) / np.maximum(lines, 1)
    read, of_noise = (np.column_stack([np.bincount(place, x, BINS) for x in each.T]) for each in (power, noise))
    gain = np.abs(np.array([wide.response(f) for f in middle.tolist()])) ** 2
    shown = (lines > 0) & (gain > PASSED**2).all(axis=1)
    upper = shown & (middle > UPPER * wide.bandwidths.max())
    level = np.maximum(np.median(read[upper] / of_noise[upper], axis=0), 1.0) if upper.any() else 1.0
    torque = np.where(read > TWICE * level * of_noise, read - level * of_noise, 0.0) / gain
    return _Spectrum(middle[shown], torque[shown])


def _noise_power(wide: TorqueObserver, inertia: FloatArray, count: int, *, derived: bool) -> FloatArray:
    """One-sided power of the reading's noise in each line of a spectrum of so many samples, (K, n)."""
    assert wide.noise is not None
    torque, velocity, angle = (std**2 for std in wide.noise.columns(wide.model.n))
    of_torque, of_velocity, of_angle = filtered_noise(wide.alignment, wide.filters)
    through = (of_angle, inertia**2 @ angle) if derived else (of_velocity, inertia**2 @ velocity)
    white = wide.band.torque / np.maximum((of_torque**2).sum(axis=0), 1e-300)
    lines = np.zeros((count // 2 + 1, wide.model.n))
    for response, variance in ((of_torque, np.maximum(white, torque)), through):
        lines += np.abs(np.fft.rfft(response[:count], count, axis=0)) ** 2 * variance / count
    lines[1 : (count + 1) // 2] *= 2.0
    return lines
