"""Checks of angles and time: missing samples, stamps that jitter, angles that wrap, jump, or leave loops open."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray
from exoid.estimate.finding import Finding
from exoid.leg.closure import Closure
from exoid.leg.leg_data import without_side
from exoid.signals import Recording
from exoid.signals.cutoff import robust_std, white_noise

from .channels import quantum

WINDOW = 4  # samples on each side of an interval, through which lines are laid
SPLIT = "use the stamps of the sensors, or split the log there and pass the parts (Recording.between)"


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


def angle_jumps(recording: Recording) -> Iterator[Finding]:
    """Find angles that jump and stay there: encoders that slip, or whose zero is set anew."""
    # Between two samples an angle passes by what it does before and after: stops, impacts and friction keep to that.
    steps, width = np.diff(np.ascontiguousarray(recording.q.T)), 2 * WINDOW + 1
    ends = np.pad(steps, ((0, 0), (WINDOW, WINDOW)), "edge")
    beside = [ends[:, k : k + steps.shape[1]] for k in range(width) if k != WINDOW]
    low, high = reduce(np.minimum, beside), reduce(np.maximum, beside)
    beyond = steps - np.clip(steps, low, high)
    size, usual = np.abs(beyond), high - low
    if (size > 4.0 * usual).any():  # quanta take longer to find; between samples that were rounded, roughness has them
        rough = np.sqrt(12.0) * white_noise(recording.q)
        usual += np.maximum([quantum(x) for x in recording.q.T], rough)[:, None]
    if not (size > 4.0 * usual).any():
        return
    ratio = size / (usual + np.quantile(size, 0.98, axis=1, keepdims=True))
    total = width * scipy.ndimage.uniform_filter1d(beyond, width)
    # an impact, and samples that are missing, show at other joints, too
    alone = (scipy.ndimage.maximum_filter1d(ratio, width) > 1.25).sum(axis=0) == 1
    jumps = alone & (ratio > 4.0) & (np.abs(total) > 0.5 * size) & (np.abs(steps) < np.pi)
    jumps &= size > 0.1 * np.max(size * jumps, axis=1, keepdims=True)  # the rest are counts of the encoder
    for place, joint in enumerate(recording.joint_names):
        if count := int(jumps[place].sum()):
            worst = int(np.argmax(size[place] * jumps[place]))
            jump = float(beyond[place, worst])
            most = f"by {1e3 * jump:.3g} mrad at {recording.time[worst + 1]:.3f} s"
            message = f"the angle jumps {count} times, most {most}, and stays there"
            remedy = "mend the encoder, and split the log there (Recording.between)"
            yield Finding("angle-jump", joint, jump, "rad", "warning", message, remedy)


def missing_samples(recording: Recording) -> Iterator[Finding]:
    """Find places where samples are missing although the time stamps run on."""
    # Lines through the four samples on each side of an interval meet in its middle, but for noise and a change
    # of the acceleration. Where samples are missing, every angle jumps there by its velocity times the time
    # that is missing: the jumps of all joints together give that time, with its standard deviation.
    if len(recording) < 8 * WINDOW:
        return
    rate = recording.sample_rate
    q = np.ascontiguousarray(recording.q.T)
    k = np.arange(WINDOW) - 0.5 * (WINDOW - 1)
    slope, level = k / (k @ k), np.full(WINDOW, 1.0 / WINDOW)
    windows = np.lib.stride_tricks.sliding_window_view(q, WINDOW, axis=1)
    levels, slopes = windows @ level, windows @ slope
    behind, ahead = slopes[:, :-WINDOW], slopes[:, WINDOW:]
    jump = levels[:, WINDOW:] - levels[:, :-WINDOW] - 0.5 * WINDOW * (ahead + behind)
    velocity = 0.5 * (ahead + behind) * rate
    steps = np.diff(q, axis=1)
    # Where a leg turns back or meets the ground, angles jump by at most twice what their velocities change in a sample
    usual = np.maximum(np.sqrt(np.mean((ahead - behind) ** 2, axis=1, keepdims=True)), 1e-300)
    beyond = np.max(np.abs(jump) / usual, axis=0) > 2.0 * np.max(np.abs(ahead - behind) / usual, axis=0)
    beyond &= np.asarray((np.abs(steps) < np.pi).all(axis=0))[WINDOW - 1 : -WINDOW + 1]  # else an angle wraps
    if not beyond.any():
        return
    seams = np.abs(jump) * beyond  # rows of other times: jumps of five times the way of a fast joint in a sample
    seams *= (seams > 5.0 * np.quantile(np.abs(slopes), 0.99, axis=1, keepdims=True)).sum(axis=0) > 1
    # A joint that stands, sticks or is frozen on one side of an interval says nothing of the time that passes there.
    rests, count = steps == 0.0, len(recording) - WINDOW + 1
    still = np.logical_and.reduce([rests[:, k : k + count] for k in range(WINDOW - 1)])
    moves = ~(still[:, :-WINDOW] | still[:, WINDOW:])
    moving = (x[here] for x, here in zip(jump, moves, strict=True))
    noise = np.array([robust_std(x - np.median(x)) if x.size else 0.0 for x in moving])
    jump, velocity = jump * moves, velocity * moves
    floor = 1e-3 * np.sqrt(np.mean(velocity**2, axis=1)) / rate  # exact motions have no noise
    weight = 1.0 / np.maximum(noise, np.maximum(floor, 1e-12)) ** 2
    information = weight @ velocity**2
    gap = weight @ (velocity * jump) / np.maximum(information, 1e-300)
    size = gap * np.sqrt(information)
    # 9 standard deviations, and most of an interval, and 5 ms: stamps of real logs jitter
    odd: BoolArray = (size > 9.0) & (gap > max(0.7 / rate, 5e-3))
    odd &= beyond & (weight @ (jump - gap * velocity) ** 2 < 0.3 * size**2)
    peaks, _ = scipy.signal.find_peaks(np.pad(size * odd, 1), distance=2 * WINDOW + 1)  # of each group of neighbours
    if not len(peaks):
        if seams.any():
            most, when = float(seams.max()), recording.time[int(seams.max(axis=0).argmax()) + WINDOW]
            message = f"at {when:.3f} s angles jump at once, by up to {most:.3g} rad: rows are lost, or runs joined"
            yield Finding("missing-samples", "", most, "rad", "error", message, SPLIT)
        return
    places = (peaks - 1).tolist()
    worst = max(places, key=lambda k: gap[k])
    lost = float(sum(gap[k] for k in places))
    error = max(2.0 / float(np.sqrt(information[worst])), 0.5 / rate)  # no finer than half an interval
    gaps = f"{len(places)} gap{'s' if len(places) > 1 else ''} although the time stamps run on"
    when = f"{recording.time[worst + WINDOW - 1]:.3f} s"
    message = f"{gaps}: at {when} all angles jump by what they travel in {1e3 * gap[worst]:.3g} ms"
    interval = (max(0.0, lost - error), lost + error) if len(places) == 1 else None
    yield Finding("missing-samples", "", lost, "s", "warning", message, SPLIT, interval)


def stamp_jitter(recording: Recording) -> Iterator[Finding]:
    """Find stamps of arrival: angles that are smooth from sample to sample, and rough over their uneven stamps."""
    if recording.is_uniform:
        return
    step = max(1, int(recording.sample_rate / 100.0))  # of fast logs angles change by less than a count a sample
    rough, smooth = (white_noise(q[::step]) for q in (recording.resampled().q, recording.q))
    if (rough > 2.0 * smooth).any() and not (smooth > 1.2 * rough).any():
        jitter = float(robust_std(np.diff(recording.time, 2))) / np.sqrt(6.0)
        message = f"stamps jitter by {1e3 * jitter:.3g} ms, and angles are smooth without: they are times of arrival"
        remedy = "log the stamps of the sensors, or even ones (numpy.linspace) where no sample is missing"
        yield Finding("stamp-jitter", "", jitter, "s", "warning", message, remedy)


def loop_gaps(closure: Closure, recording: Recording) -> Iterator[Finding]:
    """Find loops that measured angles of dependent joints leave open; those of the others follow from the loops."""
    names = list(closure.model.names)[1:]
    used = names if {*closure.joint_names} <= {*recording.joint_names} else without_side(names)
    places = [recording.joint_names.index(name) if name in recording.joint_names else -1 for name in used]
    measured = [j for j in closure.dependent if places[j] >= 0]
    if not measured:
        return
    q = recording.q[:: 1 + len(recording) // 500]  # spread evenly
    poses, closed = closure.solve(q[:, [places[j] for j in closure.independent]])
    poses[:, measured] = q[:, [places[j] for j in measured]]
    gaps = closure.gap(poses[closed])
    for loop, gap in zip(closure.loops.loops, gaps.T, strict=True):
        size, scatter = float(np.sqrt(np.mean(gap**2))), float(np.std(gap))
        if size > 1e-3:  # [m]; encoders and play leave less
            message = (
                f"loop {loop.name} is open by {1e3 * size:.2g} mm at the measured angles of "
                f"{', '.join(names[j] for j in measured)} ({1e3 * scatter:.1g} mm of it changes with the pose)"
            )
            remedy = "measure the points of the loop, and the zeros of these encoders; what changes may be play"
            yield Finding("loop-gap", "", size, "m", "warning", message, remedy)
