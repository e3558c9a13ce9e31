"""Checks of single channels, which need no model: rails, frozen and repeated values, dropouts, spikes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding
from exoid.signals import Recording
from exoid.signals.noise_size import robust_std
from exoid.signals.quantities import UNITS

from .runs import Runs, median_of_five, quantum

RAIL_SHARE = 0.002
"""Samples at an extreme that make it a rail: at least this share of them, and at least :data:`FEWEST`."""

FEWEST = 5

STEEP = 1.5
"""A clipped signal reaches its rail in steps of more than so many quanta."""

PILE = 5.0
"""A rail holds so many times more samples than each of the three values next to it."""

FROZEN_ANGLE, FROZEN_TORQUE = 0.5, 0.15
"""Shortest time for which a channel that moves has to stand still to count as frozen [s]."""

LONG_RUN = 8.0
"""A frozen channel stands still so many times longer than in 99 % of its other runs."""

SPEED_SHARE = 0.4
"""A joint that freezes while moving faster than this share of its RMS speed has not come to rest."""

JUMP = 1.5
"""An angle that comes back jumps by so many times the 99 % quantile of its steps."""

FINE = 0.2
"""A signal whose quantum is below this part of its median step repeats no value by chance."""

STALE_SHARE = 0.01
DROPOUT_SHARE = 0.002
SPIKE_SHARE = 0.002
SPIKE = 12.0
"""A spike is so many times the noise of the torque, and at least :data:`SPIKE_PART` of its standard deviation."""
SPIKE_PART = 0.4
ISOLATED = 5.0
"""A spike is also so many times larger than 95 % of all deviations: noise that grows with speed has none."""

DRIVE_NOUNS = {"current": "current", "force": "force", "motor_torque": "motor torque", "motor_angle": "motor angle"}
"""Word for each quantity that a drive measures."""


@dataclass(frozen=True, eq=False)
class Channel:
    """One quantity of one joint."""

    time: FloatArray  # stamps [s], (N,)
    x: FloatArray  # signal, (N,)
    others: FloatArray  # all angles [rad], (N, n), to see whether the leg moves
    joint: str  # name of the joint
    parameters: tuple[str, ...]  # parameters that act on the joint
    recording: str  # name of the recording
    noun: str = "torque"  # word for the quantity
    unit: str = "N·m"  # its unit

    @cached_property
    def steps(self) -> FloatArray:
        """Absolute change from sample to sample, (N − 1,)."""
        return np.asarray(np.abs(np.diff(self.x)))

    @cached_property
    def runs(self) -> Runs:
        """Runs of equal samples."""
        return Runs.of(self.x)


def channel_findings(recording: Recording, acting: Mapping[str, Sequence[str]], name: str = "") -> Iterator[Finding]:
    """Check every torque and angle of a recording; where torque was computed of a drive, what the drive measured."""
    driven = recording.driven
    angles, torques = (None if x is None else np.ascontiguousarray(x.T) for x in (recording.q, recording.tau))
    assert angles is not None
    for k, joint in enumerate(recording.joint_names):
        names = tuple(acting.get(joint, ()))
        angle = Channel(recording.time, angles[k], recording.q, joint, names, name)
        yield from frozen_angle(angle)
        if torques is None or not driven[k]:
            continue
        torque = replace(angle, x=torques[k])
        if joint in recording.computed:
            torque = _of_drive(torque, recording, k)
        yield from saturation(torque)
        yield from frozen_torque(torque)
        yield from repeated_values(torque)
        yield from outliers(torque)


def _of_drive(channel: Channel, recording: Recording, k: int) -> Channel:
    """Channel of what the drive of a joint measured, of which its torque was computed."""
    for quantity, noun in DRIVE_NOUNS.items():
        values = getattr(recording, quantity)
        if values is not None and not np.isnan(values[:, k]).any():
            return replace(channel, x=values[:, k], noun=noun, unit=UNITS[quantity])
    return channel


def saturation(channel: Channel) -> Iterator[Finding]:
    """Find torques that stop at a rail."""
    # A peak of a quantised signal also stays at one value, but the signal comes there in steps of one quantum.
    # A clipped signal arrives at full slope.
    x, tolerance = channel.x, 1e-9 * float(np.ptp(channel.x))
    if channel.steps.min() > tolerance:  # no value lasts
        return
    runs = Runs.of(x, tolerance)
    if len(runs.start) < 3:
        return
    usual = float(np.median(runs.length))
    for rail in (float(x.max()), float(x.min())):
        at_rail = np.abs(runs.value - rail) <= tolerance
        count = int(runs.length[at_rail].sum())
        if count < max(FEWEST, RAIL_SHARE * len(x), 3.0 * usual):
            continue
        places = np.flatnonzero(at_rail & (runs.length >= max(2, 1.5 * usual)))
        inner = places[(places > 0) & (places < len(runs.start) - 1)]
        if not len(inner):
            continue
        entry = np.abs(runs.value[inner] - runs.value[inner - 1])
        leave = np.abs(runs.value[inner + 1] - runs.value[inner])
        step = quantum(x)
        if float(np.median(np.maximum(entry, leave))) <= STEEP * step:
            continue
        near = (np.abs(x - rail) <= 3.5 * step) & (np.abs(x - rail) > 0.5 * step)
        if count <= PILE * near.sum() / 3.0:
            continue
        share = count / len(x)
        yield Finding(
            "saturation",
            channel.joint,
            rail,
            channel.unit,
            "error" if share > 0.05 else "warning",
            f"{share:.1%} of the {channel.noun}s are exactly {rail:.4g} {channel.unit}: the sensor or the amplifier is "
            f"at its limit, and the true {channel.noun} is larger",
            "record a slower or smaller motion, raise the limit, or cut out these segments",
            parameters=channel.parameters,
            recording=channel.recording,
        )


def frozen_torque(channel: Channel) -> Iterator[Finding]:
    """Find times in which a torque keeps one value although the leg moves."""
    spans = _long_runs(channel, FROZEN_TORQUE)
    if not spans:
        return
    runs = channel.runs
    moving = [k for k in spans if _moves(channel.others[runs.start[k] : runs.stop[k]], channel.others)]
    yield from _frozen(channel, moving, channel.noun)


def frozen_angle(channel: Channel) -> Iterator[Finding]:
    """Find times in which an angle keeps one value although the joint cannot have come to rest."""
    # A joint at rest slows down before and speeds up afterwards. A channel that freezes stops at full speed, or jumps
    # when it comes back.
    x, steps = channel.x, channel.steps
    long = _long_runs(channel, FROZEN_ANGLE)
    if not long or not steps.any():
        return
    runs = channel.runs
    usual, large = float(np.sqrt(np.mean(steps**2))), float(np.quantile(steps, 0.99))
    frozen = []
    for k in long:
        first, stop = int(runs.start[k]), int(runs.stop[k])
        before, after = steps[max(0, first - 6) : max(0, first - 1)], steps[stop : stop + 5]
        jump = steps[stop - 1] if stop < len(x) else 0.0
        sudden = any(len(near) > 2 and float(near.mean()) > SPEED_SHARE * usual for near in (before, after))
        if jump > JUMP * large or sudden:
            frozen.append(k)
    yield from _frozen(channel, frozen, "angle")


def repeated_values(channel: Channel) -> Iterator[Finding]:
    """Find torques that repeat the sample before, as those of a slower bus do."""
    steps = channel.steps
    if np.mean(steps == 0.0) < STALE_SHARE:
        return
    moved = steps[steps > 0.0]
    if len(moved) < FEWEST or quantum(channel.x) > FINE * float(np.median(moved)):
        return
    runs = channel.runs
    inner = np.isin(channel.x[1:], (channel.x.max(), channel.x.min()))
    long = np.zeros(len(steps), dtype=np.bool_)
    for k in _long_runs(channel, FROZEN_TORQUE):
        long[runs.start[k] : runs.stop[k]] = True
    share = float(np.mean((steps == 0.0) & ~inner & ~long))
    if share < STALE_SHARE:
        return
    fresh = (1.0 - share) * _rate(channel.time)
    yield Finding(
        "stale-samples",
        channel.joint,
        share,
        "1",
        "warning",
        f"{share:.1%} of the {channel.noun}s repeat the sample before: the log asks faster than the sensor answers "
        f"(about {fresh:.3g} new values a second), so that {channel.noun} is late by up to a sample of the sensor",
        "log at the rate of the sensor, or with the time stamps of its own messages",
        parameters=channel.parameters,
        recording=channel.recording,
    )


def outliers(channel: Channel) -> Iterator[Finding]:
    """Find dropouts to zero and spikes of the torque."""
    x = channel.x
    middle = median_of_five(x)
    apart, least = x - middle, SPIKE_PART * float(np.std(middle))
    deviation = np.abs(apart)
    if deviation.max() <= least:
        return
    odd: NDArray[np.bool_] = deviation > max(SPIKE * robust_std(apart - np.median(apart)), least)
    odd[:2] = odd[-2:] = False
    if not odd.any():
        return
    odd &= deviation > SPIKE * quantum(x)
    zero = odd & (x == 0.0)
    if zero.sum() >= max(3, DROPOUT_SHARE * len(x)):
        share = float(np.mean((x == 0.0) & (np.abs(middle) > 0.0)))
        yield Finding(
            "dropout",
            channel.joint,
            share,
            "1",
            "error",
            f"the {channel.noun} drops to exactly 0 in {share:.1%} of the samples: messages were lost and filled with "
            "zeros",
            "remove these samples, or write NaN where there is no value and interpolate short gaps",
            parameters=channel.parameters,
            recording=channel.recording,
        )
        odd &= x != 0.0
    odd &= deviation > ISOLATED * float(np.quantile(deviation, 0.95))
    share = float(np.mean(odd))
    if odd.sum() >= max(4, SPIKE_SHARE * len(x)):
        lean = float(np.mean(np.sign(apart[odd])))
        yield Finding(
            "spikes",
            channel.joint,
            share,
            "1",
            "warning",
            f"{share:.1%} of the {channel.noun}s are spikes of {float(np.median(deviation[odd])):.3g} "
            + channel.unit
            + (", nearly all to one side, which looks like an offset" if abs(lean) > 0.5 else ""),
            "remove them at their source, or identify with the estimator huber",
            parameters=channel.parameters,
            recording=channel.recording,
        )


def _long_runs(channel: Channel, shortest: float) -> list[int]:
    """Runs that last for a while, and much longer than usual."""
    least = max(10.0, shortest * _rate(channel.time))
    if np.count_nonzero(channel.steps == 0.0) < least - 1.0:
        return []
    runs = channel.runs
    long = runs.length >= least
    if not long.any():
        return []
    others = runs.length[~long]
    usual = float(np.quantile(others, 0.99)) if len(others) else 1.0
    return [int(k) for k in np.flatnonzero(long & (runs.length >= LONG_RUN * usual))]


def _moves(part: FloatArray, whole: FloatArray) -> bool:
    """Whether some joint moves in a part of a recording."""
    return bool((np.ptp(part, axis=0) > 0.05 * np.ptp(whole, axis=0)).any())


def _rate(time: FloatArray) -> float:
    return float((len(time) - 1) / (time[-1] - time[0]))


def _frozen(channel: Channel, places: Sequence[int], quantity: str) -> Iterator[Finding]:
    """Describe the times in which a channel is frozen."""
    if not places:
        return
    runs = channel.runs
    count = int(sum(runs.length[k] for k in places))
    worst = max(places, key=lambda k: runs.length[k])
    start, stop = channel.time[runs.start[worst]], channel.time[runs.stop[worst] - 1]
    more = f" and {len(places) - 1} other times" if len(places) > 1 else ""
    share = count / len(channel.x)
    yield Finding(
        "stuck-channel",
        channel.joint,
        count / _rate(channel.time),
        "s",
        "error" if share > 0.02 else "warning",
        f"the {quantity} keeps one value from {start:.3f} s to {stop:.3f} s{more} ({share:.1%} of the log) although "
        "the leg moves: the channel froze",
        "use the part of the log before or after it (Recording.between, --start, --stop)",
        parameters=channel.parameters,
        recording=channel.recording,
    )
