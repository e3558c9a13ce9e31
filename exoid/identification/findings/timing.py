"""Checks of time, which need no model: missing samples, angles that wrap, late velocities."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.estimate.finding import Finding
from exoid.regression.least_squares import scaled_inverse, scaled_lstsq
from exoid.signals import Recording, ZeroPhase
from exoid.signals.cutoff import robust_std
from exoid.signals.differentiation import central_difference

WINDOW = 4  # samples on each side of an interval, through which lines are laid


def wraps(recording: Recording) -> Iterator[Finding]:
    """Find angles that jump by a whole turn, to a tenth of it."""
    every = np.abs(np.diff(np.ascontiguousarray(recording.q.T), axis=1))
    for joint, steps in zip(recording.joint_names, every, strict=True):
        turns = np.abs(steps - 2.0 * np.pi) < 0.1 * 2.0 * np.pi
        if turns.any():
            when = recording.time[int(turns.argmax()) + 1]
            message = f"the angle jumps by a whole turn {turns.sum()} times, first at {when:.3f} s"
            remedy = "unwrap it: q = np.unwrap(q, axis=0)"
            yield Finding("angle-wrap", joint, float(turns.sum()), "1", "error", message, remedy)


def missing_samples(recording: Recording) -> Iterator[Finding]:
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
    # 9 standard deviations, and most of an interval, and 5 ms: stamps of real logs jitter
    odd: BoolArray = (size > 9.0) & (gap > max(0.7 / rate, 5e-3))
    if not odd.any():
        return
    inner, steps = slice(WINDOW - 1, q.shape[1] - WINDOW), np.diff(q, axis=1)
    still = (steps == 0.0).astype(np.float64)
    near = np.max([np.convolve(of_joint, np.ones(2 * WINDOW), "same") for of_joint in still], axis=0)
    wrapped = np.asarray((np.abs(steps) > np.pi).any(axis=0))
    odd &= ~np.asarray(near >= 5.0)[inner] & ~wrapped[inner]  # neither a frozen channel nor a wrap
    odd &= weight @ (jump - gap * velocity) ** 2 < 0.3 * size**2
    places = _peaks(odd, size)
    if not places:
        return
    worst = max(places, key=lambda k: gap[k])
    lost = float(sum(gap[k] for k in places))
    error = max(2.0 / float(np.sqrt(information[worst])), 0.5 / rate)  # no finer than half an interval
    message = (
        f"{len(places)} gap{'s' if len(places) > 1 else ''} although the time stamps run on: at "
        f"{recording.time[worst + WINDOW - 1]:.3f} s all angles jump by what they travel in {1e3 * gap[worst]:.3g} ms"
    )
    remedy = "use the stamps of the sensors, or split the log there and pass the parts (Recording.between)"
    interval = (max(0.0, lost - error), lost + error) if len(places) == 1 else None
    yield Finding("missing-samples", "", lost, "s", "warning", message, remedy, interval)


def _jumps(q: FloatArray, interval: float) -> tuple[FloatArray, FloatArray]:
    """Jump of the angle [rad] and velocity [rad/s] in the middle of each inner interval, (n, N − 2 W + 1)."""
    k = np.arange(WINDOW) - 0.5 * (WINDOW - 1)
    slope, level = k / (k @ k), np.full(WINDOW, 1.0 / WINDOW)
    windows, to_middle = np.lib.stride_tricks.sliding_window_view(q, WINDOW, axis=1), 0.5 * WINDOW
    before, after = windows[:, :-WINDOW], windows[:, WINDOW:]
    jump = after @ (level - to_middle * slope) - before @ (level + to_middle * slope)
    return jump, 0.5 * (after @ slope + before @ slope) / interval


def _peaks(odd: BoolArray, size: FloatArray) -> list[int]:
    """Largest of each group of neighbours."""
    places: list[int] = []
    for k in np.flatnonzero(odd).tolist():
        if not places or k - places[-1] > 2 * WINDOW:
            places.append(k)
        elif size[k] > size[places[-1]]:
            places[-1] = k
    return places


def late_velocities(recording: Recording) -> Iterator[Finding]:
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
    for k, joint in enumerate(even.joint_names):
        rows = np.column_stack([v[inner, k], a[inner, k], np.ones(len(q) - 2 * edge)])
        late = _delay(rows, logged[inner, k])
        if late is None or np.ptp(q[inner, k]) < 0.02:  # [rad], at a stall the derivative is noise
            continue
        gain, delay, error = late
        if abs(delay) > max(4.5 * error, 1e-3):
            when = "after" if delay > 0.0 else "before"
            message = f"the logged velocity comes {1e3 * delay:.3g} ms {when} the derivative of the angle"
            remedy = "leave the velocity out of the log, as identify did: it is derived from the angle without delay"
            interval = delay - 2.0 * error, delay + 2.0 * error
            yield Finding("velocity-delay", joint, delay, "s", "warning", message, remedy, interval)
        if abs(gain - 1.0) > 0.05:
            message = f"the logged velocity is {gain:.3g} times the derivative of the angle"
            remedy = "leave the velocity out of the log, or correct its unit or sign"
            yield Finding("velocity-scale", joint, gain, "1", "error", message, remedy)


def _delay(rows: FloatArray, logged: FloatArray) -> tuple[float, float, float] | None:
    """Gain, delay [s] and its standard deviation, from blocks of the record; None where nothing moves."""
    if np.std(rows[:, 0]) == 0.0 or np.std(logged) == 0.0:
        return None
    whole = scaled_lstsq(rows, logged)
    gain = float(whole[0])
    if gain == 0.0:
        return None
    residual = logged - rows @ whole
    blocks = np.array_split(np.arange(len(rows)), max(4, min(20, len(rows) // 50)))
    inverse = scaled_inverse(rows.T @ rows)
    scores = np.array([rows[block].T @ residual[block] for block in blocks])
    covariance = inverse @ (scores.T @ scores) @ inverse * len(blocks) / (len(blocks) - 1)
    return gain, -float(whole[1]) / gain, float(np.sqrt(covariance[1, 1])) / abs(gain)
