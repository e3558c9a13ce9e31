"""Rows of recordings with nuisance columns, as many as a check needs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import reduce
from itertools import pairwise
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate.evidence import MotionRanges
from exoid.estimate.model_error import COUNT, AlternativeFriction
from exoid.regression.row_data import Rows
from exoid.regression.rows import Prepared, chain, decimated, form_rows, prepare
from exoid.signals import FiniteDifference, MovingAverage, Poses, Preparation, Recording, Recordings, ZeroPhase
from exoid.signals.recording_data import change_samples
from exoid.torques import Motion, TorqueModel
from exoid.torques.catalog import radians
from exoid.torques.payloads import payload_parameters

from .arms import ArmShapes
from .columns import NuisanceColumns, residual_hints
from .evidence import Evidence
from .kinds import Library, library


class FittedLeg(NamedTuple):
    """A fit that is checked, and its data."""

    model: TorqueModel  # torque model
    data: Sequence[Recording | Poses]  # recordings and poses
    preparation: Preparation  # filter and differentiation
    fixed: FloatArray  # known values of parameters, (P,); not a number where they are free
    values: FloatArray  # fitted parameters, (P,)
    covariance: FloatArray  # their covariance, (P, P)
    arms: Mapping[int, ArmShapes] = MappingProxyType({})  # of linear actuators whose force was measured, by their joint
    told: Mapping[str, tuple[float, float]] = MappingProxyType({})  # values that were told, and their errors
    constants: Mapping[str, int] = MappingProxyType({})  # joint of each constant that was found and scales a torque
    hints: FloatArray = np.zeros((0, 3))  # see `residual_hints`

    @property
    def library(self) -> Library:
        """Faults that are tested, and their columns."""
        sensed = any(isinstance(one, Recording) and one.wrenches for one in self.data)
        known, free = sensed or any(one.payloads for one in self.data), tuple(self.constants.values())
        return library(self.model, tuple(self.arms.items()), free, known=known, sensed=sensed)

    def sampled(self) -> FittedLeg:
        """Take samples for a check, with the joints of the leg; a log much faster than its filter is averaged."""
        # Plain differences are noisier than the faults that are looked for, and are not used.
        noisy = isinstance(self.preparation, (FiniteDifference, MovingAverage))
        preparation = ZeroPhase() if noisy else self.preparation
        data = some_samples(self.model, self.data)
        driven = [{*one.computed} if isinstance(one, Recording) else set() for one in data]
        names = self.model.leg.joint_names
        arms = {joint: arm for joint, arm in self.arms.items() if all(names[joint] in each for each in driven)}
        return self._replace(data=tuple(averaged(one, preparation) for one in data), preparation=preparation, arms=arms)

    def clock_start(self, one: Recording | Poses) -> float:
        """First time of the recording that a sample was cut from."""
        parts = (x for x in self.data if isinstance(x, Recording))
        same = (x for x in parts if x is one or (x.source is not None and x.source is one.source))
        return min((x.time[0] for x in same), default=0.0)  # poses have no time


def some_samples(
    model: TorqueModel, data: Sequence[Recording | Poses], most: int = 60_000
) -> tuple[Recording | Poses, ...]:
    """Take at most so many samples, in five segments or fewer spread evenly: more would find no smaller faults."""
    segment = max(6_000, most // 5)
    if sum(len(one) for one in data) <= most:
        chosen = list(data)
    else:
        places = [
            (k, slice(start, start + segment))
            for k, one in enumerate(data)
            for start in range(0, max(len(one) - segment // 2, 1), segment)
            # away from its ends, which derivatives may spoil
            if isinstance(one, Poses)
            or one.mask is None
            or one.mask[start : start + segment][segment // 10 : -segment // 10].any()
        ]
        evenly = np.unique(np.linspace(0, len(places) - 1, most // segment).round().astype(int))
        chosen = []
        for k, where in (places[place] for place in evenly):
            one = data[k]
            chosen.append(one.take(where) if isinstance(one, Poses) else one.slice(where.start, where.stop))
    selected = (model.select(one) for one in chosen)
    return tuple(one.resampled() if isinstance(one, Recording) else one for one in selected)


def averaged(one: Recording | Poses, preparation: Preparation) -> Recording | Poses:
    """Average neighbouring samples of a log that is much faster than its filter."""
    if not isinstance(one, Recording) or not isinstance(preparation, ZeroPhase):
        return one
    # At 12.5 samples in 1/cut-off, and 100 Hz, the mean of neighbours changes no finding (tests of nuisances).
    size = int(one.sample_rate / max(100.0, 12.5 * preparation.cutoff))
    if size < 2 or len(one) < 20 * size:
        return one
    count = len(one) // size * size
    means = {
        name: of_all[:count].reshape(-1, size, *of_all.shape[1:]).mean(axis=1)
        for name in ("time", "q", "v", "a", "tau", "current", "force", "motor_torque", "motor_angle")
        if (of_all := getattr(one, name)) is not None
    }
    grouped = (lambda part: part.averaged(size)), (lambda mask: mask[:count].reshape(-1, size).all(axis=1))
    return change_samples(one, means, *grouped)


def log_starts(names: Sequence[str], times: Sequence[FloatArray]) -> list[bool]:
    """Which parts of data begin another log: another file, or times that begin anew."""
    both = pairwise(zip(names, times, strict=True))
    return [True, *(name != other or after[0] < before[-1] for (name, before), (other, after) in both)]


def few_of(data: Sequence[Recording | Poses]) -> Sequence[Recording | Poses]:
    """Take 20 of many recordings on disk, spread evenly; those in memory stay."""
    if not isinstance(data, Recordings):
        return data
    chosen = np.unique(np.linspace(0, len(data) - 1, min(len(data), 20)).round().astype(int))
    return [data[int(k)] for k in chosen]


def gather(fitted: FittedLeg, *, friction: bool = False) -> Evidence:
    """Form rows of parameters and nuisance columns, in the same pass also of friction of other forms if asked for."""
    ready, errors = [], []
    for one in fitted.data:
        try:
            # Rows at reversals stay: other friction, and many faults, differ most where joints turn round.
            prepared = decimated(prepare(fitted.model, one, fitted.preparation, stops=False))
        except ExoidError as error:
            errors.append(error)
            continue
        if isinstance(one, Recording) and one.passive:  # zero is no measurement that could have a fault
            prepared = prepared._replace(usable=prepared.usable & one.driven)
        ready.append((one, prepared))
    if not ready:
        raise errors[0]
    ranges = reduce(MotionRanges.joined, (MotionRanges.of(one.motion, one.inside) for _, one in ready))
    # not every recording reaches the limit of a drive: some 1 000 samples of all of them tell it
    step = 1 + sum(len(one.time) for _, one in ready) // 1000
    tau = np.vstack([one.tau[::step] for one, _ in ready if one.tau is not None])
    motions = [one.motion.rows(slice(None, None, step)) for _, one in ready]
    fitted = fitted._replace(hints=residual_hints(fitted.model, motions, np.nan_to_num(tau)))
    rigid = fitted.values[: len(fitted.model.leg.parameter_names)]
    alternatives = AlternativeFriction(rigid, ranges.speed, radians(fitted.model.leg))
    rows = [_rows(fitted, one, prepared, [alternatives] if friction else []) for one, prepared in ready]
    at_rest = [isinstance(one, Poses) for one, _ in ready]
    evidence = Evidence.of(rows, at_rest, fitted.fixed, beside=COUNT if friction else 0)
    return evidence._replace(ranges=ranges, sources=[one.file_name for one, _ in ready], hints=fitted.hints)


def _rows(fitted: FittedLeg, one: Recording | Poses, prepared: Prepared, others: Sequence[AlternativeFriction]) -> Rows:
    """Form the decimated rows of one recording."""
    model, values, columns = fitted.model, fitted.values, fitted.library.columns
    rate = one.sample_rate if isinstance(one, Recording) else 1.0
    speed = np.std(np.diff(one.q, axis=0), axis=0) * rate
    places = [(column.kind, len(model.names) + k) for k, column in enumerate(columns)]
    carried = payload_parameters(model.leg, one.payloads)  # a fault of the log changes the torque of payloads too
    about = values, carried, rate, speed, fitted.hints, isinstance(one, Recording), fitted.arms
    every = replace(model, extras=(NuisanceColumns(model, columns, *about), *others))
    assert isinstance(prepared.motion, Motion)
    assert one.tau is not None
    states = every.motion(*prepared.motion[:4]).states
    prepared = prepared._replace(motion=prepared.motion._replace(states=states, measured=np.nan_to_num(one.tau)))
    rows = chain([form_rows(every, prepared, stretch) for stretch in prepared.stretches()])
    since = rows.time - fitted.clock_start(one)
    rows.W[..., [k for kind, k in places if kind.endswith(" t")]] *= since[:, None, None]
    if not getattr(one, "wrenches", {}):  # a payload has no sensor that could be late
        rows.W[..., [k for kind, k in places if kind == "known delay"]] = 0.0
    return rows
