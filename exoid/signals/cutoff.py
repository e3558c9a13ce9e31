"""Cut-off frequencies of the zero-phase preparation by the noise of the angles, and the size of noise."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

from .base_motion import BaseMotion
from .poses import Poses
from .preparation import KINEMATICS_MULTIPLE, LARGEST_RATIO, ZeroPhase
from .recording import Recording


def robust_std(x: FloatArray) -> FloatArray:
    """Standard deviation about zero by the median of the absolute values, 1.4826 med |x|."""
    return np.asarray(1.4826 * np.median(np.abs(x), axis=0))


def white_noise(signals: FloatArray) -> FloatArray:
    """Standard deviation of white noise in smooth signals, by their fourth differences."""
    # the variance of these differences is 1² + 4² + 6² + 4² + 1² times that of the noise
    return np.asarray(robust_std(np.diff(signals, 4, axis=0)) / np.sqrt(70.0))


def noisier(signals: FloatArray, rng: np.random.Generator, sign: float = 1.0) -> FloatArray:
    """Add noise of its own size to smooth signals: what it does to a result, the noise that is there has done."""
    return np.asarray(signals + sign * white_noise(signals) * rng.standard_normal(signals.shape))


def noisier_base(base: BaseMotion, rng: np.random.Generator, sign: float = 1.0) -> BaseMotion:
    """Add noise of their own size to the readings of a base."""
    gyro, force = np.hsplit(noisier(base.columns, rng, sign), 2)
    return replace(base, angular_velocity=gyro, specific_force=force)


CUTOFFS = np.linspace(1.0, 8.0, 71)
"""Cut-off frequencies that are compared [Hz]; legs do not move faster."""

FAST = np.geomspace(2.0, 256.0, 57)
"""Frequencies up to which fast motion is compared with noise [Hz]."""


class AccelerationPower(NamedTuple):
    """Power of the acceleration below each of :data:`CUTOFFS`, in a common unit."""

    noise: FloatArray  # power due to noise of the angles, of place and turn of a base by its pose, and of its gyroscope
    total: FloatArray  # power of the recorded angles, as many columns
    fast: FloatArray  # that of noise, and total, below each of :data:`FAST`, (2, 57, n); zero without contacts
    samples: int  # number of samples
    rate: float  # sampling rate [Hz]


def choose_preparation(recordings: Iterable[Recording | Poses], *, base_rows: bool = False) -> ZeroPhase:
    """Choose the cut-off frequencies by the noise of the angles: accelerations have little of it, motion is not lost.

    White noise of power density N in an angle gives ω⁴ N in the acceleration. N is the median of the periodogram P of
    the angle in its upper band, over ln 2. For each joint, noise and signal below the cut-off f are compared over all
    segments of all recordings:

        Σ ∫₀ᶠ ω⁴ N ≤ 0.02² Σ ∫₀ᶠ ω⁴ P.

    The result is the smallest over the joints of the highest such f, between 1 and 8 Hz, and at most a fifth of the
    rate. If there is none for a joint, its f has the smallest noise ratio. For short recordings f is raised
    until the ends of the filters leave half of the samples. Recorded accelerations have no such noise. Where the base
    moves, noise and signal of its angular acceleration are added to those of each joint.

    Angles pass up to 2 f. Touch-downs shake a leg faster, and what a filter takes of it changes the sign of friction.
    Where recordings have contacts, angles pass up to where the noise of an acceleration is a tenth of it, if a joint
    has more than a fifth of its acceleration (RMS) between both. Beyond, noise reaches all rows: a stance is short.

    Args:
        recordings: Recordings to identify from, all of the same joints. Poses are ignored.
        base_rows: Whether rows of the base are identified from.

    Returns:
        The preparation.

    Raises:
        ExoidError: Time has a gap.
    """
    powers = (acceleration_power(recording, base_rows=base_rows) for recording in recordings)
    return preparation_from([found for found in powers if found is not None])


def acceleration_power(recording: Recording | Poses, *, base_rows: bool = False) -> AccelerationPower | None:
    """Compute noise and signal power of the acceleration of a recording."""
    if isinstance(recording, Poses):
        return None
    even = recording.resampled()
    rate = even.sample_rate
    if recording.a is not None:
        nothing = np.zeros((len(CUTOFFS), len(recording.joint_names) + 3))
        return AccelerationPower(nothing, nothing, np.zeros((2, len(FAST), len(nothing[0]) - 3)), len(even), rate)
    power, of_base = _power(even.q.T, rate), np.zeros((2, len(CUTOFFS), 3))  # place and turn by its pose, turn by gyro
    touches = any(contact.any() for contact in even.contacts.values())
    fast = _power(even.q.T, rate, FAST) if touches else np.zeros((2, len(FAST), even.q.shape[1]))
    if even.base is not None and even.base.pose is not None:
        of_pose = _power(even.base.pose.columns.T, rate)
        of_base[..., 0], of_base[..., 1] = of_pose[..., :3].sum(axis=2), of_pose[..., 3:].sum(axis=2)
        if base_rows or recording.contacts:
            # A base that a pose carries moves all masses, and its noise is in every column. Only what these columns do
            # not share is left for an inertia of the torso, which the noise would attenuate by 0.3 % without this.
            power[0], of_base[0] = 16.0 * power[0], 16.0 * of_base[0]
    elif even.base is not None:
        turning = _power(even.base.angular_velocity.T, rate, derivatives=1)
        turning = turning[..., [int(np.argmax(turning[1, -1]))]]  # about the axis that turns most
        power, of_base[..., 2:] = power + turning, turning if base_rows else 0.0
    noise, total = np.concatenate([power, of_base], axis=2)
    return AccelerationPower(noise, total, fast, len(even), rate)


def preparation_from(powers: Sequence[AccelerationPower]) -> ZeroPhase:
    """Choose the cut-off frequencies by the powers of each recording, see :func:`choose_preparation`."""
    if not powers:
        return ZeroPhase(float(CUTOFFS[-1]))
    noise, total = np.sum([each.noise for each in powers], axis=0), np.sum([each.total for each in powers], axis=0)
    ratio = noise / np.maximum(total, np.finfo(float).tiny)
    # Noise in a column attenuates its parameter by about the square of the ratio (RMS): 0.04 %
    allowed = ratio <= 0.02**2
    last = len(CUTOFFS) - 1 - np.argmax(allowed[::-1], axis=0)
    lowest = int(np.where(allowed.any(axis=0), last, np.argmin(ratio, axis=0)).min())
    rate = min(each.rate for each in powers)
    highest = min(float(CUTOFFS[-1]), LARGEST_RATIO / KINEMATICS_MULTIPLE * rate)  # both filters have their usual ratio
    # the ends of the filters leave half of each recording
    above = CUTOFFS[lowest:][CUTOFFS[lowest:] < highest].tolist()
    fits = (f for f in above if all(4 * ZeroPhase(f).edge(each.rate) <= each.samples for each in powers))
    cutoff = next(fits, highest)
    return ZeroPhase(cutoff, _fast_cutoff(powers, KINEMATICS_MULTIPLE * cutoff, LARGEST_RATIO * rate))


def _fast_cutoff(powers: Sequence[AccelerationPower], usual: float, highest: float) -> float | None:
    """Find up to where motion stands out of noise, if much of it is beyond the usual cut-off of the angles."""
    noise, total = np.sum([each.fast for each in powers], axis=0)
    clear = noise < 0.1**2 * total
    moves = clear.any(axis=0)
    reach, below = np.max(np.flatnonzero(clear[:, moves].all(axis=1)), initial=0), np.searchsorted(FAST, usual)
    motion = (total - noise)[:, moves]
    if reach <= below or not (motion[reach] - motion[below] > 0.2**2 * motion[reach]).any():
        return None
    return min(float(FAST[reach]), highest)


def _power(signals: FloatArray, rate: float, edges: FloatArray = CUTOFFS, *, derivatives: int = 2) -> FloatArray:
    """Powers of noise and of signal in the derivative of signals (n, N), below each of some frequencies, (2, F, n)."""
    powers = np.zeros((2, len(edges), len(signals)))
    for segment in np.array_split(signals, -(-signals.shape[1] // 2**16), axis=1):
        samples = segment.shape[1]
        t = np.linspace(-1.0, 1.0, samples)
        detrended = np.ascontiguousarray(segment)
        detrended = detrended - detrended.mean(axis=1, keepdims=True)
        detrended -= np.multiply.outer(detrended @ t / (t @ t), t)
        spectrum = scipy.fft.rfft(detrended * np.hanning(samples))
        power = (spectrum.real**2 + spectrum.imag**2) / samples
        frequency = scipy.fft.rfftfreq(samples, 1.0 / rate)
        noise = np.median(power[:, frequency >= 0.6 * frequency[-1]], axis=1) / np.log(2.0)  # above, noise only
        below = np.searchsorted(frequency, edges, side="right") - 1
        slow = slice(0, below[-1] + 1)
        weight = (2.0 * np.pi * frequency[slow]) ** (2 * derivatives)
        powers[0] += np.multiply.outer(np.cumsum(weight)[below], noise)
        powers[1] += np.cumsum(weight * power[:, slow], axis=1)[:, below].T
    return powers
