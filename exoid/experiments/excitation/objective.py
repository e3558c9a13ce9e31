"""Objective of the search: criterion of the predicted covariance plus a penalty for exceeded limits, with gradient."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.experiments.limits import MotionLimits
from exoid.experiments.references import States
from exoid.leg.torso import TorsoMotion
from exoid.torques import TorqueModel
from exoid.torques.motion import STEPS

from .fourier import Basis
from .scales import Scales, TorqueNoise

Criterion = Literal["worst", "d"]


class Stage(NamedTuple):
    """Settings of one stage of the search."""

    # power p of the mean (Σ r_i^p)^(1/p) of the relative variances r_i: large for the worst parameter
    # alone, 0 for D-optimality (the mean of the logarithms of the eigenvalues)
    power: float
    penalty: float  # weight of the penalty
    iterations: int = 60  # largest number


@dataclass(frozen=True, eq=False, kw_only=True)
class Objective:
    """J(x) = ½ ln (Σ_i (cov_ii / scale_i²)^p)^(1/p) + penalty · mean of squared excesses, for one motion or several."""

    # With ½ ln a change of J is the relative change of the standard deviations. x are the coefficients of one motion
    # for each tilt of the torso.

    model: TorqueModel  # leg and terms
    limits: MotionLimits  # motion limits
    scales: Scales  # scales of the standard deviations
    basis: Basis  # basis functions of the motions
    noise: TorqueNoise  # torque noise
    seconds: float  # duration of each motion [s]
    rate: float  # rate of the log [Hz]
    pitches: FloatArray  # tilt of the torso in each motion [rad], (T,)
    limit_names = ("angle", "velocity", "acceleration", "torque")

    def __call__(self, x: FloatArray, stage: Stage) -> tuple[float, FloatArray]:
        """Value and gradient at flattened coefficients."""
        motions = [self.basis.states(each) for each in self.coefficients(x)]
        columns = [self.columns(k, states) for k, states in enumerate(motions)]
        information = np.sum([np.einsum("pjt,qjt->pq", W * self.weight, W, optimize=True) for W in columns], axis=0)
        value, by_information = criterion_value(information, stage.power)
        gradient, basis = [], self.basis
        for k, (states, W) in enumerate(zip(motions, columns, strict=True)):
            adjoint = 2.0 * np.tensordot(by_information, W, axes=1) * self.weight
            excess, slopes = self.slopes(k, states, W, adjoint, stage.penalty)
            value += stage.penalty * excess
            by_position, by_velocity = basis.position.T @ slopes.q, basis.velocity.T @ slopes.v
            gradient.append((by_position + by_velocity + basis.acceleration.T @ slopes.a).ravel())
        return value, np.concatenate(gradient)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of x, (T, m, n)."""
        return len(self.pitches), self.basis.count, len(self.limits.lower)

    def columns(self, number: int, states: States) -> FloatArray:
        """Compute the regressor of scaled parameters, (P, n, N); rows in a dead band are zero."""
        W = self._regressor(states, float(self.pitches[number]))
        W *= self.scales.scale[:, None, None]
        return np.asarray(W * self.model.usable(states.v).T)

    @property
    def weight(self) -> FloatArray:
        """Information of one sample of the basis about each joint, (n, 1)."""
        share = self.rate * self.seconds / len(self.basis.position)  # samples of the log per sample of the basis
        return np.asarray(share / self.noise.per_sample(self.rate) ** 2)[:, None]

    def slopes(
        self, number: int, states: States, columns: FloatArray, adjoint: FloatArray, penalty: float
    ) -> tuple[float, States]:
        """Mean squared excess, and the gradient by samples, given that of the criterion by columns."""
        pitch = float(self.pitches[number])
        means, (*by_states, by_torque) = self._excesses(states, np.einsum("pjt,p->tj", columns, self._beta))
        by_columns = self._beta[:, None, None] * by_torque.T
        inner = self._through_regressor(states, adjoint + penalty * by_columns, pitch)
        slopes = States(*(s + penalty * e for s, e in zip(inner, by_states, strict=True)))
        return sum(means), slopes

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

    def coefficients(self, x: FloatArray) -> Sequence[FloatArray]:
        """Split coefficients, a motion for each tilt."""
        return tuple(x.reshape(self.shape))

    def excesses_of(self, number: int, states: States) -> FloatArray:
        """Compute the mean squared excess over each limit."""
        tau = np.einsum("pjt,p->tj", self.columns(number, states), self._beta)
        return np.array(self._excesses(states, tau)[0])

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
        """Narrow the limits by what the search reserves for values between its samples."""
        margin, limits = 0.004, self.limits  # fraction of each limit
        gap, less = margin * limits.span, 1.0 - margin
        inner = replace(
            limits,
            lower=limits.lower + gap,
            upper=limits.upper - gap,
            velocity=less * limits.velocity,
            acceleration=less * limits.acceleration,
            torque=less * limits.torque,
        )
        return replace(self, limits=inner)

    @property
    def _beta(self) -> FloatArray:
        """Expected parameters over their scales."""
        return self.scales.expected / self.scales.scale

    def _excesses(self, states: States, tau: FloatArray) -> tuple[tuple[float, ...], tuple[FloatArray, ...]]:
        """Mean squared excess over each limit of :attr:`limit_names`, and their derivatives."""
        limits = self.limits
        middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * limits.span
        sizes = (states.q - middle, states.v, states.a, tau)
        most = (half, limits.velocity, limits.acceleration, limits.torque)
        means, slopes = zip(*map(beyond, sizes, most), strict=True)
        return means, slopes


def beyond(x: FloatArray, limit: FloatArray) -> tuple[float, FloatArray]:
    """Compute the mean squared excess of sizes over a limit, and its derivative by the limited quantity, (N, n)."""
    part = np.maximum(np.abs(x) / limit - 1.0, 0.0)
    return float((part**2).sum() / len(x)), 2.0 * part * np.sign(x) / limit / len(x)


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
