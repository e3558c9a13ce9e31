"""Checks of time, which need no model: missing samples, angles that wrap, late velocities."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.estimate.finding import Finding
from exoid.signals import Recording, ZeroPhase
from exoid.signals.differentiation import central_difference
from exoid.signals.noise_size import robust_std

WINDOW = 4
"""Samples on each side of an interval, through which lines are laid."""

GAP_SIZE = 9.0
"""A jump in time is so many times its noise,"""

SHORTEST_GAP, SHORTEST_TIME = 0.7, 5e-3
"""and at least this part of a sampling interval, and this time [s]: stamps of real logs jitter."""

WRAP = 0.1
"""A jump by a whole turn is off by this part of it at most."""

LATE = 4.5
"""A velocity is late if its delay is so many times its standard deviation,"""

SHORTEST_DELAY = 1e-3
"""and at least this [s]."""

GAIN = 0.05
"""A velocity has another scale than its angle if its gain is off by this much."""


def timing_findings(recording: Recording, acting: Mapping[str, Sequence[str]], name: str = "") -> Iterator[Finding]:
    """Check the times of a recording."""
    yield from wraps(recording, acting, name)
    yield from missing_samples(recording, acting, name)
    yield from late_velocities(recording, acting, name)


def wraps(recording: Recording, acting: Mapping[str, Sequence[str]], name: str = "") -> Iterator[Finding]:
    """Find angles that jump by a whole turn."""
    every = np.abs(np.diff(np.ascontiguousarray(recording.q.T), axis=1))
    for joint, steps in zip(recording.joint_names, every, strict=True):
        turns = np.abs(steps - 2.0 * np.pi) < WRAP * 2.0 * np.pi
        if turns.any():
            when = recording.time[int(turns.argmax()) + 1]
            yield Finding(
                "angle-wrap",
                joint,
                float(turns.sum()),
                "1",
                "error",
                f"the angle jumps by a whole turn {turns.sum()} times, first at {when:.3f} s",
                "unwrap it: q = np.unwrap(q, axis=0)",
                parameters=tuple(acting.get(joint, ())),
                recording=name,
            )


def missing_samples(recording: Recording, acting: Mapping[str, Sequence[str]], name: str = "") -> Iterator[Finding]:
    """Find places where samples are missing although the time stamps run on."""
    # Lines through the four samples on each side of an interval meet in its middle, but for noise and a change
    # of the acceleration. Where samples are missing, every angle jumps there by its velocity times the time
    # that is missing: the jumps of all joints together give that time, with its standard deviation.
    if len(recording) < 8 * WINDOW:
        return
    rate = recording.sample_rate
    q = np.ascontiguousarray(recording.q.T)
    jump, velocity = _jumps(q, 1.0 / rate)
    noise = robust_std((jump - np.median(jump, axis=1, keepdims=True)).T)
    floor = 1e-3 * np.sqrt(np.mean(velocity**2, axis=1)) / rate  # exact motions have no noise
    weight = 1.0 / np.maximum(noise, np.maximum(floor, 1e-12)) ** 2
    information = weight @ velocity**2
    gap = weight @ (velocity * jump) / np.maximum(information, 1e-300)
    size = gap * np.sqrt(information)
    odd: BoolArray = (size > GAP_SIZE) & (gap > max(SHORTEST_GAP / rate, SHORTEST_TIME))
    if not odd.any():
        return
    inner, steps = slice(WINDOW - 1, q.shape[1] - WINDOW), np.diff(q, axis=1)
    still = (steps == 0.0).astype(np.float64)
    near = np.max([np.convolve(of_joint, np.ones(2 * WINDOW), "same") for of_joint in still], axis=0)
    frozen: BoolArray = np.asarray(near >= 5.0)
    wrapped: BoolArray = np.asarray((np.abs(steps) > np.pi).any(axis=0))
    odd &= ~frozen[inner] & ~wrapped[inner]
    odd &= weight @ (jump - gap * velocity) ** 2 < 0.3 * size**2
    places = _peaks(odd, size)
    if not places:
        return
    worst = max(places, key=lambda k: gap[k])
    lost = float(sum(gap[k] for k in places))
    error = max(2.0 / float(np.sqrt(information[worst])), 0.5 / rate)  # no finer than half an interval
    names = dict.fromkeys(name for joint in recording.joint_names for name in acting.get(joint, ()))
    yield Finding(
        "missing-samples",
        "",
        lost,
        "s",
        "warning",
        f"{len(places)} gap{'s' if len(places) > 1 else ''} although the time stamps run on: at "
        f"{recording.time[worst + WINDOW - 1]:.3f} s all angles jump by what they travel in {1e3 * gap[worst]:.3g} ms",
        "use the stamps of the sensors, or split the log there and pass the parts (Recording.between)",
        interval=(max(0.0, lost - error), lost + error) if len(places) == 1 else None,
        parameters=tuple(names),
        recording=name,
    )


def late_velocities(recording: Recording, acting: Mapping[str, Sequence[str]], name: str = "") -> Iterator[Finding]:
    """Compare logged velocities with the derivative of the angles: v = g (q̇ − d q̈)."""
    if recording.v is None:
        return
    even = recording.resampled()
    rate = even.sample_rate
    low_pass = ZeroPhase(cutoff=min(6.0, 0.15 * rate))
    edge = low_pass.edge(rate)
    if len(even) <= 2 * edge + 20 or even.v is None:
        return
    q, logged = low_pass.filter(even.q, rate), low_pass.filter(even.v, rate)
    v = central_difference(q, rate, 4)
    a = central_difference(v, rate, 4)
    inner = slice(edge, len(q) - edge)
    names = tuple(dict.fromkeys(name for of_joint in acting.values() for name in of_joint))  # joints are coupled
    for k, joint in enumerate(even.joint_names):
        rows = np.column_stack([v[inner, k], a[inner, k], np.ones(len(q) - 2 * edge)])
        late = _delay(rows, logged[inner, k])
        if late is None:
            continue
        gain, delay, error = late
        if abs(delay) > max(LATE * error, SHORTEST_DELAY):
            yield Finding(
                "velocity-delay",
                joint,
                delay,
                "s",
                "warning",
                f"the logged velocity comes {1e3 * delay:.3g} ms {'after' if delay > 0.0 else 'before'} the derivative "
                "of the angle",
                "leave the velocity out of the log: exoid derives it from the angle without delay",
                interval=(delay - 2.0 * error, delay + 2.0 * error),
                parameters=names,
                recording=name,
            )
        if abs(gain - 1.0) > GAIN:
            yield Finding(
                "velocity-scale",
                joint,
                gain,
                "1",
                "error",
                f"the logged velocity is {gain:.3g} times the derivative of the angle",
                "leave the velocity out of the log, or correct its unit or sign",
                parameters=names,
                recording=name,
            )


def _jumps(q: FloatArray, interval: float) -> tuple[FloatArray, FloatArray]:
    """Jump of the angle [rad] and velocity [rad/s] in the middle of each inner interval, (n, N − 2 W + 1)."""
    k = np.arange(WINDOW) - 0.5 * (WINDOW - 1)
    slope = k / (k @ k)
    level = np.full(WINDOW, 1.0 / WINDOW)
    to_middle = 0.5 * WINDOW
    ahead, behind = level - to_middle * slope, level + to_middle * slope
    count, later = q.shape[1] - 2 * WINDOW + 1, q[:, WINDOW:]
    jump = _moving_sum(later, ahead, count) - _moving_sum(q, behind, count)
    velocity = 0.5 * (_moving_sum(later, slope, count) + _moving_sum(q, slope, count)) / interval
    return jump, velocity


def _moving_sum(x: FloatArray, weights: FloatArray, count: int) -> FloatArray:
    """Weighted sum of each sample and those behind it, (n, count)."""
    total = weights[0] * x[:, :count]
    for k, weight in enumerate(weights[1:], start=1):
        total += weight * x[:, k : k + count]
    return np.asarray(total)


def _peaks(odd: BoolArray, size: FloatArray) -> list[int]:
    """Largest of each group of neighbours."""
    places: list[int] = []
    for k in np.flatnonzero(odd):
        if places and k - places[-1] <= 2 * WINDOW:
            if size[k] > size[places[-1]]:
                places[-1] = int(k)
        else:
            places.append(int(k))
    return places


def _delay(rows: FloatArray, logged: FloatArray) -> tuple[float, float, float] | None:
    """Gain, delay [s] and its standard deviation, from blocks of the record; None where nothing moves."""
    if np.std(rows[:, 0]) == 0.0 or np.std(logged) == 0.0:
        return None
    whole, *_ = np.linalg.lstsq(rows, logged, rcond=None)
    gain = float(whole[0])
    if gain == 0.0:
        return None
    residual = logged - rows @ whole
    blocks = np.array_split(np.arange(len(rows)), max(4, min(20, len(rows) // 50)))
    inverse = np.linalg.pinv(rows.T @ rows)
    scores = np.array([rows[block].T @ residual[block] for block in blocks])
    covariance = inverse @ (scores.T @ scores) @ inverse * len(blocks) / (len(blocks) - 1)
    delay = -float(whole[1]) / gain
    return gain, delay, float(np.sqrt(covariance[1, 1])) / abs(gain)
