"""Stream of samples: one by one they are taken in, and those that cannot be are left out and counted."""

from __future__ import annotations

import math
from operator import sub
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError
from exoid.leg.description import LARGEST_ANGLE
from exoid.signals.checks import FASTEST

from .settings import Settings

BRIDGED = 3
"""Largest number of consecutive samples that are missing and replaced by straight lines."""

REFUSED = 1.0
"""Time without a plausible sample after which a jump is believed; after twice that the stream is refused [s]."""

FAULTS = {
    "not-finite": ("samples with NaN or infinite numbers were left out", "look at the connection of the sensor"),
    "angle-jump": ("samples whose angle jumped were left out", "look at the encoder, and for angles in degrees"),
    "repeated-sample": ("samples that came twice were left out", "send each sample once"),
    "missing-samples": ("samples are missing", "send all samples, at an even rate"),
    "saturated-torque": ("torques at their limit were left out", "move more gently, or take a larger drive"),
    "stuck-torque": ("torques that kept one value while their joint moved were left out", "look at their sensor"),
}
"""Message and remedy of each fault."""

STUCK, MOVED = 0.3, 0.05
"""Time for which a torque that is stuck keeps one value [s], and distance by which its joint moves [rad]."""

Sample = tuple[float, ...]
"""q, v, a, τ and marks of all joints, (5 n,)."""


class Stream(NamedTuple):
    """What is known of the stream of samples."""

    given: tuple[bool, ...] = ()  # whether velocities and accelerations are given; empty before the first sample
    last: Sample = ()  # last plausible sample; empty before the first
    time: float = math.nan  # its time stamp [s]; NaN without time stamps
    missing: int = 0  # samples that are missing since then
    implausible: int = 0  # samples that were refused since the last plausible one
    held: tuple[int, ...] = ()  # samples for which the torque of each joint has kept one value; empty before the first
    since: Sample = ()  # angle of each joint when that began [rad]; infinite once it is stuck
    # squared ways of the blocks by angles, and products with those by velocities [rad²], (2, n)
    travel: FloatArray = np.zeros((2, 1))
    periods: float = 0.0  # sampling periods that time stamps say have passed
    counted: int = 0  # and those that samples were counted as
    counts: tuple[int, ...] = (0,) * len(FAULTS)  # number of samples with each fault
    received: int = 0  # number of samples that were received

    def with_fault(self, kind: str, number: int = 1) -> Stream:
        """Count samples with a fault."""
        counts = (c + number if k == kind else c for k, c in zip(FAULTS, self.counts, strict=True))
        return self._replace(counts=tuple(counts))


def take(settings: Settings, stream: Stream, sample: Sample, time: float) -> tuple[Stream, tuple[Sample, ...], bool]:
    """Look at a sample of q, v, a and τ, (4 n,): the stream, samples that go on, and whether filters start again."""
    n, last = settings.n, stream.last
    if not math.isfinite(sum(sample)):
        return _refused(settings, stream, "not-finite"), (), False
    if last and not math.isnan(time) and not math.isnan(stream.time):
        steps = (time - stream.time) * settings.rate
        if not steps > 0.5:
            return stream.with_fault("repeated-sample")._replace(received=stream.received + 1), (), False
        late = round(steps) - 1
        stream = stream._replace(periods=stream.periods + steps, counted=stream.counted + late + 1)
        if late > stream.missing:
            stream = stream.with_fault("missing-samples", late - stream.missing)._replace(missing=late)
    q, missing = sample[:n], stream.missing
    if last:
        jumped = max(map(abs, map(sub, q, last))) > FASTEST / settings.rate * (1 + missing)
        if jumped and stream.implausible < settings.rate * REFUSED:
            return _refused(settings, stream, "angle-jump"), (), False
    if max(map(abs, q)) > 2.0 * LARGEST_ANGLE:
        worst = max(range(n), key=lambda k: abs(q[k]))
        name = settings.model.joint_names[worst]
        what = f"{name} at {q[worst]:.4g} rad: no joint of a leg turns twice"
        raise UnreadableInputError(what, remedy="pass radians: numpy.deg2rad(q)", joints=(name,))
    marks, tau = (0.0,) * n, sample[3 * n :]
    if settings.torque_limits:
        marks = tuple(float(abs(x) >= y) for x, y in zip(tau, settings.torque_limits, strict=True))
        if any(marks):
            stream = stream.with_fault("saturated-torque")
    held, since = _held(stream, q, tau, settings.rate)
    if math.inf in since:
        marks = tuple(max(mark, float(math.isinf(x))) for mark, x in zip(marks, since, strict=True))
        stream = stream.with_fault("stuck-torque")
    now, received = (*sample, *marks), stream.received + 1
    after = stream._replace(last=now, time=time, missing=0, implausible=0, held=held, since=since, received=received)
    if not (last and 0 < missing <= BRIDGED):
        return after, (now,), missing > BRIDGED
    shares = [k / (missing + 1.0) for k in range(1, missing + 1)]
    bridge = (tuple(x + share * (y - x) for x, y in zip(last, now, strict=True)) for share in shares)
    return after, (*bridge, now), False


