"""Adaptive control by Slotine and Li: PD with feedforward, whose parameters follow the leg while it moves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

from .law import RATE, State, acceleration, gains, refuse_rate
from .model import ModelSource
from .parameter_change import ExpectedChange, regular
from .parameter_cone import FLOOR, ParameterCone
from .slotine_li import SlotineLiModel, refuse_unknown_covariance
from .torque_prediction import PredictionMemory, TorquePrediction

TIME_CONSTANT = 0.5
"""Default time constant of the adaptation [s]."""

DEAD_ZONE = 0.03
"""Default dead zone of s [rad/s]: three times the noise of a tachometer."""

STILL = 0.05
"""Default velocity below which a joint stands [rad/s]."""

LIMITED = 1e-6
"""Difference of requested and held torque at which a limit acts [N·m]."""

FAR = 100.0
"""Standard deviations between a parameter without bounds and its floor, which is free: from zero rounding is larger."""

CHANGE = ExpectedChange()
"""Default of the expected changes."""

PREDICTION = TorquePrediction()
"""Default prediction error."""


class AdaptiveMemory(NamedTuple):
    """Memory of an adaptive controller, for one leg or B."""

    values: FloatArray  # parameters β in the order of `law.names`, (P,) or (P, B)
    requested: FloatArray  # torque requested at the previous sample [N·m], (n,) or (n, B); NaN before the first
    prediction: PredictionMemory | None = None  # memory of the composite adaptation; None without


@dataclass(frozen=True, eq=False)
class Adaptive:
    """τ = Y(q, v, v_r, a_r) β̂ − Kd s, β̂' = −P (γ Yᵀ s + WᵀR e), a :class:`exoid.control.StatefulLaw`.

    v_r = θ̇_d + Λ (θ_d − q), a_r = θ̈_d + Λ (θ̇_d − v), s = v − v_r and Λ = Kp / Kd, so that −Kd s is PD feedback. Without
    ``prediction`` e is absent and P is constant (J.-J. E. Slotine, W. Li, IJRR 6(3), 1987). With it, adaptation is
    composite: e is the :class:`exoid.control.TorquePrediction` error and P⁻¹ the information (J.-J. E. Slotine, W. Li,
    Automatica 25(4), 1989). P begins with the covariance of the estimate and of the expected changes, so parameters
    that may have changed follow first. With β̃ = β̂ − β, in continuous time and without the precautions below,

        V = ½ γ sᵀ M s + ½ β̃ᵀ P⁻¹ β̃,    V' ≤ −γ sᵀ Kd s − ½ eᵀ R e.

    Precautions against noise, friction at rest and limits: a dead zone of s; a joint that stands, by target or
    measurement, teaches nothing; neither does one whose torque was limited; β̂ stays in a :class:`ParameterCone`, in
    which M(q) is positive definite and friction is not negative. Nobody may wear or touch the leg: the controller would
    take their torque for parameters of the leg.

    Attributes:
        model: Linear model, initial values and covariance.
        kp: Kp [N·m/rad], a number or (n,).
        kd: Kd [N·m·s/rad], likewise.
        cone: Set of the parameters.
        prediction: Prediction error of composite adaptation; None for Slotine and Li's first controller.
        time_constant: Time in which the error of the worst expected change decays, about [s].
        dead_zone: Half width of the dead zone of s [rad/s], a number or (n,).
        still: Velocity below which a joint stands [rad/s], a number or (n,).
        rate: Sampling rate [Hz].

    Raises:
        ExoidError: A gain, time, velocity or rate is out of range, or no parameter may change.
    """

    model: SlotineLiModel
    kp: FloatArray
    kd: FloatArray
    cone: ParameterCone
    prediction: TorquePrediction | None = None
    time_constant: float = TIME_CONSTANT
    dead_zone: ArrayLike = DEAD_ZONE
    still: ArrayLike = STILL
    rate: float = RATE

    def __post_init__(self) -> None:
        """Check the settings."""
        refuse_rate(self.rate)
        refuse_unknown_covariance(self.model.covariance)
        for name in ("kp", "kd", "dead_zone", "still"):
            value = gains(getattr(self, name), name)
            if value.shape not in ((), (self.model.n,)):
                raise ExoidError(
                    f"{name} of shape {value.shape} for {self.model.n} joints",
                    remedy="give one number, or one for each joint",
                )
            object.__setattr__(self, name, np.broadcast_to(value, (self.model.n,)))
        if not (self.kp > 0.0).all() or not (self.kd > 0.0).all() or not 0.0 < self.time_constant < np.inf:
            raise ExoidError(
                f"kp = {self.kp}, kd = {self.kd}, time constant {self.time_constant:g} s",
                remedy="give positive gains and a positive time in s; adaptation needs both gains",
            )
        if not isinstance(self.prediction, TorquePrediction | None):
            raise ExoidError(f"prediction = {self.prediction!r}", remedy="give a TorquePrediction, or None")
        if self.prediction is not None:
            self.prediction.filter(self.rate)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the adapted parameters, (P,)."""
        return self.model.names

    @cached_property
    def gain(self) -> float:
        """Factor γ of Yᵀ s: the largest expected change of s has the time constant, in the mean over poses."""
        q = np.random.default_rng(0).uniform(-1.0, 1.0, (self.model.n, 20))
        Y = self.model.regressor(q, np.zeros_like(q), np.full_like(q, 0.5), np.zeros_like(q))
        Y = Y / np.sqrt(self.kd)[:, None]
        largest = np.linalg.eigvalsh(Y @ self.model.covariance @ Y.transpose(0, 2, 1))[:, -1]
        return float(1.0 / (self.time_constant * largest.mean()))

    def begin(self, state: State) -> AdaptiveMemory:
        """Begin with the initial values.

        Args:
            state: Measured state at the first sample, (n,) or (n, B).

        Returns:
            Memory before the first sample.
        """
        columns = _columns(state)
        values = np.tile(self.start[:, None], columns.q.shape[1])
        after = None if self.prediction is None else self.prediction.begin(columns, self.initial_information, self.rate)
        return AdaptiveMemory(values.reshape(-1, *state.q.shape[1:]), np.full_like(state.q, np.nan), after)

    def step(self, memory: AdaptiveMemory, state: State, target: Target) -> tuple[FloatArray, AdaptiveMemory]:
        """Compute the torque, and adapt the parameters; see the class.

        Args:
            memory: Memory from the previous sample.
            state: Measured state, (n,) or (n, B).
            target: Reference at this moment, likewise.

        Returns:
            Torque [N·m], of the shape of ``state.q``, and the memory for the next sample.

        Raises:
            ExoidError: The target has no acceleration.
        """
        shape, now = state.q.shape, _columns(state)
        kd, slope = self.kd[:, None], (self.kp / self.kd)[:, None]
        aim = [x.reshape(self.model.n, -1) for x in (target.q, target.v, acceleration(target))]
        v_r = aim[1] + slope * (aim[0] - now.q)
        a_r = aim[2] + slope * (aim[1] - now.v)
        s = now.v - v_r
        Y = self.model.regressor(now.q, now.v, v_r, a_r)
        values = memory.values.reshape(len(self.names), -1).T
        torque = np.einsum("bnp,bp->nb", Y, values) + self.model.fixed(now.q, v_r, a_r) - kd * s
        usable = self._usable(memory.requested.reshape(now.q.shape), now, aim[1])
        zone = np.asarray(self.dead_zone)[:, None]
        learning = (s - np.clip(s, -zone, zone)) * usable
        change = self.gain / self.rate * np.einsum("bnp,nb->bp", Y, learning)
        after = memory.prediction
        if self.prediction is not None and after is not None:
            found = self.prediction.learn(after, self.model, values, now, self.initial_information, usable, self.rate)
            after, change = found.memory, change + found.gradient
        learned = self._project(values - self._gained(change, after), values, after)
        return torque.reshape(shape), AdaptiveMemory(learned.T.reshape(-1, *shape[1:]), torque.reshape(shape), after)

    def estimate_of(self, memory: AdaptiveMemory) -> dict[str, float]:
        """Read the parameters of one leg.

        Args:
            memory: Memory of one leg.

        Returns:
            Values in SI units by name.
        """
        return dict(zip(self.names, np.ravel(memory.values).tolist(), strict=True))

    def _usable(self, requested: FloatArray, state: State, v_d: FloatArray) -> NDArray[np.bool_]:
        """Joints that move and whose torque was not limited, (n, B)."""
        slowest = np.asarray(self.still)[:, None]
        moving = (np.abs(v_d) >= slowest) & (np.abs(state.v) >= slowest)
        if state.last is None:
            return moving
        return np.asarray(moving & ~(np.abs(state.last - requested) > LIMITED))

    def _gained(self, change: FloatArray, after: PredictionMemory | None) -> FloatArray:
        """P times a gradient, (B, P), by a solution: an inverse of the information would be less accurate."""
        if after is None:
            return np.asarray(change @ self.model.covariance)
        scale = np.sqrt(np.diagonal(after.information, axis1=1, axis2=2))  # parameters have different units
        scaled = after.information / (scale[:, :, None] * scale[:, None, :])
        return np.asarray(np.linalg.solve(scaled, (change / scale)[..., None])[..., 0] / scale)

    def _project(self, values: FloatArray, before: FloatArray, after: PredictionMemory | None) -> FloatArray:
        """Project the parameters of each leg on the cone, (B, P)."""
        if not np.isfinite(values).all():
            raise ExoidError(
                "a reading, a target or a held torque is not finite",
                remedy="stop the leg, and begin again with good readings",
            )
        found = values.copy()
        for leg in np.flatnonzero((values != before).any(axis=1)):
            whiten = self.metric if after is None else np.linalg.cholesky(after.information[leg]).T
            found[leg] = self.cone.nearest(values[leg], whiten)
        return found

    @cached_property
    def initial_information(self) -> FloatArray:
        """Inverse of the covariance, (P, P)."""
        scale = np.sqrt(np.diagonal(self.model.covariance))  # parameters have different units
        scale = np.outer(scale, scale)
        inverse = np.linalg.inv(self.model.covariance / scale)
        return np.asarray(0.5 * (inverse + inverse.T) / scale)  # rounding must not depend on the triangle that is read

    @cached_property
    def metric(self) -> FloatArray:
        """Matrix L of the metric at the beginning, upper triangular, LᵀL the inverse of the covariance, (P, P)."""
        return np.asarray(np.linalg.cholesky(self.initial_information).T)

    @cached_property
    def start(self) -> FloatArray:
        """Parameters at the beginning, (P,)."""
        return self.cone.nearest(self.model.values, self.metric)


