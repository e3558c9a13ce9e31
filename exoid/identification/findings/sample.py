"""Rows of recordings with nuisance columns, as many as a check needs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.errors import ExoidError
from exoid.estimate.alternative_friction import AlternativeFriction
from exoid.estimate.motion_ranges import MotionRanges
from exoid.regression.row_data import Rows
from exoid.regression.rows import Prepared, chain, decimated, for_leg, form_rows, prepare
from exoid.signals import Poses, Preparation, Recording, Recordings, ZeroPhase
from exoid.signals.external import average
from exoid.torques import TorqueModel
from exoid.torques.payloads import payload_parameters
from exoid.torques.with_columns import WithColumns

from .arm_columns import ArmColumns
from .evidence import Evidence
from .nuisance_columns import NuisanceColumns

MOST_SAMPLES = 60_000
"""Samples of which a check forms rows; of a longer log it takes segments that are spread evenly,"""

SEGMENT = 6_000
"""so many samples each."""


RATE, PER_CUTOFF = 100.0, 12.5
"""Faster logs are averaged to at least this rate [Hz], and to so many samples in 1/cut-off."""

MOST_STORED = 20
"""Of recordings on disk a check reads so many, spread evenly."""

MOST_LOOKED_AT = 100_000
"""Samples of one recording whose channels are looked at,"""

PIECES = 10
"""in so many segments."""


class Checked(NamedTuple):
    """Torque model and data that a check works on."""

    model: TorqueModel  # torque model
    data: tuple[Recording | Poses, ...]  # recordings and poses, with the joints of the leg
    preparation: Preparation  # filter and differentiation
    fixed: FloatArray  # known values of parameters, (P,); not a number where they are free
    # moment arms of linear actuators whose force was measured, by the index of their joint
    arms: Mapping[int, ArmColumns] = MappingProxyType({})


def some_samples(model: TorqueModel, data: Sequence[Recording | Poses]) -> tuple[Recording | Poses, ...]:
    """Take at most :data:`MOST_SAMPLES` samples of some recordings, in segments spread evenly."""
    total = sum(len(one) for one in data)
    if total <= MOST_SAMPLES:
        return tuple(_even(for_leg(model, one)) for one in data)
    kept: list[Recording | Poses] = []
    places = [
        (k, start)
        for k, one in enumerate(data)
        for start in range(0, max(len(one) - SEGMENT // 2, 1), SEGMENT)
        if isinstance(one, Poses) or one.mask is None or _inner(one.mask[start : start + SEGMENT]).any()
    ]
    chosen = np.unique(np.linspace(0, len(places) - 1, MOST_SAMPLES // SEGMENT).round().astype(int))
    for place in chosen:
        k, start = places[place]
        one = data[k]
        part = one.take(slice(start, start + SEGMENT)) if isinstance(one, Poses) else one.slice(start, start + SEGMENT)
        kept.append(_even(for_leg(model, part)))
    return tuple(kept)


def _inner(mask: BoolArray) -> BoolArray:
    """All but the ends, which derivatives may spoil."""
    return mask[len(mask) // 10 : len(mask) - len(mask) // 10]


def averaged(one: Recording | Poses, preparation: Preparation) -> Recording | Poses:
    """Average neighbouring samples of a log that is much faster than its filter."""
    if not isinstance(one, Recording) or not isinstance(preparation, ZeroPhase):
        return one
    size = int(one.sample_rate / max(RATE, PER_CUTOFF * preparation.cutoff))
    if size < 2 or len(one) < 20 * size:
        return one
    count = len(one) // size * size
    means = {
        name: of_all[:count].reshape(-1, size, *of_all.shape[1:]).mean(axis=1)
        for name in ("time", "q", "v", "a", "tau", "current", "force", "motor_torque", "motor_angle", "temperature")
        if (of_all := getattr(one, name)) is not None
    }
    mask = None if one.mask is None else np.asarray(one.mask[:count].reshape(-1, size).all(axis=1))
    base = None if one.base is None else one.base.averaged(size)
    external = average({"wrenches": one.wrenches, "contacts": one.contacts}, size)
    return replace(one, **means, mask=mask, base=base, **external)


def few_of(data: Sequence[Recording | Poses]) -> Sequence[Recording | Poses]:
    """Take some of many recordings on disk; those in memory stay."""
    if not isinstance(data, Recordings):
        return data
    chosen = np.unique(np.linspace(0, len(data) - 1, min(len(data), MOST_STORED)).round().astype(int))
    return [data[int(k)] for k in chosen]


def segments(recording: Recording) -> Iterator[Recording]:
    """Cut segments out of a long recording, spread evenly."""
    if len(recording) <= MOST_LOOKED_AT:
        yield recording
        return
    size = MOST_LOOKED_AT // PIECES
    for start in np.linspace(0, len(recording) - size, PIECES).astype(int):
        yield recording.slice(int(start), int(start) + size)


def gather(checked: Checked, values: FloatArray, *, other_friction: bool = False) -> Evidence:
    """Form rows of parameters and nuisance columns."""
    rigid, prepared, errors = values[: len(checked.model.leg.parameter_names)], [], []
    speed = np.zeros(len(checked.model.joint_names))
    for one in checked.data:
        extras = (AlternativeFriction(rigid, speed),) if other_friction and isinstance(one, Recording) else ()
        try:
            ready = prepare(WithColumns(checked.model, extras), one, checked.preparation)
            if isinstance(one, Recording) and one.passive:  # zero is no measurement that could have a fault
                ready = ready._replace(usable=ready.usable & one.driven)
            prepared.append((one, decimated(ready)))
        except ExoidError as error:
            errors.append(error)
    if not prepared:
        raise errors[0]
    ranges = [_range(one) for _, one in prepared]
    speed = np.max([one.speed for one in ranges], axis=0)
    friction = AlternativeFriction(rigid, speed) if other_friction else None
    both = [_rows(checked, one, ready, values, friction) for one, ready in prepared]
    return Evidence(
        [rows for rows, _ in both],
        [isinstance(one, Poses) for one, _ in prepared],
        len(checked.model.names),
        checked.fixed,
        ranges,
        [rows for _, rows in both if rows is not None],
    )


def _range(prepared: Prepared) -> MotionRanges:
    """Measure the motion of one recording."""
    motion, used = prepared.motion, prepared.inside
    return MotionRanges.of(motion.q[used], motion.v[used], motion.a[used])


def _rows(
    checked: Checked,
    one: Recording | Poses,
    prepared: Prepared,
    values: FloatArray,
    friction: AlternativeFriction | None,
) -> tuple[Rows, Rows | None]:
    """Form the decimated rows of one recording: those with nuisance columns, and those with other friction."""
    moving = isinstance(one, Recording)
    rate = one.sample_rate if isinstance(one, Recording) else 1.0
    speed = np.std(np.diff(one.q, axis=0), axis=0) * rate
    if one.payloads:  # a fault of the log changes the torque of payloads too
        values = values.copy()
        values[: len(checked.model.leg.parameter_names)] += payload_parameters(checked.model.leg, one.payloads)
    faults = NuisanceColumns(checked.model, values, rate, speed, moving, checked.arms)
    extras = (faults,) if friction is None or not moving else (faults, friction)
    model = WithColumns(checked.model, extras)
    rows, count = (
        chain([form_rows(model, prepared, stretch) for stretch in prepared.stretches()]),
        len(model.model.names),
    )
    with_faults = np.arange(count + len(faults.names))
    if len(extras) == 1:
        return rows, None
    with_friction = np.r_[:count, len(with_faults) : len(model.names)]
    return _columns_of(rows, with_faults), _columns_of(rows, with_friction)


def _columns_of(rows: Rows, columns: NDArray[np.intp]) -> Rows:
    """Take some columns of rows."""
    W = rows.W.transpose(2, 1, 0)[columns].transpose(2, 1, 0)
    return rows._replace(W=W, acting=rows.acting[:, columns])


def _even(one: Recording | Poses) -> Recording | Poses:
    return one.resampled() if isinstance(one, Recording) else one


def names_of(data: Sequence[Recording | Poses]) -> Iterator[str]:
    """Names of the files of recordings."""
    for one in data:
        yield one.source.name if one.source else ""
