"""Recursive estimator: parameters of a leg from a stream of samples, in constant memory."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import BadArgumentError, NotIdentifiableError
from exoid.estimate import Estimate
from exoid.estimate.finding import Finding
from exoid.leg.description import LARGEST_ANGLE
from exoid.leg.leg import Leg
from exoid.signals import checks
from exoid.torques import Term, TorqueModel
from exoid.torques.catalog import terms_of

from .advance import advance
from .findings import findings_of
from .settings import Settings
from .solution import estimate_of, started
from .state import Change, State, begin, restarted
from .stream import Sample, Stream, as_table, take


class RecursiveEstimator:
    """Estimates the parameters of a leg sample by sample (docs/online.md).

    Samples are collected in blocks of 0.1 s or so. A block passes the filters, becomes rows, and is taken in by
    ``exoid.online.advance``, a pure function. Memory and time of a step do not grow.

    Args:
        leg: The leg, of which only the geometry enters.
        terms: Terms beside rigid-body dynamics; None for those of :func:`exoid.identify`, or those of ``start``.
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the causal filter [Hz]; None for no filter: velocities and accelerations then have to
            be given.
        memory: Time constant of forgetting [s]; ``math.inf`` to forget nothing, and detect no change.
        start: Estimate to begin with, whose covariance says what it knows, such as one that an earlier session saved;
            None to begin with nothing.
        reversal_speed: Speed below which joints with dry friction have no rows [rad/s], slides a tenth in m/s; 0: none.
        torque_limits: Largest torque of each joint [N·m], (n,); samples that reach it are left out.
        false_alarms: Rate of false alarms of the detection of sudden changes [1/h]; 0 for no detection.
        passive: Joints without an actuator, whose torque is zero; None for those of ``start``.
        largest_angle: Limit of the angles [rad], beyond which they count as degrees; ``math.inf`` for a joint that
            really turns that far.

    Raises:
        ExoidError: A setting is out of range, terms do not fit, or the start is of another leg.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> online = RecursiveEstimator(data.leg, rate=data.train.sample_rate, cutoff=8.0, memory=np.inf)
        >>> online.update(data.train.q, None, None, data.train.tau)
        >>> online.estimate["X1"].unit
        'kg·m'
    """

    def __init__(
        self,
        leg: Leg,
        terms: Sequence[Term] | None = None,
        *,
        rate: float = 500.0,
        cutoff: float | None = 8.0,
        memory: float = 20.0,
        start: Estimate | None = None,
        reversal_speed: float = 0.1,
        torque_limits: ArrayLike | None = None,
        false_alarms: float = 0.1,
        passive: Sequence[str] | None = None,
        largest_angle: float = 2.0 * LARGEST_ANGLE,
    ) -> None:
        # The model of the start where there is one, so that parameters have the same names
        chosen = terms_of(start.model.terms if terms is None and start is not None else terms)
        model = TorqueModel(leg, chosen, separate=() if start is None else start.names)
        if start is not None and model.names != start.names:
            what = f"the start has the parameters {', '.join(start.names)}, and the model {', '.join(model.names)}"
            remedy = "pass an estimate of the same leg and terms"
            raise BadArgumentError(what, where=leg.description.name, remedy=remedy)
        if passive is None:
            passive = () if start is None else start.passive
        self.settings = settings = Settings(
            model,
            rate,
            cutoff,
            memory,
            reversal_speed=reversal_speed,
            torque_limits=() if torque_limits is None else tuple(np.ravel(torque_limits).tolist()),
            false_alarms=false_alarms,
            passive=checks.as_joints(passive, leg.joint_names, "passive"),
            largest_angle=largest_angle,
        )
        state, self._stream, self._pending = begin(settings), Stream(), list[Sample]()
        self._state = state if start is None else started(settings, state, start)

    def __repr__(self) -> str:
        """Name the leg and the number of samples."""
        return f"RecursiveEstimator({self.settings.model.leg.description.name!r}, {self._stream.received} samples)"

    @property
    def delay(self) -> float:
        """Longest time from a sample to its use [s]: that of the filters, and of a block."""
        return self.settings.delay + self.settings.block_time

    @property
    def state(self) -> State:
        """State after the last complete block; without a filter, after the last sample."""
        return self._advanced() if self._pending and self.settings.cutoff is None else self._state

    def update(
        self, q: ArrayLike, v: ArrayLike | None, a: ArrayLike | None, tau: ArrayLike, time: ArrayLike | None = None
    ) -> None:
        """Take one sample, or several, in.

        Samples that cannot be (NaN, jumps, repeated ones) are left out and counted in :attr:`findings`.

        Args:
            q: Angles [rad], (n,) or (N, n).
            v: Velocities [rad/s], likewise; None if the filter is to derive them.
            a: Accelerations [rad/s²], likewise; None if the filter is to derive them.
            tau: Torques [N·m], likewise; NaN or zero at passive joints.
            time: Time stamps [s], a number or (N,), from which missing and repeated samples are seen; None for samples
                at an even rate.

        Raises:
            ExoidError: Shapes do not fit the leg, what is given changes from call to call, there is no filter to derive
                with, angles are in degrees, a passive joint has a torque, or no sample is plausible for seconds.
        """
        n, given = self.settings.n, (v is not None, a is not None)
        if given != self._stream.given:
            if self.settings.cutoff is None and not all(given):
                what = "without a filter nothing derives velocities and accelerations"
                raise BadArgumentError(what, remedy="pass v and a, or a cutoff")
            if self._stream.given:
                what = f"v and a given: {self._stream.given} before, {given} now"
                raise BadArgumentError(what, remedy="pass the same channels every time")
            self._stream = self._stream._replace(given=given)
        of_q = as_table(q, "q", n, None)
        count = len(of_q)
        table = np.hstack([of_q, *(as_table(x, name, n, count) for x, name in ((v, "v"), (a, "a"), (tau, "tau")))])
        if self.settings.passive:
            known = {"joint_names": self.settings.model.leg.joint_names, "passive": self.settings.passive}
            table[:, 3 * n :] = checks.with_zero_torque({**known, "tau": table[:, 3 * n :]}, of_q.shape)
        stamps = np.full(count, math.nan) if time is None else np.atleast_1d(np.asarray(time, dtype=np.float64))
        if stamps.shape != (count,):
            what = f"time of shape {stamps.shape} for {count} samples"
            raise BadArgumentError(what, remedy="pass one stamp a sample")
        for sample, stamp in zip(table.tolist(), stamps.tolist(), strict=True):
            self._take(tuple(sample), stamp)

    @property
    def estimate(self) -> Estimate:
        """Estimate by all samples so far, with intervals for correlated noise.

        Raises:
            ExoidError: The samples so far do not determine every parameter: names them.
        """
        try:
            return estimate_of(self.settings, self.state, self._stream)
        except NotIdentifiableError as error:  # what is wrong with the stream may be the reason
            for finding in self.findings[:1]:
                error.what, error.remedy = f"{error.what}; {finding.message}", f"{finding.remedy}, or {error.remedy}"
            raise

    @property
    def changes(self) -> tuple[Change, ...]:
        """Changes of parameters that were detected, the last hundred at most."""
        return self._state.changes

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Faults of the stream, changes that were detected, and what contradicts the estimate, the worst first."""
        return findings_of(self.settings, self._state, self._stream)

    def _take(self, sample: Sample, stamp: float) -> None:
        """Take one sample in; a complete block goes on."""
        stream = self._stream._replace(received=self._stream.received + 1)
        self._stream, samples, gap = take(self.settings, stream, sample, stamp)
        if self.settings.cutoff is None:
            samples = samples[-1:]
        elif gap:
            self._pending, self._state = [], restarted(self.settings, self._state, self._stream.slipped)
        for one in samples:
            self._pending.append(one)
            if len(self._pending) == self.settings.block:
                if self._stream.given[0]:  # both ways of the block
                    q, v = np.split(np.array(self._pending)[:, : 2 * self.settings.n], 2, axis=1)
                    ways = (q[-1] - q[0]) * [q[-1] - q[0], (v.sum(axis=0) - 0.5 * (v[0] + v[-1])) / self.settings.rate]
                    self._stream = self._stream._replace(travel=self._stream.travel + ways)
                self._state, self._pending = self._advanced(), []

    def _advanced(self) -> State:
        """State with the samples that wait."""
        samples, n = np.array(self._pending), self.settings.n
        for k, given in enumerate(self._stream.given, start=1):
            if not given:
                samples[:, k * n : (k + 1) * n] = math.nan
        return advance(self.settings, self._state, samples)