def adaptive(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    change: ExpectedChange = CHANGE,
    prediction: TorquePrediction | None = PREDICTION,
    time_constant: float = TIME_CONSTANT,
    dead_zone: ArrayLike = DEAD_ZONE,
    still: ArrayLike = STILL,
    rate: float = RATE,
) -> Adaptive:
    """Make an :class:`Adaptive` controller from a model of the leg.

    Args:
        source: An estimate, whose covariance is part of the metric; or a leg, or a plant of one rig.
        kp: Kp [N·m/rad], a number or one for each joint, positive.
        kd: Kd [N·m·s/rad], likewise.
        change: Standard deviations of what may change: payloads and friction.
        prediction: Prediction error of composite adaptation; None for Slotine and Li's first controller.
        time_constant: Time constant of the adaptation, about [s].
        dead_zone: Half width of the dead zone of s [rad/s].
        still: Velocity below which a joint stands [rad/s].
        rate: Sampling rate [Hz].

    Returns:
        The controller; limit its torque by :class:`exoid.control.Limited`.

    Raises:
        ExoidError: A setting is out of range, no parameter may change, or the source has no control model.

    Example:
        >>> import exoid
        >>> law = adaptive(exoid.load_leg("cuhk"), 60.0, 6.0)
        >>> law.names
        ('X1', 'Y1', 'J1', 'X2', 'Y2', 'J2')
    """
    model = SlotineLiModel.of(source, change)
    cone = ParameterCone.of(model.model.leg, model.positive)
    refuse_unknown_covariance(model.covariance)
    model = replace(model, covariance=regular(model.covariance, model.values))
    law = Adaptive(model, gains(kp, "kp"), gains(kd, "kd"), cone, prediction, time_constant, dead_zone, still, rate)
    nearest, count = law.start, len(model.model.leg.parameter_names)
    near = nearest - FAR * np.sqrt(np.diagonal(model.covariance))
    floor = np.append(FLOOR * nearest[:count], np.where(model.positive, 0.0, near[count:]))
    return replace(law, model=replace(model, values=nearest), cone=cone.above(floor))


def _columns(state: State) -> State:
    """State as columns, (n, B)."""
    n = len(state.q)
    last = None if state.last is None else state.last.reshape(n, -1)
    return State(state.q.reshape(n, -1), state.v.reshape(n, -1), state.time, last)
