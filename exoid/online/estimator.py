"""Recursive estimator: parameters of a leg from a stream of samples, in constant memory."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.finding import Finding, ordered
from exoid.leg.leg import Leg
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel

from .advance import Recursion, advance, samples_of
from .file import read_memory, write_memory
from .intake import Intake, as_table, findings_of, one_sample, take
from .memory import Memory
from .settings import EPOCH, Settings
from .solution import estimate_of
from .start import started
from .state import Change, Drift, State, restarted


class RecursiveEstimator:
    """Estimates the parameters of a leg sample by sample (docs/online.md).

    Samples are collected in blocks of :attr:`Settings.block`. A block passes the filters, becomes rows, and is taken in
    by :func:`exoid.online.advance`, a pure function. Memory and time of a step do not grow.

    Args:
        leg: The leg, of which only the geometry enters.
        terms: Terms beside rigid-body dynamics; None for those of :func:`exoid.identify`, or those of ``start``.
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the causal filter [Hz]; None for no filter: velocities and accelerations then have to
            be given.
        forgetting: "directional", "exponential" or "none".
        memory: Time constant of forgetting [s].
        estimator: "wls" (weighted by residuals) or "ols".
        start: Estimate to begin with, whose covariance says what it knows; None to begin with nothing.
        reversal_speed: Speed below which rows of a joint with dry friction are left out [rad/s]; 0 for none.
        torque_limits: Largest torque of each joint [N·m], (n,); samples that reach it are left out.
        nonnegative: Whether friction and rotor inertia are kept from falling below zero.
        consistent: Whether estimates are those of physically possible links, with M(q) positive definite.
        false_alarms: Rate of false alarms of the detection of sudden changes, and of that of slow ones [1/h]; 0 for
            no detection.
        window: Time constant of the change detection [s].
        epoch: Duration of the epochs whose estimates are compared to detect slow changes [s].

    Raises:
        ExoidError: A setting is out of range, terms do not fit, or the start is of another leg.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> online = RecursiveEstimator(data.leg, rate=data.train.sample_rate, cutoff=8.0, forgetting="none")
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
        forgetting: str = "directional",
        memory: float = 20.0,
        estimator: str = "wls",
        start: Estimate | None = None,
        reversal_speed: float = 0.1,
        torque_limits: ArrayLike | None = None,
        nonnegative: bool = False,
        consistent: bool = False,
        false_alarms: float = 0.1,
        window: float = 1.0,
        epoch: float = EPOCH,
    ) -> None:
        model = _model(leg, terms, start)
        limits = np.full(len(leg.joint_names), np.inf) if torque_limits is None else np.asarray(torque_limits, float)
        settings = Settings(
            model=model,
            rate=rate,
            cutoff=cutoff,
            forgetting=forgetting,
            memory=memory,
            estimator=estimator,
            reversal_speed=reversal_speed,
            torque_limits=limits,
            nonnegative=nonnegative,
            consistent=consistent,
            false_alarms=false_alarms,
            window=window,
            epoch=epoch,
        )
        recursion = Recursion.of(settings)
        state = recursion.begin()
        self._begin(recursion, Memory(state if start is None else started(settings, state, start), Intake()))

    def __repr__(self) -> str:
        """Name the leg and the number of samples."""
        return f"RecursiveEstimator({self.settings.model.leg.description.name!r}, {self._intake.received} samples)"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, (P,)."""
        return self.settings.model.names

    @property
    def delay(self) -> float:
        """Longest time from a sample to its use [s]: that of the filters, and of a block."""
        return self.settings.delay + self.settings.block_time

    @property
    def state(self) -> State:
        """State after the last complete block; without a filter, after the last sample."""
        return self._settled()

    def update(
        self,
        q: ArrayLike,
        v: ArrayLike | None,
        a: ArrayLike | None,
        tau: ArrayLike,
        time: ArrayLike | None = None,
    ) -> None:
        """Take one sample, or several, in.

        Samples that cannot be (NaN, jumps, repeated ones) are left out and counted in :attr:`findings`.

        Args:
            q: Angles [rad], (n,) or (N, n).
            v: Velocities [rad/s], likewise; None if the filter is to derive them.
            a: Accelerations [rad/s²], likewise; None if the filter is to derive them.
            tau: Torques [N·m], likewise.
            time: Time stamps [s], a number or (N,), from which missing and repeated samples are seen; None for samples
                at an even rate.

        Raises:
            ExoidError: Shapes do not fit the leg, what is given changes from call to call, there is no filter to derive
                with, angles are in degrees, or no sample is plausible for seconds.
        """
        n, given = self.settings.n, (v is not None, a is not None)
        if given != self._intake.given:
            self._refuse_other_channels(given)
        single = one_sample(q, v, a, tau, n)
        if single is not None and (time is None or isinstance(time, float)):
            self._take(single, math.nan if time is None else time)
            return
        of_q = as_table(q, "q", n, None)
        count = len(of_q)
        table = np.hstack([of_q, *(as_table(x, name, n, count) for x, name in ((v, "v"), (a, "a"), (tau, "tau")))])
        stamps = np.full(count, math.nan) if time is None else np.atleast_1d(np.asarray(time, dtype=np.float64))
        if stamps.shape != (count,):
            raise ExoidError(f"time of shape {stamps.shape} for {count} samples", remedy="pass one stamp a sample")
        for sample, stamp in zip(table.tolist(), stamps.tolist(), strict=True):
            self._take(tuple(sample), stamp)

    @property
    def estimate(self) -> Estimate:
        """Estimate by all samples so far, with intervals for correlated noise.

        Raises:
            ExoidError: The samples so far do not determine every parameter: names them.
        """
        return estimate_of(self.settings, self._settled(), self.findings)

    @property
    def changes(self) -> tuple[Change, ...]:
        """Changes of parameters that were detected, the last hundred at most."""
        return self._state.changes

    @property
    def drifts(self) -> tuple[Drift, ...]:
        """Slow changes of parameters that were detected, the last hundred at most."""
        return self._state.drifts

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Faults of the stream, and changes that were detected, the worst first."""
        changed = (*map(_as_finding, self.changes), *map(_of_drift, self.drifts))
        return ordered((*changed, *findings_of(self.settings, self._intake)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write settings and state as JSON, whole or not at all; see :meth:`resume`.

        Args:
            path: File to write.

        Raises:
            ExoidError: The file cannot be written.
        """
        write_memory(path, self.settings, Memory(self._state, self._intake, tuple(self._pending)))

    @classmethod
    def resume(cls, path: str | os.PathLike[str], leg: Leg) -> RecursiveEstimator:
        """Go on where :meth:`save` stopped, as if there had been no interruption.

        Args:
            path: File that :meth:`save` wrote.
            leg: The same leg.

        Returns:
            The estimator.

        Raises:
            ExoidError: The file is unreadable, or is of another leg.
        """
        settings, memory = read_memory(path, leg)
        resumed = cls.__new__(cls)
        resumed._begin(Recursion.of(settings), memory)
        return resumed

    def _begin(self, recursion: Recursion, memory: Memory) -> None:
        """Begin with a memory."""
        self.settings, self._recursion = recursion.settings, recursion
        self._state, self._intake = memory.state, memory.intake
        self._pending = list(memory.pending)

    def _take(self, sample: tuple[float, ...], stamp: float) -> None:
        """Take one sample in; a complete block goes on."""
        taken = take(self.settings, self._intake, sample, stamp)
        self._intake = taken.intake
        samples = taken.samples
        if self.settings.cutoff is None:
            samples = samples[-1:]
        elif taken.gap:
            self._pending, self._state = [], restarted(self.settings, self._state)
        for one in samples:
            self._pending.append(one)
            if len(self._pending) == self.settings.block:
                self._state, self._pending = self._advanced(), []

    def _advanced(self) -> State:
        """State with the samples that wait."""
        block = samples_of(self._pending, self.settings.n)
        v, a = self._intake.given or (True, True)
        nothing = np.full_like(block.q, math.nan)
        return advance(
            self._recursion, self._state, block._replace(v=block.v if v else nothing, a=block.a if a else nothing)
        )

    def _settled(self) -> State:
        """State with all samples that can be used."""
        return self._advanced() if self._pending and self.settings.cutoff is None else self._state

    def _refuse_other_channels(self, given: tuple[bool, bool]) -> None:
        """Refuse channels that come and go, and those that nothing can derive."""
        if self.settings.cutoff is None and not all(given):
            raise ExoidError(
                "without a filter nothing derives velocities and accelerations", remedy="pass v and a, or a cutoff"
            )
        if self._intake.given is not None:
            raise ExoidError(
                f"v and a given: {self._intake.given} before, {given} now", remedy="pass the same channels every time"
            )
        self._intake = self._intake._replace(given=given)


def _model(leg: Leg, terms: Sequence[Term] | None, start: Estimate | None) -> TorqueModel:
    """Torque model of the estimator; that of the start where there is one, so that parameters have the same names."""
    if start is None:
        return TorqueModel.at_start(leg, DEFAULT_TERMS if terms is None else terms)
    model = TorqueModel.at_start(leg, start.model.terms if terms is None else terms, start.names)
    if model.names != start.names:
        raise ExoidError(
            f"the start has the parameters {', '.join(start.names)}, and the model {', '.join(model.names)}",
            where=leg.description.name,
            remedy="pass an estimate of the same leg and terms",
        )
    return model


def _as_finding(change: Change) -> Finding:
    """Describe a change as a finding."""
    return Finding(
        f"changed-{change.kind}",
        change.joint,
        change.statistic,
        "",
        "info",
        f"{', '.join(change.parameters)} changed at {change.time:.2f} s",
        "values before it are in changes; what was known of these parameters was given up",
        parameters=change.parameters,
    )


def _of_drift(drift: Drift) -> Finding:
    """Describe a slow change as a finding."""
    return Finding(
        "changed-slowly",
        drift.joint,
        drift.statistic,
        "",
        "info",
        f"{drift.parameter} drifted from {drift.before:.4g} to {drift.after:.4g} until {drift.time:.0f} s",
        "seals wear in, and grease warms up; the estimate follows within the memory",
        parameters=(drift.parameter,),
    )
