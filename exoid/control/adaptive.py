"""Adaptive control by Slotine and Li: PD with feedforward, whose parameters follow the leg while it moves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import UnreadableInputError
from exoid.leg.joint_numbers import for_joints
from exoid.rig import Target
from exoid.tools.numbers import checked

from .law import RATE, State, acceleration, gains, refuse_rate
from .model import ModelSource
from .parameter_change import ExpectedChange, regular
from .parameter_cone import FLOOR, ParameterCone
from .slotine_li import SlotineLiModel


class AdaptiveMemory(NamedTuple):
    """Memory of an adaptive controller, for one leg or B."""

    values: FloatArray  # parameters β in the order of `law.names`, (P,) or (P, B)
    requested: FloatArray  # torque requested at the previous sample [N·m], (n,) or (n, B); NaN before the first


@dataclass(frozen=True, eq=False)
class Adaptive:
    """τ = Y(q, v, v_r, a_r) β̂ − Kd s, β̂' = −γ P Yᵀ s, a :class:`exoid.control.StatefulLaw`."""

    # v_r = θ̇_d + Λ (θ_d − q), a_r = θ̈_d + Λ (θ̇_d − v), s = v − v_r and Λ = Kp / Kd, so that −Kd s is PD
    # feedback (J.-J. E. Slotine, W. Li, IJRR 6(3), 1987). P is the covariance of the estimate and of the
    # expected changes, so parameters that may have changed follow first. With β̃ = β̂ − β, in continuous time
    # and without the precautions below,
    #
    #     V = ½ γ sᵀ M s + ½ β̃ᵀ P⁻¹ β̃,    V' ≤ −γ sᵀ Kd s.
    #
    # Precautions against noise, friction at rest and limits: a dead zone of s; a joint that stands, by target
    # or measurement, teaches nothing; neither does one whose torque was limited; β̂ stays in a `ParameterCone`,
    # in which M(q) is positive definite and friction is not negative. Nobody may wear or touch the leg: the
    # controller would take their torque for parameters of the leg.

    model: SlotineLiModel  # linear model, initial values and covariance
    kp: FloatArray  # Kp [N·m/rad], a number or (n,)
    kd: FloatArray  # Kd [N·m·s/rad], likewise
    cone: ParameterCone  # set of the parameters
    time_constant: float  # time in which the error of the worst expected change decays, about [s]
    dead_zone: ArrayLike  # half width of the dead zone of s [rad/s], a number or (n,)
    still: ArrayLike  # velocity below which a joint stands [rad/s], a number or (n,)
    rate: float  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check the settings."""
        refuse_rate(self.rate)
        for name in ("kp", "kd", "dead_zone", "still"):
            object.__setattr__(self, name, for_joints(gains(getattr(self, name), name), self.model.n, name))
        for name in ("kp", "kd", "time_constant"):  # adaptation needs both gains
            checked(getattr(self, name), name, above=0.0)

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
        """Begin with the initial values."""
        values = np.tile(self.start[:, None], state.q.reshape(self.model.n, -1).shape[1])
        return AdaptiveMemory(values.reshape(-1, *state.q.shape[1:]), np.full_like(state.q, np.nan))

    def step(self, memory: AdaptiveMemory, state: State, target: Target) -> tuple[FloatArray, AdaptiveMemory]:
        """Compute the torque, and adapt the parameters; see the class."""
        shape, n = state.q.shape, self.model.n
        q, v, q_d, v_d, a_d, requested = (
            x.reshape(n, -1) for x in (state.q, state.v, target.q, target.v, acceleration(target), memory.requested)
        )
        kd, slope = self.kd[:, None], (self.kp / self.kd)[:, None]
        v_r, a_r = v_d + slope * (q_d - q), a_d + slope * (v_d - v)
        s = v - v_r
        Y = self.model.regressor(q, v, v_r, a_r)
        values = memory.values.reshape(len(self.names), -1).T
        torque = np.einsum("bnp,bp->nb", Y, values) + self.model.fixed(q, v_r, a_r) - kd * s
        moving = (np.abs(v_d) >= np.asarray(self.still)[:, None]) & (np.abs(v) >= np.asarray(self.still)[:, None])
        if state.last is not None:  # the difference that a limit makes is not the leg's
            moving &= ~(np.abs(state.last.reshape(n, -1) - requested) > 1e-6)
        zone = np.asarray(self.dead_zone)[:, None]
        change = np.einsum("bnp,nb->bp", Y, (s - np.clip(s, -zone, zone)) * moving)
        learned = values - self.gain / self.rate * change @ self.model.covariance
        learned = self._project(learned, values)
        return torque.reshape(shape), AdaptiveMemory(learned.T.reshape(-1, *shape[1:]), torque.reshape(shape))

    def estimate_of(self, memory: AdaptiveMemory) -> dict[str, float]:
        """Parameters of one leg in SI units, by name."""
        return dict(zip(self.names, np.ravel(memory.values).tolist(), strict=True))

    def _project(self, values: FloatArray, before: FloatArray) -> FloatArray:
        """Project the parameters of each leg on the cone, (B, P)."""
        if not np.isfinite(values).all():
            raise UnreadableInputError(
                "a reading, a target or a held torque is not finite",
                remedy="stop the leg, and begin again with good readings",
            )
        found = values.copy()
        for leg in np.flatnonzero((values != before).any(axis=1)):
            found[leg] = self.cone.nearest(values[leg], self.metric)
        return found

    @cached_property
    def metric(self) -> FloatArray:
        """Matrix L of the metric P⁻¹ = Lᵀ L, upper triangular, (P, P)."""
        scale = np.sqrt(np.diagonal(self.model.covariance))  # parameters have different units
        scale = np.outer(scale, scale)
        inverse = np.linalg.inv(self.model.covariance / scale)
        inverse = 0.5 * (inverse + inverse.T) / scale  # rounding must not depend on the triangle that is read
        return np.asarray(np.linalg.cholesky(inverse).T)

    @cached_property
    def start(self) -> FloatArray:
        """Parameters at the beginning, (P,)."""
        return self.cone.nearest(self.model.values, self.metric)


def adaptive(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    change: ExpectedChange | None = None,
    time_constant: float = 0.05,
    dead_zone: ArrayLike = 0.03,
    still: ArrayLike = 0.05,
    rate: float = RATE,
) -> Adaptive:
    """Make a controller that adapts its parameters, by Slotine and Li, from a model of the leg.

    Args:
        source: An estimate, whose covariance is part of the metric; or a leg, or a plant of one rig. Parameters that
            the estimate does not determine change only as ``change`` says.
        kp: Kp [N·m/rad], a number or one for each joint, positive.
        kd: Kd [N·m·s/rad], likewise.
        change: Standard deviations of what may change; None for a payload of 1 kg on each link, and 30 % of friction.
        time_constant: Time constant of the adaptation, about [s].
        dead_zone: Half width of the dead zone of s [rad/s]; 0.03 is three times the noise of a tachometer.
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
    model = SlotineLiModel.of(source, change or ExpectedChange())
    cone = ParameterCone.of(model.model.leg, model.positive)
    model = replace(model, covariance=regular(model.covariance, model.values))
    law = Adaptive(model, gains(kp, "kp"), gains(kd, "kd"), cone, time_constant, dead_zone, still, rate)
    nearest, count = law.start, len(model.model.leg.parameter_names)
    floor = np.append(FLOOR * nearest[:count], np.where(model.positive, 0.0, nearest[count:]))
    return replace(law, model=replace(model, values=nearest), cone=cone.above(floor))
