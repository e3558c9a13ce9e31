"""Indirect adaptive control: PD with a feedforward whose parameters follow a recursive estimate."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import NotSupportedError
from exoid.estimate import Estimate
from exoid.leg.lift import check_physical, lift
from exoid.online.advance import advance
from exoid.online.settings import Settings
from exoid.online.solution import belief, estimate_of, started
from exoid.online.state import State as OnlineState
from exoid.online.state import begin as begin_online
from exoid.online.stream import Stream
from exoid.regression.least_squares import scaled_lstsq
from exoid.rig import Target
from exoid.signals import FiniteDifference
from exoid.tools.numbers import checked
from exoid.torques import Armature, Coulomb, Stiffness, Term, TorqueModel, Viscous
from exoid.torques.motion import random_motion

from .friction import WIDTH
from .law import RATE, State, acceleration, refuse_shape, sound
from .laws import pd
from .model import ControlModel, ModelSource, completed, payload_covariance
from .tracking_law import TrackingLaw

SLEW, BOUND = 3.0, 5.0
"""Largest rate [1/s] and distance of a parameter from its first value, in standard deviations of the prior."""


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
    """τ = Kp e + Kd ė + W(θ_d, θ̇_d, θ̈_d) β̂, with β̂ of a recursive estimate: a :class:`exoid.control.StatefulLaw`."""

    # Measured motion and held torque go through a recursive estimator. After every block, of 0.1 s or so, β̂ approaches
    # the posterior
    #
    #     β* = argmin ‖R β − z‖² + (β − β₀)ᵀ P₀⁻¹ (β − β₀)
    #
    # or the physically possible links nearest to it, where [R z] is what the estimator knows, and P₀ the covariance of
    # the first estimate and of the expected changes. So parameters that the motion does not excite stay at β₀
    # (self-tuning regulators with certainty equivalence: K. J. Åström, B. Wittenmark, Adaptive Control, 1995, ch. 3).
    #
    # β̂ moves along straight lines inside a convex set, so the links are possible at every sample if those of β₀ are.
    # Its distance from β₀ and its rate are limited. Nobody may wear or touch the leg: the estimator would take their
    # torque for parameters.

    feedback: TrackingLaw  # PD feedback
    source: Estimate  # first estimate β₀, whose covariance is P₀
    settings: Settings  # of the recursive estimator

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.feedback.rate

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters of the feedforward, (P,)."""
        return self.source.names

    def begin(self, state: State) -> SelfTuningMemory:
        """Begin with the first values."""
        n = self.settings.n
        refuse_shape(state, n, np.shape(state.q)[1:2])
        count = state.q.reshape(n, -1).shape[1]
        values = np.tile(self.source.values[:, None], count).reshape(-1, *state.q.shape[1:])
        unknown = np.full((3, n, count), np.nan)
        loose = replace(self.source, covariance=100.0 * self.source.covariance)  # so that the prior counts once
        online = (started(self.settings, begin_online(self.settings), loose),) * count
        return SelfTuningMemory(values, values, online, np.zeros((0, 3, n, count)), unknown, unknown[0])

    def step(self, memory: SelfTuningMemory, state: State, target: Target) -> tuple[FloatArray, SelfTuningMemory]:
        """Compute the torque, and refresh the parameters by the torque held in ``state.last``; see the class."""
        n, shape = self.settings.n, np.shape(state.q)
        refuse_shape(state, n, memory.values.shape[1:])
        feedback = self.feedback.torque(state, target)  # refuses bad numbers
        memory = self._sampled(memory, state)
        values = memory.values.reshape(len(self.names), -1)
        share = min(1.0, 1.0 / (0.3 * self.rate))  # a time constant of 0.3 s: as long as the estimate is late
        values = values + self._shortened(share * (memory.aim.reshape(values.shape) - values), SLEW / self.rate)
        q, v, a = (x.reshape(n, -1).T for x in (target.q, target.v, acceleration(target)))
        W = self._ahead.regressor(q, v, a)
        torque = self.feedback.known.driven(feedback + np.einsum("bnp,pb->nb", W, values).reshape(shape))
        memory = memory._replace(values=values.reshape(memory.values.shape), requested=torque.reshape(n, -1))
        return sound(torque, state, target), memory

    def estimate_of(self, memory: SelfTuningMemory, leg: int = 0) -> Estimate:
        """Estimate of what the recursive estimator of one leg knows, without the prior, with its findings."""
        return estimate_of(self.settings, memory.online[leg], Stream())

    def _sampled(self, memory: SelfTuningMemory, state: State) -> SelfTuningMemory:
        """Complete the previous sample by the torque that was held behind it; a complete block goes on."""
        n = self.settings.n
        held = memory.requested if state.last is None else state.last.reshape(n, -1)
        now = np.array([state.q.reshape(n, -1), state.v.reshape(n, -1), held])
        pending, before = memory.pending, memory.before
        if np.isfinite(before).all() and np.isfinite(held).all():
            complete = np.array([before[0], before[1], 0.5 * (before[2] + held)])
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
        """β* of one leg, within its bounds, (P,)."""
        prior = self._known.information.R[-1]  # [L  L β₀] with Lᵀ L = P₀⁻¹
        factor = np.asarray(np.linalg.qr(np.vstack([belief(self.settings, online), prior]), mode="r"))
        inverse, leg = np.linalg.inv(factor[:-1, :-1]), self.settings.model.leg
        found = inverse @ factor[:-1, -1]
        least = np.where(self.settings.model.nonnegative, np.minimum(self.source.values, 0.0), -np.inf)
        found = np.maximum(found, least)  # what began below zero, and is known too well to rise, holds up no other
        bodies = slice(len(leg.parameter_names))
        if leg.chain is None or not check_physical(leg, found[bodies]):  # in space the check is a lift, too
            found[bodies] = lift(leg, found[bodies], inverse[bodies] @ inverse[bodies].T).values
        way = self._shortened((found - self.source.values)[:, None], BOUND)
        return np.asarray(self.source.values + way[:, 0])

    def _shortened(self, way: FloatArray, most: float) -> FloatArray:
        """Shorten changes (P, B) so that none exceeds so many standard deviations of the prior."""
        longest = np.abs(way / self._known.std[:, None]).max(axis=0)
        return np.asarray(way * np.minimum(1.0, most / np.maximum(longest, 1e-300)))

    @cached_property
    def _ahead(self) -> TorqueModel:
        """Model of the feedforward, its sign as smooth as in other controllers."""
        model = self.settings.model
        terms = (replace(term, smoothing=WIDTH) if type(term) is Coulomb else term for term in model.terms)
        return replace(model, terms=tuple(terms))

    @cached_property
    def _known(self) -> OnlineState:
        """What is known before the first sample, as rows of a recursive estimator."""
        return started(self.settings, begin_online(self.settings), self.source)


