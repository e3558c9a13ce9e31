"""Checks of single channels, which need no model: rails, frozen and repeated values, dropouts, spikes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding, Severity
from exoid.signals import Recording
from exoid.signals.cutoff import robust_std
from exoid.signals.quantities import UNITS

FROZEN_TORQUE = 0.15  # shortest time for which a torque that moves has to stand still to count as frozen [s]


@dataclass(frozen=True, eq=False)
class Channel:
    """One quantity of one joint."""

    time: FloatArray  # stamps [s], (N,)
    rate: float  # sampling rate [Hz]
    x: FloatArray  # signal, (N,)
    others: FloatArray  # all angles [rad], (N, n), to see whether the leg moves
    joint: str  # name of the joint
    noun: str  # word for the quantity
    unit: str  # its unit

    @cached_property
    def steps(self) -> FloatArray:
        """Absolute change from sample to sample, (N − 1,)."""
        return np.asarray(np.abs(np.diff(self.x)))

    def runs(self, tolerance: float = 0.0) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Runs of consecutive samples with the same value: indices of their first samples, and lengths, (R,) each."""
        start = np.append(0, np.flatnonzero(self.steps > tolerance) + 1)
        return start, np.diff(start, append=len(self.x))

    def long_runs(self, shortest: float) -> list[tuple[int, int]]:
        """Runs that last for a time [s], and 8 times longer than 99 % of the others; frozen ones are among these."""
        least = max(10.0, shortest * self.rate)
        start, length = self.runs()
        others = length[length < least]
        usual = float(np.quantile(others, 0.99)) if 0 < len(others) < len(length) else 1.0
        long = (length >= least) & (length >= 8.0 * usual)
        return list(zip(start[long].tolist(), (start + length)[long].tolist(), strict=True))


def channel_findings(recording: Recording) -> Iterator[Finding]:
    """Check every torque and angle of a recording; where torque was computed of a drive, what the drive measured."""
    nouns = {"current": "current", "force": "force", "motor_torque": "motor torque", "motor_angle": "motor angle"}
    # beside the mask, angles count for derivatives, and torques may be anything
    inside = slice(None) if recording.mask is None else np.flatnonzero(recording.mask)
    time, others, driven = recording.time[inside], recording.q[inside], recording.driven
    rate = float((len(recording.time) - 1) / (recording.time[-1] - recording.time[0]))
    for k, joint in enumerate(recording.joint_names):
        angle = Channel(recording.time, rate, recording.q[:, k].copy(), recording.q, joint, "angle", "rad")
        yield from (*frozen_angle(angle), *repeated_values(angle))
        if recording.tau is None or not driven[k] or len(time) < 2:
            continue
        torque = Channel(time, rate, recording.tau[inside, k].copy(), others, joint, "torque", "N·m")
        if joint in recording.computed:
            read = ((name, getattr(recording, name)) for name in nouns)
            measured = ((name, x[inside, k]) for name, x in read if x is not None and not np.isnan(x[inside, k]).any())
            for name, x in list(measured)[:1]:
                torque = replace(torque, x=x, noun=nouns[name], unit=UNITS[name])
        for check in (saturation, frozen_torque, repeated_values, outliers):
            yield from check(torque)


