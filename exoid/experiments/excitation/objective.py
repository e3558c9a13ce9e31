"""Objective of the search: criterion of the predicted covariance plus a penalty for exceeded limits, with gradient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.leg.torso import TorsoMotion
from exoid.torques import TorqueModel

from .fourier import Basis, States
from .limits import MotionLimits
from .noise import TorqueNoise
from .scales import Scales

Criterion = Literal["worst", "a", "d"]

STEPS = (1e-5, 1e-5, 1e-3)
"""Steps of the central differences of the regressor by q, v and a."""

RIDGE = 1e-12
"""Smallest eigenvalue of the information over the largest, so that the criterion is always finite."""

EXCESSES = ("angle", "velocity", "acceleration", "torque", "clearance")
"""Names of the limits."""

NEAR = 0.1
"""Unit of clearance in the penalty [m]."""

MARGIN = 0.004
"""Fraction of each limit that the search reserves for values between its samples."""

GAP = 0.003
"""Additional clearance of the foot in the search [m]."""


class Stage(NamedTuple):
    """Settings of one stage of the search."""

    # power p of the mean (Σ r_i^p)^(1/p) of the relative variances r_i: 1 for A-optimality, large for the worst
    # parameter alone, 0 for D-optimality (the mean of the logarithms of the eigenvalues)
    power: float
    penalty: float  # weight of the penalty


@dataclass(frozen=True, eq=False)
class Objective:
    """J(x) = ½ ln (Σ_i (cov_ii / scale_i²)^p)^(1/p) + penalty · mean of squared excesses."""

    # With ½ ln a change of J is the relative change of the standard deviations. x are the coefficients of one
    # motion for each torso tilt, (T, m, n).

    model: TorqueModel  # leg and terms
    basis: Basis  # basis functions of the motions
    pitches: FloatArray  # tilt of the torso in each motion [rad], (T,)
    limits: MotionLimits  # motion limits
    noise: TorqueNoise  # torque noise
    scales: Scales  # scales of the standard deviations
    seconds: float  # duration of each motion [s]
    rate: float  # rate of the log [Hz]
    prior_information: FloatArray  # information of other data (poses) about scaled parameters, (P, P)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of x, (T, m, n)."""
        return len(self.pitches), self.basis.count, len(self.limits.lower)

    def __call__(self, x: FloatArray, stage: Stage) -> tuple[float, FloatArray]:
        """Value and gradient at flattened coefficients."""
        motions = [self.basis.states(each) for each in self.coefficients(x)]
        columns = [self._columns(states, pitch) for states, pitch in zip(motions, self.pitches, strict=True)]
        weight = self._row_weight()
        information = self.prior_information + sum(
            np.einsum("pjt,qjt->pq", W * weight[:, None], W, optimize=True) for W in columns
        )
        value, by_information = criterion_value(information, stage.power)
        gradient = np.empty(self.shape)
        for k, (states, W, pitch) in enumerate(zip(motions, columns, self.pitches, strict=True)):
            adjoint = 2.0 * weight[:, None] * np.einsum("pq,qjt->pjt", by_information, W, optimize=True)
            excess, by_states, by_columns = self._penalty(states, W, float(pitch))
            value += stage.penalty * excess
            slopes = self._through_regressor(states, adjoint + stage.penalty * by_columns, float(pitch))
            whole = States(*(s + stage.penalty * e for s, e in zip(slopes, by_states, strict=True)))
            gradient[k] = self.basis.coefficient_gradient(whole)
        return value, gradient.ravel()

    def _row_weight(self) -> FloatArray:
        """Information of one sample of the basis about each joint, (n,)."""
        return self.rate * self.seconds / len(self.basis.position) / self.noise.per_sample(self.rate) ** 2

    def _columns(self, states: States, pitch: float) -> FloatArray:
        """Regressor of scaled parameters, (P, n, N); rows in a dead band are zero."""
        W = self._regressor(states, pitch)
        W *= self.scales.scale[:, None, None]
        return np.asarray(W * self.model.usable(states.v).T)

    def _regressor(self, states: States, pitch: float) -> FloatArray:
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

    def excesses(self, states: States, pitch: float) -> FloatArray:
        """Compute the mean squared excess over each of the limits :data:`EXCESSES`."""
        tau = np.einsum("pjt,p->tj", self._columns(states, pitch), self._beta)
        return np.array([part.mean for part in self._parts(states, tau, pitch)])

    def excess(self, states: States, pitch: float) -> float:
        """Compute the mean squared excess over all limits."""
        return float(self.excesses(states, pitch).sum())

    @property
    def machine(self) -> str:
        """Name of the leg."""
        return self.model.leg.description.name

    @property
    def limit_names(self) -> tuple[str, ...]:
        """Names of the limits."""
        return EXCESSES

    def coefficients(self, x: FloatArray) -> Sequence[FloatArray]:
        """Split coefficients."""
        return tuple(x.reshape(self.shape))

    def excesses_of(self, number: int, states: States) -> FloatArray:
        """Compute the mean squared excess over each limit."""
        return self.excesses(states, float(self.pitches[number]))

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

    def _penalty(self, states: States, W: FloatArray, pitch: float) -> tuple[float, States, FloatArray]:
        """Mean squared excess, and its gradient by samples and by columns of the regressor."""
        parts = self._parts(states, np.einsum("pjt,p->tj", W, self._beta), pitch)
        angle, speed, acceleration, torque, clearance = parts
        by_states = States(angle.slope + clearance.slope, speed.slope, acceleration.slope)
        return sum(part.mean for part in parts), by_states, self._beta[:, None, None] * torque.slope.T

    def _parts(self, states: States, tau: FloatArray, pitch: float) -> tuple[Excess, ...]:
        limits, (q, v, a) = self.limits, states
        middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * limits.span
        return (
            beyond(q - middle, half),
            beyond(v, limits.velocity),
            beyond(a, limits.acceleration),
            beyond(tau, limits.torque),
            self._too_near(q, pitch),
        )

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
    gap, less = MARGIN * limits.span, 1.0 - MARGIN
    return replace(
        limits,
        lower=limits.lower + gap,
        upper=limits.upper - gap,
        velocity=less * limits.velocity,
        acceleration=less * limits.acceleration,
        torque=less * limits.torque,
        clearance=limits.clearance and replace(limits.clearance, distance=limits.clearance.distance + GAP),
    )


class Excess(NamedTuple):
    """Mean squared excess over a limit, and its derivative by the limited quantity, (N, n)."""

    mean: float
    slope: FloatArray


def beyond(x: FloatArray, limit: FloatArray) -> Excess:
    """Compute the mean squared excess of sizes over a limit."""
    part = np.maximum(np.abs(x) / limit - 1.0, 0.0)
    return Excess(float((part**2).sum() / len(x)), 2.0 * part * np.sign(x) / limit / len(x))


def criterion_value(information: FloatArray, power: float) -> tuple[float, FloatArray]:
    """Compute the criterion of an information matrix, see :class:`Stage`."""
    count = len(information)
    eigenvalues, vectors = np.linalg.eigh(information)
    eigenvalues = np.maximum(eigenvalues, RIDGE * eigenvalues[-1])
    covariance = (vectors / eigenvalues) @ vectors.T
    if power == 0.0:
        return float(-0.5 * np.log(eigenvalues).sum() / count), -0.5 * covariance / count
    r = np.diag(covariance)
    largest = r.max()
    total = ((r / largest) ** power).sum()
    value = 0.5 * (np.log(largest) + np.log(total) / power)
    share = (r / largest) ** power / total / r
    return float(value), -0.5 * (covariance * share) @ covariance