def self_tuning(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    payload: float = 1.0,
    friction: float = 0.3,
    rate: float = RATE,
) -> SelfTuning:
    """Make a self-tuning controller from a model of the leg.

    Args:
        source: An estimate, whose covariance is part of the prior; or a leg, or a plant of one rig.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad], likewise.
        payload: Standard deviation of the mass that may be strapped to each link [kg].
        friction: Standard deviation of the change of each friction coefficient, relative to the coefficient.
        rate: Sampling rate [Hz].

    Returns:
        The controller; limit its torque by :class:`exoid.control.Limited`.

    Raises:
        ExoidError: A setting is out of range, or the source has no control model, or terms such as load friction, which
            a recursive estimate does not have.

    Example:
        >>> import exoid
        >>> law = self_tuning(exoid.load_leg("cuhk"), 60.0, 6.0)
        >>> law.names
        ('X1', 'Y1', 'J1', 'X2', 'Y2', 'J2')
    """
    feedback = pd(kp, kd, rate=rate)
    checked([payload, friction], "the expected changes", least=0.0)
    model = ControlModel.of(source)  # warns of what an estimate leaves open
    known = completed(source) if isinstance(source, Estimate) else exact_estimate(model)
    count = len(known.model.leg.parameter_names)
    covariance = known.covariance.copy()
    # The variance of a parameter that the recordings do not determine says nothing of what may change.
    unknown = [k for k, kind in enumerate(known.identifiability) if kind == "not"]
    covariance[unknown], covariance[:, unknown] = 0.0, 0.0
    covariance[:count, :count] += payload_covariance(known.model.leg, payload)
    rubbing = np.flatnonzero(known.model.friction)
    covariance[rubbing, rubbing] += (friction * known.values[rubbing]) ** 2
    # The cut-off is what the rate can carry. Noise of the angles costs the law more than a harmonic that is missing
    settings = Settings(model=known.model, rate=rate, cutoff=min(8.0, rate / 12.5), flat=False, passive=model.passive)
    return SelfTuning(replace(feedback, model=model), replace(known, covariance=covariance), settings)


def exact_estimate(model: ControlModel) -> Estimate:
    """Write a model of plain springs, friction and rotors as an estimate without errors: the torques are the same."""
    if model.others:
        what = f"self-tuning control of a model with {type(model.others[0].term).__name__}"
        raise NotSupportedError(what, remedy="pass the estimate")
    labels = np.array(model.leg.joint_labels)
    terms: list[Term] = [
        Stiffness(degree=len(powers) - 1 - int(np.flatnonzero(powers)[0]), joints=(str(label),))
        for label, powers in zip(labels, model.spring.T, strict=True)
        if powers.any()
    ]
    plain = ((Coulomb, model.coulomb), (Viscous, model.viscous), (Armature, model.armature))
    terms += [kind(joints=tuple(labels[values != 0.0].tolist())) for kind, values in plain if values.any()]
    torques = TorqueModel(model.leg, tuple(terms))
    q, v, a = random_motion(400, model.n, model.leg.closure)
    width = next((term.smoothing for term in terms if isinstance(term, Coulomb)), WIDTH)
    torque = model.inverse_dynamics(q.T, v.T, a.T) + model.friction(q.T, v.T, width)
    values = scaled_lstsq(torques.regressor(q, v, a).reshape(-1, len(torques.names)), torque.T.ravel())
    return Estimate(
        model=torques,
        values=values,
        covariance=np.zeros((len(values), len(values))),
        condition_number=1.0,
        dof=float(len(q)),
        residual_rms=np.ones(model.n),  # N·m, the torque's error at first
        estimator="known",
        preparation=FiniteDifference(),
    )