def saturation(channel: Channel) -> Iterator[Finding]:
    """Find torques that stop at a rail."""
    # A peak of a quantised signal also stays at one value, but the signal comes there in steps of one quantum.
    # A clipped signal arrives at full slope.
    x, tolerance = channel.x, 1e-9 * float(np.ptp(channel.x))
    start, length = channel.runs(tolerance)
    value = x[start]
    for rail in (float(x.max()), float(x.min())):
        at_rail = np.abs(value - rail) <= tolerance
        count = int(length[at_rail].sum())
        if count < max(5, 0.002 * len(x)):
            continue
        usual, step = float(np.median(length)), quantum(x)
        places = np.flatnonzero(at_rail & (length >= max(2, 1.5 * usual)))
        inner = places[(places > 0) & (places < len(start) - 1)]
        if count < 3.0 * usual or not len(inner):
            continue
        entry = np.abs(value[inner] - value[inner - 1])
        leave = np.abs(value[inner + 1] - value[inner])
        if float(np.median(np.maximum(entry, leave))) <= 1.5 * step:
            continue
        near = (np.abs(x - rail) <= 3.5 * step) & (np.abs(x - rail) > 0.5 * step)
        if count <= 5.0 * near.sum() / 3.0:  # a rail holds five times more samples than each of the three values beside
            continue
        share = count / len(x)
        message = f"{share:.1%} of the {channel.noun}s are exactly {rail:.4g} {channel.unit}: the sensor or amplifier"
        message = f"{message} is at its limit, and the true {channel.noun} is larger"
        remedy = "record a slower or smaller motion, raise the limit, or cut out these segments"
        severity: Severity = "error" if share > 0.05 else "warning"
        yield Finding("saturation", channel.joint, rail, channel.unit, severity, message, remedy)


def frozen_torque(channel: Channel) -> Iterator[Finding]:
    """Find times in which a torque keeps one value although the leg moves."""
    every, q = channel.long_runs(FROZEN_TORQUE), channel.others
    moving = [run for run in every if (np.ptp(q[slice(*run)], axis=0) > 0.05 * np.ptp(q, axis=0)).any()]
    # A coarse sensor leaves a value by its smallest step, and one that was frozen by a jump; where some values are left
    # by a step after as long a time, a jump is two steps at once
    jumps = {run for run in moving if run[1] == len(channel.x) or channel.steps[run[1] - 1] > 1.5 * quantum(channel.x)}
    usual = max((stop - first for first, stop in {*moving} - jumps), default=0)
    yield from _frozen(channel, [run for run in moving if run in jumps and run[1] - run[0] > usual])


def frozen_angle(channel: Channel) -> Iterator[Finding]:
    """Find times in which an angle keeps one value although the joint cannot have come to rest."""
    # A joint at rest slows down before and speeds up afterwards. A channel that freezes stops at full speed, or jumps
    # when it comes back.
    steps = channel.steps
    long = channel.long_runs(0.5)
    if not long or not steps.any():
        return
    usual, large = float(np.sqrt(np.mean(steps**2))), float(np.quantile(steps, 0.99))
    frozen = []
    for first, stop in long:
        before, after = steps[max(0, first - 6) : max(0, first - 1)], steps[stop : stop + 5]
        jump = steps[stop - 1] if stop < len(channel.x) else 0.0
        # a joint that sticks stops suddenly, too, but does not start at full speed
        sudden = [float(near.mean()) > 0.4 * usual for near in (before, after) if len(near) > 2]
        if jump > 1.5 * large or (sudden and all(sudden)):
            frozen.append((first, stop))
    yield from _frozen(channel, frozen)


def _frozen(channel: Channel, runs: Sequence[tuple[int, int]]) -> Iterator[Finding]:
    """Describe the times in which a channel is frozen, if there are any."""
    if not runs:
        return
    count = sum(stop - first for first, stop in runs)
    first, stop = max(runs, key=lambda run: run[1] - run[0])
    start, end = channel.time[first], channel.time[stop - 1]
    more = f" and {len(runs) - 1} other times" if len(runs) > 1 else ""
    share = count / len(channel.x)
    where = f"from {start:.3f} s to {end:.3f} s{more} ({share:.1%} of {channel.time[-1] - channel.time[0]:.3g} s)"
    message = f"the {channel.noun} keeps one value {where} although the leg moves: the channel froze"
    remedy = "use the part of the log before or after it (Recording.between, --start, --stop)"
    severity: Severity = "error" if share > 0.02 else "warning"
    yield Finding("stuck-channel", channel.joint, count / channel.rate, "s", severity, message, remedy)


