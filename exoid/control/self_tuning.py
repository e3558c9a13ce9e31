"""Indirect adaptive control: PD with a feedforward whose model is refreshed from a recursive estimate."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import UnreadableInputError
from exoid.estimate import Estimate
from exoid.online.advance import advance
from exoid.online.settings import Settings
from exoid.online.solution import belief, estimate_of, started
from exoid.online.state import State as OnlineState
from exoid.online.state import begin as begin_online
from exoid.rig import Target
from exoid.tools.numbers import checked

from .known_leg import as_estimate
from .law import RATE, State, acceleration, refuse_rate
from .laws import pd
from .model import ControlModel, ModelSource
from .parameter_change import ExpectedChange, regular
from .parameter_cone import FLOOR, ParameterCone
from .slotine_li import SlotineLiModel
from .tracking_law import TrackingLaw


class SelfTuningMemory(NamedTuple):
    """Memory of a self-tuning controller, for one leg or B."""

    values: FloatArray  # parameters of the feedforward in the order of `law.names`, (P,) or (P, B)
    aim: FloatArray  # parameters that they approach, likewise
    online: tuple[OnlineState, ...]  # state of the recursive estimator of each leg
    pending: FloatArray  # samples of q, v and τ that wait for their block to be complete, (k, 3, n, B)
    before: FloatArray  # q, v, and the torque held before the previous sample, (3, n, B); NaN before the second sample
    requested: FloatArray  # torque requested at the previous sample [N·m], (n, B)


@dataclass(frozen=True, eq=False)
class SelfTuning:
    """τ = Kp e + Kd ė + Y(θ_d, θ̇_d, θ̈_d) β̂, with β̂ of a recursive estimate: a :class:`exoid.control.StatefulLaw`."""

    # Measured motion and held torque go through a recursive estimator. After every block, of 0.1 s or so, β̂ approaches
    # the posterior
    #
    #     β* = argmin ‖R β − z‖² + (β − β₀)ᵀ P₀⁻¹ (β − β₀)    over the `ParameterCone`,
    #
    # where [R z] is what the estimator knows, and P₀ the covariance of the initial estimate and of the expected
    # changes. So parameters that the motion does not excite stay at β₀ (self-tuning regulators with certainty
    # equivalence: K. J. Åström, B. Wittenmark, Adaptive Control, 1995, ch. 3).
    #
    # β̂ moves along straight lines inside the cone, a convex set, so M(q; β̂) is positive definite at every sample. Its
    # distance from β₀ and its rate are limited. Nobody may wear or touch the leg: the estimator would take their torque
    # for parameters of the leg.

    feedback: TrackingLaw  # PD feedback
    model: SlotineLiModel  # linear model, initial values and P₀ of the adapted parameters
    cone: ParameterCone  # set of the parameters
    source: Estimate  # initial estimate, with the parameters of the recursive one; other terms keep their coefficients
    covariance: FloatArray  # P₀ of all of these, (R, R)
    settings: Settings  # of the recursive estimator
    time_constant: float  # time constant with which β̂ approaches β* [s]
    slew: float  # largest rate of each parameter, in standard deviations of P₀ [1/s]
    bound: float  # largest distance of each parameter from β₀, in standard deviations of P₀

    def __post_init__(self) -> None:
        """Check the settings."""
        for name in ("time_constant", "slew", "bound"):
            checked(getattr(self, name), name, above=0.0)

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.feedback.rate

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters of the feedforward, (P,)."""
        return self.model.names

    def begin(self, state: State) -> SelfTuningMemory:
        """Begin with the initial values."""
        n, count = self.model.n, state.q.reshape(self.model.n, -1).shape[1]
        values = np.tile(self.model.values[:, None], count).reshape(-1, *state.q.shape[1:])
        unknown = np.full((3, n, count), np.nan)
        nothing = np.zeros((0, 3, n, count))
        return SelfTuningMemory(values, values, (self._start,) * count, nothing, unknown, unknown[0])

    def step(self, memory: SelfTuningMemory, state: State, target: Target) -> tuple[FloatArray, SelfTuningMemory]:
        """Compute the torque, and refresh the parameters by the torque held in ``state.last``; see the class."""
        n, shape = self.model.n, state.q.shape
        memory = self._sampled(memory, state)
        values = memory.values.reshape(len(self.names), -1)
        share = min(1.0, 1.0 / (self.rate * self.time_constant))
        way = self._shortened(share * (memory.aim.reshape(values.shape) - values), self.slew / self.rate)
        values = values + way
        q, v, a = (x.reshape(n, -1) for x in (target.q, target.v, acceleration(target)))
        ahead = np.einsum("bnp,pb->nb", self.model.regressor(q, v, v, a), values) + self.model.fixed(q, v, a)
        torque = self.feedback.torque(state, target) + ahead.reshape(shape)
        return torque, memory._replace(values=values.reshape(memory.values.shape), requested=torque.reshape(n, -1))

    def estimate_of(self, memory: SelfTuningMemory, leg: int = 0) -> Estimate:
        """Estimate of what the recursive estimator of one leg knows, without the prior."""
        return estimate_of(self.settings, memory.online[leg], ())

    def _sampled(self, memory: SelfTuningMemory, state: State) -> SelfTuningMemory:
        """Complete the previous sample by the torque that was held behind it; a complete block goes on."""
        n = self.model.n
        held = memory.requested if state.last is None else state.last.reshape(n, -1)
        now = np.array([state.q.reshape(n, -1), state.v.reshape(n, -1), held])
        if not np.isfinite(now[:2]).all():
            raise UnreadableInputError(
                "a reading is not finite", remedy="stop the leg, and begin again with good readings"
            )
        pending, before = memory.pending, memory.before
        if np.isfinite(before).all() and np.isfinite(held).all():
            moved = 0.5 * (before[2] + held) - self.model.fixed(before[0], before[1], np.zeros_like(held))
            complete = np.array([before[0], before[1], moved])
            pending = np.concatenate([pending, complete[None]])
        memory = memory._replace(pending=pending, before=now)
        return memory if len(pending) < self.settings.block else self._refreshed(memory)

    def _refreshed(self, memory: SelfTuningMemory) -> SelfTuningMemory:
        """Take the samples that wait in, and compute β* of each leg."""
        follows, used = np.full(memory.pending[:, 0, :, 0].shape, np.nan), np.zeros(memory.pending[:, 0, :, 0].shape)
        online, aims = [], []
        for leg, before in enumerate(memory.online):
            q, v, torque = memory.pending[..., leg].transpose(1, 0, 2)
            after = advance(self.settings, before, np.hstack([q, v, follows, torque, used]))
            online.append(after)
            aims.append(self._posterior(after))
        aim = np.transpose(aims).reshape(memory.aim.shape)
        return memory._replace(online=tuple(online), aim=aim, pending=memory.pending[:0])

    def _posterior(self, online: OnlineState) -> FloatArray:
        """β* of one leg, (P,)."""
        table = np.vstack([belief(self.settings, online)[:, self._order], self._prior])
        factor = np.asarray(np.linalg.qr(table, mode="r"))
        others = len(self.source.names) - len(self.names)
        root, z = factor[others:-1, others:-1], factor[others:-1, -1]
        found = self.cone.nearest(np.linalg.solve(root, z), root)
        return np.asarray(self.model.values + self._shortened((found - self.model.values)[:, None], self.bound)[:, 0])

    def _shortened(self, way: FloatArray, most: float) -> FloatArray:
        """Shorten changes (P, B) so that none exceeds so many standard deviations."""
        longest = np.abs(way / self._std[:, None]).max(axis=0)
        return np.asarray(way * np.minimum(1.0, most / np.maximum(longest, 1e-300)))

    @cached_property
    def _places(self) -> NDArray[np.intp]:
        """Places of the adapted parameters among those of the estimate, (P,)."""
        return places_of(self.model.names, self.source.names)

    @cached_property
    def _order(self) -> list[int]:
        """Columns [R z] with the adapted parameters behind the others."""
        count = len(self.source.names)
        return [*sorted({*range(count)} - {*self._places.tolist()}), *self._places.tolist(), count]

    @cached_property
    def _prior(self) -> FloatArray:
        """[L  L β₀] with Lᵀ L = P₀⁻¹, its columns in that order, (R, R + 1)."""
        root = np.linalg.cholesky(np.linalg.inv(self.covariance)).T
        begin = self.source.values.copy()
        begin[self._places] = self.model.values
        return np.asarray(np.column_stack([root, root @ begin])[:, self._order])

    @cached_property
    def _std(self) -> FloatArray:
        return np.asarray(np.sqrt(np.diagonal(self.model.covariance)))

    @cached_property
    def _start(self) -> OnlineState:
        """State of the recursive estimator before the first sample."""
        loose = replace(self.source, covariance=100.0 * self.covariance)  # so that the prior counts once
        return started(self.settings, begin_online(self.settings), loose)


