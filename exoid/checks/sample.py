"""Rows of recordings with nuisance columns, as many as a check needs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.motion_ranges import MotionRanges
from exoid.regression.rows import Rows, chain, decimate, for_leg, form_rows, prepare
from exoid.signals import Poses, Preparation, Recording, Recordings
from exoid.torques import TorqueModel

from .nuisances import Augmented
from .score import Evidence

MOST_SAMPLES = 60_000
"""Samples of which a check forms rows; of a longer log it takes segments that are spread evenly,"""

SEGMENT = 6_000
"""so many samples each."""


MOST_STORED = 20
"""Of recordings on disk a check reads so many, spread evenly."""

MOST_LOOKED_AT = 100_000
"""Samples of one recording whose channels are looked at,"""

PIECES = 10
"""in so many segments."""


class Checked(NamedTuple):
    """Torque model and data that a check works on.

    Attributes:
        model: Torque model.
        data: Recordings and poses, with the joints of the leg.
        preparation: Filter and differentiation.
        fixed: Known values of parameters, (P,); not a number where they are free.
    """

    model: TorqueModel
    data: tuple[Recording | Poses, ...]
    preparation: Preparation
    fixed: FloatArray


def some_samples(model: TorqueModel, data: Sequence[Recording | Poses]) -> tuple[Recording | Poses, ...]:
    """Take at most :data:`MOST_SAMPLES` samples of some recordings, in segments spread evenly.

    Args:
        model: Torque model, for its joints.
        data: Recordings and poses.

    Returns:
        Recordings and poses with the joints of the leg.
    """
    total = sum(len(one) for one in data)
    if total <= MOST_SAMPLES:
        return tuple(_even(for_leg(model, one)) for one in data)
    kept: list[Recording | Poses] = []
    places = [(k, start) for k, one in enumerate(data) for start in range(0, max(len(one) - SEGMENT // 2, 1), SEGMENT)]
    chosen = np.unique(np.linspace(0, len(places) - 1, MOST_SAMPLES // SEGMENT).round().astype(int))
    for place in chosen:
        k, start = places[place]
        one = data[k]
        part = one.take(slice(start, start + SEGMENT)) if isinstance(one, Poses) else one.slice(start, start + SEGMENT)
        kept.append(_even(for_leg(model, part)))
    return tuple(kept)


def few_of(data: Sequence[Recording | Poses]) -> Sequence[Recording | Poses]:
    """Take some of many recordings on disk; those in memory stay.

    Args:
        data: Recordings and poses.

    Returns:
        Recordings and poses.
    """
    if not isinstance(data, Recordings):
        return data
    chosen = np.unique(np.linspace(0, len(data) - 1, min(len(data), MOST_STORED)).round().astype(int))
    return [data[int(k)] for k in chosen]


def segments(recording: Recording) -> Iterator[Recording]:
    """Cut segments out of a long recording, spread evenly.

    Args:
        recording: The recording.

    Yields:
        The whole of a short recording.
    """
    if len(recording) <= MOST_LOOKED_AT:
        yield recording
        return
    size = MOST_LOOKED_AT // PIECES
    for start in np.linspace(0, len(recording) - size, PIECES).astype(int):
        yield recording.slice(int(start), int(start) + size)


def gather(checked: Checked, values: FloatArray) -> Evidence:
    """Form rows of parameters and nuisance columns.

    Args:
        checked: Torque model and data.
        values: Parameters at which nuisance columns are formed, (P,).

    Returns:
        The rows.

    Raises:
        ExoidError: No recording is long enough for the filter.
    """
    parts, at_rest, ranges, errors = [], [], [], []
    for one in checked.data:
        try:
            rows, moved = _rows(checked, one, values)
        except ExoidError as error:
            errors.append(error)
            continue
        parts.append(rows)
        ranges.append(moved)
        at_rest.append(isinstance(one, Poses))
    if not parts:
        raise errors[0]
    return Evidence(parts, at_rest, len(checked.model.names), checked.fixed, ranges)


def _rows(checked: Checked, one: Recording | Poses, values: FloatArray) -> tuple[Rows, MotionRanges]:
    """Form the decimated rows of one recording, and measure its motion."""
    moving = isinstance(one, Recording)
    rate = one.sample_rate if isinstance(one, Recording) else 1.0
    speed = np.std(np.diff(one.q, axis=0), axis=0) * rate
    augmented = Augmented(checked.model, values, rate, speed, moving)
    prepared = prepare(augmented, one, checked.preparation)
    before, kept = 0, []
    for stretch in prepared.stretches():
        kept.append(decimate(form_rows(augmented, prepared, stretch), before, len(prepared.rows)))
        before += len(stretch)
    motion, used = prepared.motion, slice(prepared.rows.start, prepared.rows.stop)
    ranges = MotionRanges.of(motion.q[used], motion.v[used], motion.a[used])
    return chain([rows for rows in kept if len(rows.time)]), ranges


def _even(one: Recording | Poses) -> Recording | Poses:
    return one.resampled() if isinstance(one, Recording) else one


def names_of(data: Sequence[Recording | Poses]) -> Iterator[str]:
    """Names of the files of recordings.

    Args:
        data: Recordings and poses.

    Yields:
        Name of each file; "" for one made in memory.
    """
    for one in data:
        yield one.source.name if one.source else ""