def _held(stream: Stream, q: Sample, tau: Sample, rate: float) -> tuple[tuple[int, ...], Sample]:
    """Samples for which the torque of each joint has kept one value, and its angle since; infinite once it is stuck."""
    n, last = len(q), stream.last
    held = stream.held or (0,) * n
    if last:
        held = tuple(count + 1 if x == y else 0 for count, x, y in zip(held, tau, last[3 * n :], strict=False))
    if not any(held):
        return held, q
    since = []
    for count, begun, x in zip(held, stream.since, q, strict=True):
        stuck = count > STUCK * rate and abs(x - begun) > MOVED
        since.append(math.inf if stuck else begun if count else x)
    return held, tuple(since)


def moved(stream: Stream, samples: FloatArray, rate: float) -> Stream:
    """Add how far joints move in a block, by their angles and by their velocities."""
    n = samples.shape[1] // 5
    by_angle, v = samples[-1, :n] - samples[0, :n], samples[:, n : 2 * n]
    by_velocity = (v.sum(axis=0) - 0.5 * (v[0] + v[-1])) / rate
    return stream._replace(travel=stream.travel + np.array([by_angle**2, by_angle * by_velocity]))


def one_sample(q: ArrayLike, v: ArrayLike | None, a: ArrayLike | None, tau: ArrayLike, n: int) -> Sample | None:
    """Put one sample of arrays (n,) together, fast; None for anything else."""
    values: list[float] = []
    for channel in (q, v, a, tau):
        if channel is None and q is not None and tau is not None:
            values += [0.0] * n
        elif isinstance(channel, np.ndarray) and channel.shape == (n,) and channel.dtype == np.float64:
            values += channel.tolist()
        else:
            return None
    return tuple(values)


def as_table(values: ArrayLike | None, name: str, n: int, count: int | None) -> FloatArray:
    """Check an argument of an update, (N, n)."""
    if values is None:
        if name in ("q", "tau"):
            raise BadArgumentError(f"there is no {name} in the sample", remedy="pass q in rad and tau in N·m")
        return np.zeros((count or 0, n))
    try:
        table = np.atleast_2d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError) as error:
        what = f"{name} is no array of numbers ({error})"
        raise BadArgumentError(what, remedy="pass (n,) or (N, n) in SI units") from None
    if table.ndim != 2 or table.shape[1] != n or count not in (None, len(table)):
        what = f"{name} of shape {np.shape(values)} for {n} joints and {count or 'any number of'} samples"
        raise BadArgumentError(what, remedy=f"pass ({n},) or (N, {n}) in SI units")
    return table


def _refused(settings: Settings, stream: Stream, kind: str) -> Stream:
    """Count a sample that is left out."""
    refused = stream.implausible + 1
    if refused > 2.0 * REFUSED * settings.rate:
        message, remedy = FAULTS[kind]
        what = f"no plausible sample for {refused / settings.rate:.3g} s ({message})"
        raise UnreadableInputError(what, remedy=remedy)
    return stream.with_fault(kind)._replace(
        missing=stream.missing + 1, implausible=refused, received=stream.received + 1
    )
