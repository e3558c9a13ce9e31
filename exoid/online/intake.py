"""Intake: samples of a stream one by one, of which those that cannot be are left out and counted."""

from __future__ import annotations

import math
from operator import sub
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding

from .settings import Settings

FASTEST = 50.0
"""Largest speed of a joint [rad/s]: angles that change faster jump."""

FARTHEST = 4.0 * math.pi
"""Largest angle of a joint of a leg [rad]; larger ones are degrees."""

BRIDGED = 3
"""Largest number of consecutive samples that are missing and replaced by straight lines."""

REFUSED = 1.0
"""Time without a plausible sample after which the stream is refused [s]."""

EVEN = 0.5
"""Largest error of a time stamp, in sampling intervals, that leaves its sample in its place."""

SHARE = 0.001
"""Share of the samples from which on a fault is a warning."""

MESSAGES = {
    "not-finite": ("samples with NaN or infinite numbers were left out", "look at the connection of the sensor"),
    "angle-jump": ("samples whose angle jumped were left out", "look at the encoder, and for angles in degrees"),
    "repeated-sample": ("samples that came twice were left out", "send each sample once"),
    "missing-samples": ("samples are missing", "send all samples, at an even rate"),
    "saturated-torque": ("torques at their limit were left out", "move more gently, or take a larger drive"),
}
"""Message and remedy of each fault."""

NOTHING = tuple((kind, 0) for kind in MESSAGES)
"""Counts before the first sample."""


class Intake(NamedTuple):
    """What is known of the stream of samples."""

    # whether velocities and accelerations are given; None before the first sample
    given: tuple[bool, bool] | None = None
    last: tuple[float, ...] = ()  # last plausible sample of q, v, a, τ and marks, (5 n,); empty before the first
    time: float = math.nan  # its time stamp [s]; NaN without time stamps
    missing: int = 0  # samples that are missing since then
    implausible: int = 0  # samples that were refused since the last plausible one
    counts: tuple[tuple[str, int], ...] = NOTHING  # number of samples with each fault
    received: int = 0  # number of samples that were received


class Taken(NamedTuple):
    """Samples that go on to the filters."""

    intake: Intake  # the stream after them
    samples: tuple[tuple[float, ...], ...]  # samples of q, v, a, τ and marks, (5 n,) each
    gap: bool = False  # whether the filters have to start again before them


def take(settings: Settings, intake: Intake, sample: tuple[float, ...], time: float) -> Taken:
    """Look at one sample."""
    n, last = settings.n, intake.last
    if not math.isfinite(sum(sample)):
        return Taken(_refused(settings, intake, "not-finite"), ())
    if last and not math.isnan(time) and not math.isnan(intake.time):
        steps = (time - intake.time) * settings.rate
        if not steps > EVEN:
            return Taken(_counted(intake, "repeated-sample")._replace(received=intake.received + 1), ())
        late = round(steps) - 1
        if late > intake.missing:
            intake = _counted(intake, "missing-samples", late - intake.missing)._replace(missing=late)
    q = sample[:n]
    if last:
        widest = FASTEST / settings.rate * (1 + intake.missing)
        jumped = max(map(abs, map(sub, q, last))) > widest
        if jumped and intake.implausible < settings.rate * REFUSED:
            return Taken(_refused(settings, intake, "angle-jump"), ())
    if max(q) > FARTHEST or min(q) < -FARTHEST:
        raise _degrees(settings, q)
    marks = (0.0,) * n
    if settings.limits is not None:
        marks = tuple(float(abs(x) >= y) for x, y in zip(sample[3 * n :], settings.limits, strict=True))
        if any(marks):
            intake = _counted(intake, "saturated-torque")
    full, missing = (*sample, *marks), intake.missing
    after = Intake(intake.given, full, time, 0, 0, intake.counts, intake.received + 1)
    if not missing:
        return Taken(after, (full,))
    bridged = _between(last, full, missing) if missing <= BRIDGED and last else ()
    return Taken(after, (*bridged, full), gap=missing > BRIDGED)


def findings_of(settings: Settings, intake: Intake) -> tuple[Finding, ...]:
    """Turn the faults of a stream into findings."""
    found = []
    for kind, number in intake.counts:
        if number:
            message, remedy = MESSAGES[kind]
            share = number / max(intake.received, 1)
            text = f"{number} of {intake.received} {message}"
            severity = "warning" if share > SHARE else "info"
            found.append(Finding(f"stream-{kind}", "", share, "", severity, text, remedy))  # type: ignore[arg-type]
    return tuple(found)


def one_sample(
    q: ArrayLike, v: ArrayLike | None, a: ArrayLike | None, tau: ArrayLike, n: int
) -> tuple[float, ...] | None:
    """Put one sample of arrays (n,) together, fast."""
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
    """Check an argument of an update."""
    if values is None:
        if name in ("q", "tau"):
            raise ExoidError(f"there is no {name} in the sample", remedy="pass q in rad and tau in N·m")
        return np.zeros((count or 0, n))
    try:
        table = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ExoidError(f"{name} is no array of numbers ({error})", remedy="pass (n,) or (N, n) in SI units") from None
    table = table[None] if table.ndim == 1 else table
    if table.ndim != 2 or table.shape[1] != n or (count is not None and len(table) != count):
        wanted = f"({n},) or (N, {n})" if count is None else f"({count}, {n})"
        raise ExoidError(f"{name} of shape {np.shape(values)} for {n} joints", remedy=f"pass {wanted} in SI units")
    return table


def _refused(settings: Settings, intake: Intake, kind: str) -> Intake:
    """Count a sample that is left out."""
    refused = intake.implausible + 1
    if refused > 2.0 * REFUSED * settings.rate:
        raise ExoidError(
            f"no plausible sample for {refused / settings.rate:.3g} s ({MESSAGES[kind][0]})",
            remedy=MESSAGES[kind][1],
        )
    return _counted(intake, kind)._replace(
        missing=intake.missing + 1, implausible=refused, received=intake.received + 1
    )


def _counted(intake: Intake, kind: str, number: int = 1) -> Intake:
    return intake._replace(counts=tuple((k, c + number if k == kind else c) for k, c in intake.counts))


def _degrees(settings: Settings, q: tuple[float, ...]) -> ExoidError:
    joint = max(range(len(q)), key=lambda k: abs(q[k]))
    return ExoidError(
        f"{settings.model.joint_names[joint]} at {q[joint]:.4g} rad: no joint of a leg turns twice",
        remedy="pass radians: numpy.deg2rad(q)",
    )


def _between(last: tuple[float, ...], now: tuple[float, ...], missing: int) -> tuple[tuple[float, ...], ...]:
    """Samples on the straight lines between two."""
    shares = [k / (missing + 1.0) for k in range(1, missing + 1)]
    return tuple(tuple(x + share * (y - x) for x, y in zip(last, now, strict=True)) for share in shares)
