"""Objective of the search: criterion of the predicted covariance plus a penalty for exceeded limits, with gradient."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.experiments.references import States
from exoid.leg.torso import TorsoMotion
from exoid.torques import TorqueModel

from .fourier import Basis
from .limits import MotionLimits
from .scales import Scales, TorqueNoise

Criterion = Literal["worst", "a", "d"]

STEPS = (1e-5, 1e-5, 1e-3)
"""Steps of the central differences of the regressor by q, v and a."""

NEAR = 0.1
"""Unit of clearance in the penalty [m]."""


class Demand(NamedTuple):
    """What a motion demands, at N samples."""

    columns: FloatArray  # rows of scaled parameters that count, zero in dead bands, (P, k, N)
    # relative margin to each limit of the ground, negative where it is exceeded, (C, N)
    margins: FloatArray


class Stage(NamedTuple):
    """Settings of one stage of the search."""

    # power p of the mean (Σ r_i^p)^(1/p) of the relative variances r_i: 1 for A-optimality, large for the worst
    # parameter alone, 0 for D-optimality (the mean of the logarithms of the eigenvalues)
    power: float
    penalty: float  # weight of the penalty
    iterations: int = 60  # largest number


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionObjective(ABC):
    """J(x) = ½ ln (Σ_i (cov_ii / scale_i²)^p)^(1/p) + penalty · mean of squared excesses, for one motion or several."""

    # With ½ ln a change of J is the relative change of the standard deviations. x are the coefficients of one motion
    # for each tilt of a torso that is held, or for each support of a machine on the ground.

    basis: Basis  # basis functions of the motions
    noise: TorqueNoise  # torque noise
    seconds: float  # duration of each motion [s]
    rate: float  # rate of the log [Hz]
    prior_information: FloatArray  # information of other data about scaled parameters, (P, P)
    limit_names: ClassVar[tuple[str, ...]]
    pitches: FloatArray  # tilt of the torso in each motion [rad], (T,)

    def __call__(self, x: FloatArray, stage: Stage) -> tuple[float, FloatArray]:
        """Value and gradient at flattened coefficients."""
        motions = [self.basis.states(each) for each in self.coefficients(x)]
        demands = [self.demand(k, states) for k, states in enumerate(motions)]
        weights = [self.weight(k) for k in range(len(motions))]
        information = self.prior_information + sum(
            np.einsum("pjt,qjt->pq", W if weight is None else W * weight, W, optimize=True)
            for (W, _), weight in zip(demands, weights, strict=True)
        )
        value, by_information = criterion_value(information, stage.power)
        gradient = []
        for k, (states, one, weight) in enumerate(zip(motions, demands, weights, strict=True)):
            adjoint = 2.0 * np.tensordot(by_information, one.columns, axes=1)
            adjoint = adjoint if weight is None else adjoint * weight
            excess, slopes = self.slopes(k, states, one, adjoint, stage.penalty)
            value += stage.penalty * excess
            gradient.append(self.basis.coefficient_gradient(slopes).ravel())
        return value, np.concatenate(gradient)

    @property
    @abstractmethod
    def machine(self) -> str:
        """Name of the leg or machine."""

    @abstractmethod
    def coefficients(self, x: FloatArray) -> Sequence[FloatArray]:
        """Split flattened coefficients into those of each motion, as views."""

    @abstractmethod
    def demand(self, number: int, states: States) -> Demand:
        """Compute what a motion demands."""

    def weight(self, number: int) -> FloatArray | None:
        """Information of one sample of the basis about each row, (k, 1); None for rows that are over their noise."""
        return None

    @abstractmethod
    def slopes(
        self, number: int, states: States, demand: Demand, adjoint: FloatArray, penalty: float
    ) -> tuple[float, States]:
        """Mean squared excess, and the gradient by samples, given that of the criterion by columns."""

    @abstractmethod
    def excesses_of(self, number: int, states: States) -> FloatArray:
        """Compute the mean squared excess over each limit."""

    @abstractmethod
    def draw(self, rng: np.random.Generator) -> FloatArray:
        """Draw coefficients from which a search begins."""

    @abstractmethod
    def narrowed(self) -> MotionObjective:
        """Narrow the limits by what the search reserves for values between its samples."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Objective(MotionObjective):
    """Objective for a leg whose torso is held at some tilts; poses may be known already."""

    model: TorqueModel  # leg and terms
    limits: MotionLimits  # motion limits
    scales: Scales  # scales of the standard deviations
    limit_names = ("angle", "velocity", "acceleration", "torque", "clearance")

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of x, (T, m, n)."""
        return len(self.pitches), self.basis.count, len(self.limits.lower)

    def demand(self, number: int, states: States) -> Demand:
        """Compute the regressor of scaled parameters; rows in a dead band are zero."""
        W = self._regressor(states, float(self.pitches[number]))
        W *= self.scales.scale[:, None, None]
        return Demand(np.asarray(W * self.model.usable(states.v).T), np.empty((0, len(states.q))))

    def weight(self, number: int) -> FloatArray:
        """Information of one sample of the basis about each joint, (n, 1)."""
        share = self.rate * self.seconds / len(self.basis.position)  # samples of the log per sample of the basis
        return np.asarray(share / self.noise.per_sample(self.rate) ** 2)[:, None]

    def slopes(
        self, number: int, states: States, demand: Demand, adjoint: FloatArray, penalty: float
    ) -> tuple[float, States]:
        """Mean squared excess, and the gradient by samples, through the columns of the regressor."""
        pitch = float(self.pitches[number])
        parts = self._parts(states, np.einsum("pjt,p->tj", demand.columns, self._beta), pitch)
        angle, speed, acceleration, torque, clearance = parts
        by_states = States(angle.slope + clearance.slope, speed.slope, acceleration.slope)
        by_columns = self._beta[:, None, None] * torque.slope.T
        inner = self._through_regressor(states, adjoint + penalty * by_columns, pitch)
        slopes = States(*(s + penalty * e for s, e in zip(inner, by_states, strict=True)))
        return sum(part.mean for part in parts), slopes

    def _regressor(self, states: States, pitch: float) -> FloatArray:
        if self.model.leg.closure is not None:  # beyond the limits, loops may not close; the penalty leads back
            states = states._replace(q=np.clip(states.q, self.limits.lower, self.limits.upper))
        return self.model.regressor(*states, TorsoMotion(pitch=pitch) if pitch else None).transpose(2, 1, 0)

    def _through_regressor(self, states: States, adjoint: FloatArray, pitch: float) -> States:
        """Gradient by samples, given that by columns: Σ_pj adjoint_pjt ∂W_pjt / ∂(q, v, a)_t, in one batch."""
        count, n = states.q.shape
        shape = (len(STEPS), n, 2, count, n)  # quantity, joint, direction, sample, joint
        moved = States(*(np.broadcast_to(x, shape).copy() for x in states))
        for part, step in enumerate(STEPS):
            for joint in range(n):
                moved[part][part, joint, :, :, joint] += np.array([step, -step])[:, None]
        W = self._regressor(States(*(x.reshape(-1, n) for x in moved)), pitch)
        raw = adjoint * self.scales.scale[:, None, None] * self.model.usable(states.v).T
        slopes = np.einsum("pjxist,pjt->xsti", W.reshape(*W.shape[:2], *shape[:4]), raw, optimize=True)
        return States(*((up - down) / (2.0 * step) for (up, down), step in zip(slopes, STEPS, strict=True)))

    @property
    def machine(self) -> str:
        """Name of the leg."""
        return self.model.leg.description.name

    def coefficients(self, x: FloatArray) -> Sequence[FloatArray]:
        """Split coefficients, a motion for each tilt."""
        return tuple(x.reshape(self.shape))

    def excesses_of(self, number: int, states: States) -> FloatArray:
        """Compute the mean squared excess over each limit."""
        tau = np.einsum("pjt,p->tj", self.demand(number, states).columns, self._beta)
        return np.array([part.mean for part in self._parts(states, tau, float(self.pitches[number]))])

    def draw(self, rng: np.random.Generator) -> FloatArray:
        """Draw coefficients, and scale those of each joint to 50 to 95 % of its limits."""
        limits, basis = self.limits, self.basis
        x = rng.standard_normal(self.shape)
        for each in x:
            q, v, a = (part[:, 1:] @ each[1:] for part in (basis.position, basis.velocity, basis.acceleration))
            factors = np.array(
                [
                    limits.span / np.ptp(q, axis=0),
                    limits.velocity / np.abs(v).max(axis=0),
                    limits.acceleration / np.abs(a).max(axis=0),
                ]
            )
            scale = rng.uniform(0.5, 0.95) * factors.min(axis=0)
            each[1:] *= scale
            middle = 0.5 * scale * (q.max(axis=0) + q.min(axis=0))
            left = limits.span - scale * np.ptp(q, axis=0)
            each[0] = 0.5 * (limits.lower + limits.upper) - middle + 0.3 * left * rng.uniform(-1.0, 1.0, left.shape)
        return x.ravel()

    def narrowed(self) -> Objective:
        """Narrow the limits by the reserve of the search."""
        return replace(self, limits=narrowed_limits(self.limits))

    @property
    def _beta(self) -> FloatArray:
        """Expected parameters over their scales."""
        return self.scales.expected / self.scales.scale

    def _parts(self, states: States, tau: FloatArray, pitch: float) -> tuple[Excess, ...]:
        boxes = box_excesses(self.limits, states)
        return *boxes, beyond(tau, self.limits.torque), self._too_near(states.q, pitch)

    def _too_near(self, q: FloatArray, pitch: float) -> Excess:
        """Missing clearance of the points of the foot, in units of :data:`NEAR`."""
        clearance, leg, slope = self.limits.clearance, self.model.leg, np.zeros_like(q)
        if clearance is None:
            return Excess(0.0, slope)
        short = np.minimum(clearance.margin(leg, q, pitch), 0.0) / NEAR
        if short.any():
            by_angle = clearance.margin_derivative(leg, q, pitch) / NEAR
            slope = 2.0 * np.einsum("tc,jtc->tj", short, by_angle) / len(q)
        return Excess(float((short**2).sum() / len(q)), slope)


def narrowed_limits(limits: MotionLimits) -> MotionLimits:
    """Narrow limits by what the search reserves for values between its samples."""
    margin = 0.004  # fraction of each limit
    gap, less = margin * limits.span, 1.0 - margin
    return replace(
        limits,
        lower=limits.lower + gap,
        upper=limits.upper - gap,
        velocity=less * limits.velocity,
        acceleration=less * limits.acceleration,
        torque=less * limits.torque,
        clearance=limits.clearance and replace(limits.clearance, distance=limits.clearance.distance + 0.003),
    )


class Excess(NamedTuple):
    """Mean squared excess over a limit, and its derivative by the limited quantity, (N, n)."""

    mean: float
    slope: FloatArray


def beyond(x: FloatArray, limit: FloatArray) -> Excess:
    """Compute the mean squared excess of sizes over a limit."""
    part = np.maximum(np.abs(x) / limit - 1.0, 0.0)
    return Excess(float((part**2).sum() / len(x)), 2.0 * part * np.sign(x) / limit / len(x))


def box_excesses(limits: MotionLimits, states: States) -> tuple[Excess, Excess, Excess]:
    """Compute the excesses of angles, velocities and accelerations."""
    middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * limits.span
    return beyond(states.q - middle, half), beyond(states.v, limits.velocity), beyond(states.a, limits.acceleration)


def criterion_value(information: FloatArray, power: float) -> tuple[float, FloatArray]:
    """Compute the criterion of an information matrix, see :class:`Stage`."""
    count = len(information)
    eigenvalues, vectors = np.linalg.eigh(information)
    eigenvalues = np.maximum(eigenvalues, 1e-12 * eigenvalues[-1])  # so that the criterion is always finite
    covariance = (vectors / eigenvalues) @ vectors.T
    if power == 0.0:
        return float(-0.5 * np.log(eigenvalues).sum() / count), -0.5 * covariance / count
    r = np.diag(covariance)
    largest = r.max()
    total = ((r / largest) ** power).sum()
    value = 0.5 * (np.log(largest) + np.log(total) / power)
    share = (r / largest) ** power / total / r
    return float(value), -0.5 * (covariance * share) @ covariance
