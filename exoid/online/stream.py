"""Stream of samples: one by one they are taken in, and those that cannot be are left out and counted."""

from __future__ import annotations

import math
from operator import sub
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError
from exoid.signals.checks import FASTEST

from .settings import Settings

BRIDGED, JITTER = 3, 0.75
"""Largest number of consecutive missing samples that straight lines replace, and jitter of time stamps [periods]."""

REFUSED = 1.0
"""Time without a plausible sample after which a jump is believed; after twice that the stream is refused [s]."""

FAULTS = {
    "not-finite": (
        "samples with NaN or infinite numbers were left out",
        "look at the connection of the sensor; a joint without an actuator is passive=",
    ),
    "angle-jump": ("samples whose angle jumped were left out", "look at the encoder, and for angles in degrees"),
    "time-jump": ("samples whose time stamp jumped were left out", "look at the clock, and for stamps not in s"),
    "late-sample": ("samples older than the one before were left out", "send them in order, and look at the clock"),
    "repeated-sample": ("samples that came twice were left out", "send each sample once"),
    "missing-samples": (
        "samples are missing",
        "send all samples, at an even rate; leave time= out if it is that of arrival",
    ),
    "saturated-torque": ("torques at their limit were left out", "move more gently, or take a larger drive"),
    "stuck-torque": (
        "torques that kept one value while their joint moved were left out",
        "look at their sensor; a joint without an actuator is passive=",
    ),
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
    time: float = math.nan  # its time by a clock that follows the stamps [s]; NaN without time stamps
    stamp: float = math.nan  # time stamp of the last sample, also of one that was refused [s]
    missing: int = 0  # samples that are missing since then
    implausible: int = 0  # samples that were refused since the last plausible one
    held: tuple[int, ...] = ()  # samples for which the torque of each joint has kept one value; empty before the first
    since: Sample = ()  # angle of each joint when that began [rad]; infinite once it is stuck
    slipped: tuple[int, ...] = ()  # joints whose angle jumped to the last plausible sample, and stayed there
    # squared ways of the blocks by angles, and products with those by velocities [rad²], (2, n)
    travel: FloatArray = np.zeros((2, 1))
    # sampling periods that time stamps say have passed, those that they were rounded to, and samples behind them
    periods: tuple[float, int, int] = (0.0, 0, 0)
    counts: tuple[int, ...] = (0,) * len(FAULTS)  # number of samples with each fault
    received: int = 0  # number of samples that were received

    def with_fault(self, kind: str, number: int = 1) -> Stream:
        """Count samples with a fault."""
        counts = (c + number if k == kind else c for k, c in zip(FAULTS, self.counts, strict=True))
        return self._replace(counts=tuple(counts))


def take(settings: Settings, stream: Stream, sample: Sample, time: float) -> tuple[Stream, tuple[Sample, ...], bool]:
    """Look at a sample of q, v, a and τ, (4 n,): the stream, samples that go on, and whether filters start again."""
    n, last = settings.n, stream.last
    if not math.isfinite(sum(sample)) or math.isinf(time):
        return _refused(settings, stream, "not-finite"), (), False
    stream, clock, fault = _clocked(settings, stream, sample, time)
    if fault == "repeated-sample":
        return stream.with_fault(fault), (), False
    if fault:
        return _refused(settings, stream, fault), (), False
    q, missing = sample[:n], stream.missing
    limit = FASTEST / settings.rate * (1 + missing)
    if last and stream.implausible < settings.rate * REFUSED and max(map(abs, map(sub, q, last))) > limit:
        return _refused(settings, stream, "angle-jump"), (), False
    for name, x in zip(settings.model.leg.joint_names, q, strict=True):
        if abs(x) > settings.largest_angle:
            what = (
                f"{name} at {x:.4g} rad (limit {settings.largest_angle:.4g} rad) looks like degrees, or a slide in mm"
            )
            remedy = "pass radians and metres; largest_angle=math.inf if the joint really turns that far"
            raise UnreadableInputError(what, remedy=remedy, joints=(name,))
    tau = sample[3 * n :]
    marks = tuple(float(abs(x) >= y) for x, y in zip(tau, settings.torque_limits, strict=False)) or (0.0,) * n
    if any(marks):
        stream = stream.with_fault("saturated-torque")
    held, since = _held(settings, stream, q, tau)
    if math.inf in since:
        marks = tuple(max(mark, float(math.isinf(x))) for mark, x in zip(marks, since, strict=True))
        stream = stream.with_fault("stuck-torque")
    now = (*sample, *marks)  # a reading that was off comes back, an encoder that slipped does not
    slipped = tuple(j for j in range(n) if stream.implausible and last and abs(q[j] - last[j]) > 0.5 * limit)
    after = stream._replace(last=now, time=clock, missing=0, implausible=0, held=held, since=since, slipped=slipped)
    gap = missing > BRIDGED or bool(slipped)
    shares = [k / (missing + 1.0) for k in range(1, missing + 1)] if last and not gap else []
    bridge = (tuple(x + share * (y - x) for x, y in zip(last, now, strict=True)) for share in shares)
    return after, (*bridge, now), gap


def _clocked(settings: Settings, stream: Stream, sample: Sample, time: float) -> tuple[Stream, float, str]:
    """Count the samples that are missing by a time stamp: the stream, the time by its clock, and a fault or ""."""
    before, stream = stream.stamp, stream._replace(stamp=time)
    if not stream.last or math.isnan(time - stream.time):
        return stream, time, ""
    steps, ticks = (time - stream.time) * settings.rate, (time - before) * settings.rate
    repeated = ticks == 0.0 or (steps < 0.5 and sample == stream.last[: len(sample)])
    follows, late = 0.0 < ticks < BRIDGED + 1.5, BRIDGED + 1
    if -BRIDGED - 1.5 < ticks < REFUSED * settings.rate:  # rounding errors of jitter cancel
        passed, rounded, samples = stream.periods
        stream = stream._replace(periods=(passed + ticks, rounded + round(ticks), samples + (not repeated)))
    if repeated:
        return stream, time, "repeated-sample"
    if -JITTER < steps < REFUSED * settings.rate:
        late = max(0, math.floor(steps - JITTER))
        follow = max(0.05, 1.0 / stream.received)  # a clock that averages stamps has less jitter than each
        time = stream.time + (1.0 + late + follow * (steps - 1.0 - late)) / settings.rate
    elif not follows:  # a pause, or a clock that was set, is believed once two stamps agree
        return stream, time, "time-jump" if steps > 0.0 else "late-sample"
    if late > stream.missing:
        stream = stream.with_fault("missing-samples", late - stream.missing)._replace(missing=late)
    return stream, time, ""


def _held(settings: Settings, stream: Stream, q: Sample, tau: Sample) -> tuple[tuple[int, ...], Sample]:
    """Samples for which the torque of each joint has kept one value, and its angle since; infinite once it is stuck."""
    kept = zip(stream.held, tau, stream.last[3 * len(q) :], strict=False)
    held = tuple(count + 1 if x == y else 0 for count, x, y in kept) or (0,) * len(q)
    held = tuple(count * is_driven for count, is_driven in zip(held, settings.driven.tolist(), strict=True))
    if not any(held):
        return held, q
    stuck = [
        k > STUCK * settings.rate and abs(x - begun) > MOVED for k, begun, x in zip(held, stream.since, q, strict=True)
    ]
    since = zip(stuck, held, stream.since, q, strict=True)
    return held, tuple(math.inf if one else begun if count else x for one, count, begun, x in since)


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
        raise UnreadableInputError(f"no plausible sample for {2.0 * REFUSED:.3g} s ({message})", remedy=remedy)
    late = kind == "late-sample"  # it counted as missing when a later one came, and takes no time of its own
    stream = stream.with_fault(kind).with_fault("missing-samples", -late)
    return stream._replace(missing=stream.missing + (not late), implausible=refused)
