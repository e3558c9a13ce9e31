"""From recordings to the rows of the least-squares problem, as many as are not redundant."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError, NotIdentifiableError, UnreadableInputError
from exoid.signals import ParallelFilter, Poses, Preparation, Recording
from exoid.signals.filters.reversals import around_stops, reversal_pulses, without_reversals
from exoid.signals.moving_base import base_during

from .model import MotionSamples, RegressorModel
from .row_data import Rows, TakenOut

BLOCK = 16384
"""Least samples of a block, in which reversals are taken out by themselves."""

REACHES = 8.0
"""Least length of a block, over the reach of the filter."""

BLOCKS = 12
"""Largest number of blocks whose regressor is formed at once, times joints; where rows are decimated."""


def rate_class(time: FloatArray) -> int:
    """Logarithm of the sampling interval to base 1.1, rounded."""
    return 0 if len(time) < 2 else round(math.log(time[1] - time[0]) / math.log(1.1))


class Prepared(NamedTuple):
    """A recording, or poses, ready to become rows: arrays of all samples."""

    time: FloatArray  # [s], (N,)
    motion: MotionSamples  # motion from which the columns are formed
    # measured torque less that of payloads [N·m], (N, n), filtered unless by `parallel`; zero at joints without
    # torque or payload
    tau: FloatArray
    usable: NDArray[np.bool_]  # mask of samples of each joint that may be fitted, (N, n)
    row_joints: tuple[int, ...]  # joint of each row of the equation, (n,); −1 for a row of no joint
    rows: range  # samples that become rows, evenly spaced, from the first to the last that counts
    # mask of samples that count: not affected by the ends of the record, and in its segments, (N,)
    inside: NDArray[np.bool_]
    independent_fraction: float = 1.0  # share of the rows that carry independent noise
    # filter that columns and torque still have to pass; None for none. Samples that do not count are zero on
    # both sides of the equation before they pass it
    parallel: ParallelFilter | None = None
    reach: int = 0  # samples beside a stretch that its filtered columns draw on
    # samples of pulses of unknown friction at the reversals of each joint, see
    # `exoid.signals.filters.reversal_pulses`; None to take reversals as they are
    reversals: tuple[NDArray[np.intp], ...] | None = None
    # known torque that was taken from the measured one: that of payloads, less that of measured wrenches [N·m], (N, R);
    # None for none
    known: FloatArray | None = None

    @property
    def block(self) -> int:
        """Number of rows of a block."""
        return -(-max(BLOCK, int(REACHES * self.reach)) // self.rows.step)

    def stretches(self) -> Iterator[range]:
        """Cut the rows into stretches of whole blocks that are worked on at once: more where rows are few."""
        count = self.block * max(1, min(BLOCKS // self.tau.shape[1], self.rows.step))
        return (self.rows[start : start + count] for start in range(0, len(self.rows), count))


def prepare(
    model: RegressorModel, data: Recording | Poses, preparation: Preparation, *, every: bool = False, stops: bool = True
) -> Prepared:
    """Derive kinematics, for every row or those that are not redundant; stops of joints can be taken out of these."""
    data = model.select(data)
    if isinstance(data, Poses):
        still, count = np.zeros_like(data.q), len(data)
        motion = model.motion(data.q, still, still, data.torso, data.payloads)
        tau = data.tau if motion.payload is None else data.tau - motion.payload
        usable = np.ones(tau.shape, dtype=np.bool_)
        time = np.arange(count, dtype=np.float64)
        return Prepared(time, motion, tau, usable, model.row_joints, range(count), usable[:, 0], known=motion.payload)
    recording = data.resampled()
    if recording.tau is None:
        raise _without_torque(recording)
    rate = recording.sample_rate
    q, v, a, valid = preparation.kinematics(recording)
    parallel, inside = preparation.parallel(rate), np.zeros(len(recording), dtype=np.bool_)
    inside[valid] = True if recording.mask is None else recording.mask[valid]
    if not inside.any():
        raise NotIdentifiableError(
            f"no sample counts between the first {valid.start} and the last {len(recording) - valid.stop}, in which "
            "the ends of the recording affect the acceleration",
            where=recording.file_name,
            remedy="record longer before and after them, or choose a higher cut-off",
        )
    counted = np.flatnonzero(inside)
    rows = range(int(counted[0]), int(counted[-1]) + 1)
    stride = 1 if parallel is None or every else parallel.stride
    slow = None if parallel is None or every or not stops else model.reversing(v)
    computed = np.isin(recording.joint_names, recording.computed) if recording.computed else None
    base = recording.torso if recording.base is None else base_during(recording, preparation)
    try:
        motion = model.motion(q, v, a, base, recording.payloads, computed)
        if recording.wrenches:
            share = -model.row_torque(np.zeros_like(q), motion, recording.wrenches)
            share = preparation.filter(share, rate) if parallel is None else share
            motion = motion._replace(payload=share if motion.payload is None else motion.payload + share)
        tau = _row_torque(model, recording, motion, preparation)
    except ExoidError as error:
        raise error if error.where else error.within(recording.file_name) from None
    # joint by joint, as the other masks
    counting = np.logical_and.outer(model.measured_rows(recording.measured), inside).T
    pulses = None
    if parallel is not None and slow is not None:
        unknown = around_stops(slow, parallel).T & counting.T  # friction, where a torque was measured and counts
        pulses = tuple(reversal_pulses(of_row, parallel) for of_row in unknown)
    return Prepared(
        recording.time,
        motion,
        tau,
        model.usable(v) & counting,
        model.row_joints,
        rows[(len(rows) - 1) % stride // 2 :: stride],
        inside,
        min(1.0, preparation.independent_fraction(rate) * stride),
        parallel,
        0 if parallel is None else parallel.reach,
        pulses,
        motion.payload,
    )


def _row_torque(
    model: RegressorModel, recording: Recording, motion: MotionSamples, preparation: Preparation
) -> FloatArray:
    """Measured torque less that of payloads, filtered unless by a parallel filter: that of :class:`Prepared`."""
    assert recording.tau is not None
    rate, measured = recording.sample_rate, recording.measured
    tau = recording.tau if measured.all() else np.where(measured, recording.tau, 0.0)
    tau = model.row_torque(tau, motion, {})
    tau = preparation.filter(tau, rate) if preparation.parallel(rate) is None else tau
    return tau if motion.payload is None else tau - motion.payload


def other_torque(model: RegressorModel, prepared: Prepared, data: Recording, preparation: Preparation) -> Prepared:
    """Leave of a recording that is ready what another torque of the same motion, and of the same joints, has more."""
    torque = _row_torque(model, model.select(data).resampled(), prepared.motion, preparation)
    return prepared._replace(tau=torque - prepared.tau)


def with_torque(rows: Rows, more: Prepared, stretch: range) -> Rows:
    """Change the torque of a stretch of rows; they are linear in it, and their columns stay. See `other_torque`."""
    around = slice(max(0, stretch[0] - more.reach), stretch[-1] + 1 + more.reach)
    inside = range(stretch[0] - around.start, stretch[-1] + 1 - around.start, stretch.step)
    tau, reversals = more.tau[around].T, rows.reversals
    if more.parallel is None:
        tau = tau[:, slice(inside.start, inside.stop, inside.step)]
    else:
        tau = more.parallel.among_zeros(tau, inside, more.inside[around])
        if more.reversals is not None:
            signals = tau[:, np.newaxis]
            parts = without_reversals([*signals], more.reversals, stretch, more.parallel, more.block)
            tau = np.vstack([left for left, _, _ in parts])
            both = zip(reversals, parts, strict=True)
            tables = (
                (each, np.column_stack([each.table[:, :-1], each.table[:, -1] + x[0]])) for each, (_, x, _) in both
            )
            reversals = tuple(each._replace(table=table) for each, table in tables)
    return rows._replace(tau=rows.tau + tau.T, reversals=reversals)


def _without_torque(recording: Recording) -> ExoidError:
    """Make the error about a recording without any torque, which may have currents or forces."""
    where, joint = recording.file_name, recording.joint_names[0]
    for quantity, prefix, name, unit in (
        ("current", "i", "motor currents", "A"),
        ("force", "f", "forces", "N"),
        ("motor_torque", "tm", "motor torques", "N·m of the motor"),
        ("motor_angle", "qm", "motor angles", "rad"),
    ):
        if getattr(recording, quantity) is not None:
            each, scaled = "describe the drive of each joint", f"or say N·m per {unit} where it is read"
            python = f"columns={{'tau_{joint}': exoid.signals.Column('{prefix}_{joint}', scale=0.118)}}"
            return UnreadableInputError(
                f"the recording has {name} and no torque",
                where=where,
                remedy=f"{each} (actuators=, exoid.actuators), {scaled}: {python}",
                command=f"{each} (--actuators drives.toml), {scaled}, e.g. --column tau_{joint}={prefix}_{joint}:0.118",
            )
    log = f"record torques (tau_{joint}), currents (i_…), forces (f_…) or motor torques (tm_…), or map a column of them"
    what = "there is no torque, current or force in the recording: angles, commanded ones too, identify nothing"
    remedy, command = f"{log}: columns={{'tau_{joint}': '<header>'}}", f"{log}: --column tau_{joint}=HEADER"
    return UnreadableInputError(what, where=where, remedy=remedy, command=command)


def form_rows(model: RegressorModel, prepared: Prepared, stretch: range) -> Rows:
    """Form the regressor columns of a stretch of rows, and let columns and torque pass the filter."""
    # Columns are formed as far beyond both ends of the stretch as the filter reaches, so that they come out as
    # if those of the whole recording had been filtered. Samples that do not count are zero on both sides of τ =
    # W β when they pass it, which keeps the equation whatever the torque is there. Columns beyond those of the
    # parameters are torque that is known, and is taken to the other side.
    around = slice(max(0, stretch[0] - prepared.reach), stretch[-1] + 1 + prepared.reach)
    motion = prepared.motion.rows(around)
    columns, joints = model.columns(motion), prepared.tau.shape[1]
    tau = prepared.tau[around].T
    tau = tau if prepared.known is None else np.vstack([tau, prepared.known[around].T])
    inside = range(stretch[0] - around.start, stretch[-1] + 1 - around.start, stretch.step)
    taken: list[tuple[FloatArray, float]] = []
    if prepared.parallel is None:
        rows = slice(inside.start, inside.stop, inside.step)
        columns, tau = columns[..., rows], tau[:, rows]
    else:
        columns, tau = _filtered(prepared.parallel, columns, tau, model.acting, prepared.inside[around], inside)
        if prepared.reversals is not None:
            taken = _take_out_reversals(prepared, stretch, columns, tau[:joints])
    tau, known = tau[:joints], tau[joints:].T if len(tau) > joints else None
    count = model.acting.shape[1]
    W, tau = columns[:count].transpose(2, 1, 0), tau.T
    if len(columns) > count:
        tau = tau - columns[count:].sum(axis=0).T
    rows = slice(stretch.start, stretch.stop, stretch.step)
    # angle and velocity of the joint of each row; zero for a row of no joint
    q, v, of_rows = prepared.motion.q[rows], prepared.motion.v[rows], np.array(prepared.row_joints)
    if not np.array_equal(of_rows, np.arange(q.shape[1])):
        q, v = (np.where(of_rows < 0, 0.0, values[:, of_rows]) for values in (q, v))
    usable = prepared.usable[rows]
    time, fraction = prepared.time[rows], prepared.independent_fraction
    reversals = tuple(
        TakenOut(np.column_stack([part[:count].T, part[-1] - part[count:-1].sum(axis=0)]), left) for part, left in taken
    )
    return Rows(time, W, tau, q, v, usable, model.acting, fraction, reversals=reversals, known=known)


def _filtered(
    parallel: ParallelFilter,
    columns: FloatArray,
    tau: FloatArray,
    acting: NDArray[np.bool_],
    inside: NDArray[np.bool_],
    rows: range,
) -> tuple[FloatArray, FloatArray]:
    """Some rows of columns (P or more, n, N) and torques (K, N) behind the filter; what does not act stays zero."""
    known = np.ones((len(columns) - acting.shape[1], columns.shape[1]), dtype=np.bool_)
    places = np.argwhere(np.vstack([acting.T, known]))
    # filters are slow, and some parameters act on joints alike: each signal is filtered once
    distinct, twins = list[FloatArray](), []
    alike: dict[bytes, list[int]] = {}
    for signal in (*(columns[parameter, joint] for parameter, joint in places), *tau):
        candidates = alike.setdefault(signal[:: 1 + len(signal) // 8].tobytes(), [])
        twin = next((k for k in candidates if np.array_equal(distinct[k], signal)), len(distinct))
        twins.append(twin)
        if twin == len(distinct):
            candidates.append(twin)
            distinct.append(signal)
    filtered = parallel.among_zeros(distinct, rows, inside)
    out = np.zeros((*columns.shape[:2], len(rows)))
    for (parameter, joint), twin in zip(places, twins, strict=False):
        out[parameter, joint] = filtered[twin]
    return out, filtered[twins[len(places) :]]


def _take_out_reversals(
    prepared: Prepared, stretch: range, columns: FloatArray, tau: FloatArray
) -> list[tuple[FloatArray, float]]:
    """Take unknown friction out of columns (P or more, n, N) and torques (n, N): what was taken, and noise left."""
    assert prepared.parallel is not None
    assert prepared.reversals is not None
    acting = [np.flatnonzero(columns[:, joint].any(axis=1)) for joint in range(len(tau))]
    signals = [np.vstack([columns[act, joint], tau[joint]]) for joint, act in enumerate(acting)]
    found = []
    projected = without_reversals(signals, prepared.reversals, stretch, prepared.parallel, prepared.block)
    for joint, (act, (left, taken, share)) in enumerate(zip(acting, projected, strict=True)):
        columns[act, joint], tau[joint] = left[:-1], left[-1]
        table = np.zeros((len(columns) + 1, taken.shape[1]))
        table[act], table[-1] = taken[:-1], taken[-1]
        found.append((table, share))
    return found


def decimation(independent_fraction: float, count: int) -> slice:
    """Rows of so many that are kept: of m = ⌊1 / independent_fraction⌋ one, which stands for the rows around it."""
    step = max(1, int(1.0 / independent_fraction))
    return slice((count - 1 - (max(1, round(count / step)) - 1) * step) // 2, None, step)


def decimate(rows: Rows, before: int, count: int) -> Rows:
    """Keep every m-th row, see :func:`decimation`."""
    # Behind a low-pass the rows between are redundant, and what noise is left is nearly white at this pace, so that a
    # simple model describes it: at the full pace the same model would spend its order on the edge of the filter.
    every = decimation(rows.independent_fraction, count)
    if every.step == 1:
        return rows
    kept = slice((every.start - before) % every.step, None, every.step)
    fraction, stands_for = min(1.0, rows.independent_fraction * every.step), count / len(range(count)[every])
    arrays: dict[str, Any] = {name: x[kept].copy(order="K") for name, x in rows.of_samples.items()}
    return rows._replace(**arrays, independent_fraction=fraction, stands_for=stands_for)


def decimated(prepared: Prepared) -> Prepared:
    """Ask only for every m-th row of a recording, see :func:`decimate`, before any is formed."""
    every = decimation(prepared.independent_fraction, len(prepared.rows))
    fraction = min(1.0, prepared.independent_fraction * every.step)
    return prepared._replace(rows=prepared.rows[every], independent_fraction=fraction)


def chain(stretches: Sequence[Rows]) -> Rows:
    """Put stretches of one recording together."""
    if len(stretches) == 1:
        return stretches[0]
    names = stretches[0].of_samples
    arrays: dict[str, Any] = {name: np.concatenate([getattr(rows, name) for rows in stretches]) for name in names}
    # column by column, as they lie in memory
    arrays["W"] = np.concatenate([rows.W.transpose(2, 1, 0) for rows in stretches], axis=2).transpose(2, 1, 0)
    lengths = [len(rows.time) for rows in stretches]
    reversals = tuple(
        TakenOut(
            np.vstack([part.table for part in parts]), float(np.average([p.noise_left for p in parts], weights=lengths))
        )
        for parts in zip(*(rows.reversals for rows in stretches), strict=True)
    )
    return stretches[0]._replace(**arrays, reversals=reversals)