def repeated_values(channel: Channel) -> Iterator[Finding]:
    """Find torques and angles that repeat the sample before, as those of a slower bus do."""
    steps, x = channel.steps, channel.x
    moved, repeated = steps[steps > 0.0], float(np.mean(steps == 0.0))
    smallest = quantum(x) if repeated >= 0.01 else 0.0  # no smaller share counts
    # steps of no quantum come by chance as often as those of one, up or down
    least = max(0.01, 1.5 * float(np.mean((steps > 0.0) & (steps < 1.5 * smallest))))
    if repeated < least or len(moved) < 5:
        return
    counts, share_of = ~np.isin(x[1:], (x.max(), x.min())), 1.0  # not at a rail
    for run in channel.long_runs(FROZEN_TORQUE):
        counts[slice(*run)] = False
    if channel.noun == "angle":  # a joint comes to rest, and turns round, by small steps
        start, length = channel.runs()
        ends, large = np.concatenate([[0.0], steps[start[1:] - 1], [0.0]]), 0.5 * float(np.median(moved))
        counts &= np.repeat(np.minimum(ends[1:], ends[:-1]) > max(3.5 * smallest, large), length)[1:]
        share_of = float(np.mean(counts))
    elif smallest > 0.2 * float(np.median(moved)):
        return
    share = float(np.mean((steps == 0.0) & counts)) / max(share_of, 0.1)
    if share >= least:
        message = f"{share:.1%} of the {channel.noun}s repeat the sample before, which makes them late"
        message += f": the sensor has {(1.0 - share) * channel.rate:.3g} new values a second"
        remedy = "log at the rate of the sensor, or with the time stamps of its own messages"
        yield Finding("stale-samples", channel.joint, share, "1", "warning", message, remedy)


def outliers(channel: Channel) -> Iterator[Finding]:
    """Find dropouts to zero and spikes of the torque."""
    # An outlier is 12 times the noise of the torque, and 0.4 times its standard deviation. A spike is also 5 times
    # larger than 95 % of all deviations: noise that grows with speed has none.
    x = channel.x
    middle = scipy.ndimage.median_filter(x, 5, mode="constant")
    apart, least = x - middle, 0.4 * float(np.std(middle))
    deviation = np.abs(apart)
    odd: NDArray[np.bool_] = deviation > least
    odd[:2] = odd[-2:] = False
    if odd.any():
        odd &= deviation > 12.0 * robust_std(apart - np.median(apart))
    if not odd.any():
        return
    odd &= deviation > 12.0 * quantum(x)
    if (odd & (x == 0.0)).sum() >= max(3, 0.002 * len(x)):
        share = float(np.mean((x == 0.0) & (np.abs(middle) > 0.0)))
        message = f"the {channel.noun} drops to exactly 0 in {share:.1%} of the samples: lost messages became zeros"
        remedy = "remove these samples, or write NaN where there is no value and interpolate short gaps"
        yield Finding("dropout", channel.joint, share, "1", "error", message, remedy)
        odd &= x != 0.0
    odd &= deviation > 5.0 * float(np.quantile(deviation, 0.95))
    ends = np.pad(x, 3, mode="edge")  # a joint that jerks rings: samples on both sides of a peak have a part of it
    level = 0.5 * (ends[:-6] + ends[6:])
    size, beside = x - level, [neighbour - level for neighbour in (ends[2:-4], ends[4:-2])]
    odd &= np.minimum(*(size * part for part in beside)) < 0.3 * size**2
    if odd.sum() >= max(4, 0.002 * len(x)):
        share, lean = float(np.mean(odd)), abs(float(np.mean(np.sign(apart[odd]))))
        side = ", nearly all to one side, which looks like an offset" if lean > 0.5 else ""
        height = f"{np.median(deviation[odd]):.3g} {channel.unit}"
        message = f"{share:.1%} of the {channel.noun}s are spikes of {height}{side}"
        remedy = "remove them at their source, or identify with the estimator huber"
        yield Finding("spikes", channel.joint, share, "1", "warning", message, remedy)


def quantum(x: FloatArray) -> float:
    """Smallest step between different values of a signal; 0 for a constant one."""
    values = np.unique(x)
    steps = np.diff(values)
    steps = steps[steps > 1e-9 * float(values[-1] - values[0])]  # smaller ones are rounding
    return float(steps.min()) if len(steps) else 0.0