def self_tuning(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    change: ExpectedChange | None = None,
    time_constant: float = 0.3,
    slew: float = 3.0,
    bound: float = 5.0,
    cutoff: float | None = None,
    memory: float = 20.0,
    false_alarms: float = 0.1,
    rate: float = RATE,
) -> SelfTuning:
    """Make a self-tuning controller from a model of the leg.

    Args:
        source: An estimate, whose covariance is part of the prior; or a leg, or a plant of one rig.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad], likewise.
        change: Standard deviations of what may change; None for a payload of 1 kg on each link, and 30 % of friction.
        time_constant: Time constant with which the parameters approach the estimate [s].
        slew: Largest rate of each parameter, in standard deviations of what may change [1/s].
        bound: Largest distance of each parameter from its first value, likewise.
        cutoff: −3 dB frequency of the estimator's filter [Hz]; None for 8 Hz, or what the rate permits.
        memory: Time constant with which the estimator forgets [s].
        false_alarms: Rate of false alarms of its change detection [1/h]; 0 for no detection.
        rate: Sampling rate [Hz].

    Returns:
        The controller; limit its torque by :class:`exoid.control.Limited`.

    Raises:
        ExoidError: A setting is out of range, no parameter may change, or the source has no control model.

    Example:
        >>> import exoid
        >>> law = self_tuning(exoid.load_leg("cuhk"), 60.0, 6.0)
        >>> law.names
        ('X1', 'Y1', 'J1', 'X2', 'Y2', 'J2')
    """
    refuse_rate(rate)
    estimate = as_estimate(source, 1.0)  # N·m, the torque's error at first where a source has no residuals
    model = replace(SlotineLiModel.of(estimate, change or ExpectedChange()), model=ControlModel.of(source))
    cone = ParameterCone.of(model.model.leg, model.positive)
    covariance = estimate.covariance.copy()
    places = places_of(model.names, estimate.names)
    held = places[np.diagonal(model.covariance) == 0.0]  # what does not vary is correlated with nothing
    covariance[held], covariance[:, held] = 0.0, 0.0
    covariance[np.ix_(places, places)] = model.covariance
    covariance = regular(covariance, estimate.values)
    own = covariance[np.ix_(places, places)]
    begin = cone.nearest(model.values, np.linalg.cholesky(np.linalg.inv(own)).T)
    count = len(model.model.leg.parameter_names)
    floor = np.append(FLOOR * begin[:count], np.zeros(len(begin) - count))
    settings = Settings(
        model=estimate.model,
        rate=rate,
        cutoff=min(8.0, rate / 12.5) if cutoff is None else cutoff,  # what the rate can carry
        memory=memory,
        false_alarms=false_alarms,
    )
    return SelfTuning(
        feedback=pd(kp, kd, rate=rate),
        model=replace(model, values=begin, covariance=own),
        cone=cone.above(floor),
        source=estimate,
        covariance=covariance,
        settings=settings,
        time_constant=time_constant,
        slew=slew,
        bound=bound,
    )


def places_of(names: tuple[str, ...], among: tuple[str, ...]) -> NDArray[np.intp]:
    """Find parameters of a controller among those of an estimate; an offset is the constant of a spring."""
    known = {name.replace("offset_", "b0_"): k for k, name in enumerate(among) if name.startswith("offset_")}
    known |= {name: k for k, name in enumerate(among)}
    return np.array([known[name] for name in names], dtype=np.intp)
