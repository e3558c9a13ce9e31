"""Score tests (Lagrange multiplier tests) of nuisance columns beside a weighted least-squares fit.

With rows X of the parameters and of the faults already accepted, r the torque and z a nuisance column, the part of z
that X does not explain is z⊥ = z − X (XᵀX)⁻¹Xᵀ z. One step of Gauss and Newton gives the fault δ = z⊥ᵀ r / |z⊥|², whose
variance is z⊥ᵀ Γ z⊥ / |z⊥|⁴ under noise of covariance Γ, an autoregressive model of the residuals. The parameters move
by −(XᵀX)⁻¹Xᵀ z δ when the fault is taken into account.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.estimate.motion_ranges import MotionRanges
from exoid.regression.noise import LARGEST_ORDER, AutoregressiveNoise, LagSums
from exoid.regression.rows import Rows

from .nuisances import Nuisance

ROUNDS = 4
"""Weights of the joints and residuals are computed in turn so often."""

TINY = 1e-300
"""Smallest variance to divide by."""

FLOOR = 1e-9
"""Residuals below this part of the torque are rounding."""

RANK = 1e-6
"""Columns this close to others, after scaling, are dependent."""

HIDDEN = 1.0 / 300.0
"""A fault of whose column less than this part is not explained by the parameters cannot be tested."""

WORTH_A_LOOK = 0.01
"""Below this probability the variance of the score is also taken from blocks of time."""

BLOCKS, BLOCK, FEWEST_BLOCKS = 60, 8, 10
"""Most blocks of a recording, fewest rows of a block, and fewest blocks that say something."""

HALF_WIDTH = 1.96
"""Half of a 95 % interval, in standard deviations."""


class Score(NamedTuple):
    """Test of one fault.

    Attributes:
        nuisance: The fault.
        delta: Estimate, (m,).
        covariance: Its covariance, (m, m).
        p_value: Probability of an estimate this far from zero in noise alone.
        gain: Share of the sum of squared residuals that it explains.
        evidence: Improvement of the log likelihood, less a penalty for its m numbers (BIC).
        move: Change of the parameters when the fault is taken into account, (P,).
        half: Half widths of the parameters' intervals without the fault's residual, (P,).
        dof: Degrees of freedom of the test.
    """

    nuisance: Nuisance
    delta: FloatArray
    covariance: FloatArray
    p_value: float
    gain: float
    evidence: float
    move: FloatArray
    half: FloatArray
    dof: float

    def p_of(self, t: float) -> float:
        """Probability of an estimate of one number this many standard deviations from zero in noise alone.

        Args:
            t: Estimate over its standard deviation.

        Returns:
            The probability.
        """
        return float(scipy.special.fdtrc(1, self.dof, t * t))

    @property
    def std(self) -> FloatArray:
        """Standard deviations, (m,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def largest_move(self) -> float:
        """Largest change of a parameter in half widths of its interval."""
        moves = np.divide(np.abs(self.move), self.half, out=np.zeros_like(self.move), where=self.half > 0.0)
        return float(moves.max(initial=0.0))


@dataclass(frozen=True, eq=False)
class Evidence:
    """Rows of parameters and nuisance columns of several recordings, decimated to independent noise.

    Attributes:
        parts: Rows of each recording or set of poses.
        at_rest: Whether each is poses.
        count: Number of parameters P; nuisance columns follow.
        fixed: Known values of parameters, (P,); not a number where they are free.
        ranges: Ranges of the motion of each.
    """

    parts: Sequence[Rows]
    at_rest: Sequence[bool]
    count: int
    fixed: FloatArray
    ranges: Sequence[MotionRanges] = ()

    @cached_property
    def samples(self) -> int:
        """Rows of all joints."""
        return int(sum(part.usable.sum() for part in self.parts))

    @cached_property
    def joints(self) -> int:
        """Number of joints."""
        return int(self.parts[0].tau.shape[1])

    @cached_property
    def free(self) -> NDArray[np.intp]:
        """Indices of the free parameters."""
        return np.flatnonzero(~np.isfinite(self.fixed))

    def table(self, part: Rows, joint: int) -> FloatArray:
        """Columns of parameters and nuisances, and the torque less that of known parameters, (P + K + 1, N).

        Args:
            part: Rows of a recording.
            joint: Index of the joint.

        Returns:
            The rows, zero where samples are left out.
        """
        W = part.W[:, joint].T
        known = np.where(np.isfinite(self.fixed), self.fixed, 0.0)
        torque = part.tau[:, joint] - known @ W[: self.count]
        return np.asarray(np.vstack([W, torque]) * part.usable[:, joint])

    @cached_property
    def tables(self) -> list[list[FloatArray]]:
        """Tables of each joint, recording by recording."""
        return [[self.table(part, joint) for part in self.parts] for joint in range(self.joints)]

    @cached_property
    def factors(self) -> list[FloatArray]:
        """R factor of the rows of each joint, (P + K + 1, P + K + 1)."""
        return [r_factor(np.hstack(of_joint).T) for of_joint in self.tables]

    @cached_property
    def counts(self) -> FloatArray:
        """Usable rows of each joint, (n,)."""
        counts = np.sum([part.usable.sum(axis=0) for part in self.parts], axis=0)
        return np.asarray(np.maximum(counts, 1), dtype=np.float64)

    def state(self, active: Sequence[int], like: State | None = None) -> State:
        """Fit parameters and some nuisance columns.

        Args:
            active: Indices of nuisance columns.
            like: Fit whose weights and noise are taken; None for those of this fit's own residuals.

        Returns:
            The fit.
        """
        columns = np.concatenate([self.free, self.count + np.array(active, dtype=np.intp)]).astype(np.intp)
        if like is not None:
            return State(self, columns, like.weights, like.R, _pseudo_inverse(like.R[:, columns]), like)
        torque = np.array([np.linalg.norm(R[:, -1]) for R in self.factors]) / np.sqrt(self.counts)
        floor = FLOOR * max(float(torque.max(initial=0.0)), 1e-12)
        weights = 1.0 / np.maximum(torque, floor)
        for _ in range(ROUNDS):
            R = np.vstack([w * R for w, R in zip(weights, self.factors, strict=True)])
            pinv = _pseudo_inverse(R[:, columns])
            solution = pinv @ R[:, -1]
            rms = [
                float(np.linalg.norm(R_j[:, -1] - R_j[:, columns] @ solution)) / np.sqrt(count)
                for R_j, count in zip(self.factors, self.counts, strict=True)
            ]
            weights = 1.0 / np.maximum(rms, floor)
        R = r_factor(np.vstack([w * R for w, R in zip(weights, self.factors, strict=True)]))
        return State(self, columns, weights, R, _pseudo_inverse(R[:, columns]))


@dataclass(frozen=True, eq=False)
class State:
    """Weighted least-squares fit of parameters and some nuisance columns.

    Attributes:
        evidence: The rows.
        columns: Indices of all fitted columns.
        weights: Weight of each joint's rows, (n,).
        R: R factor of all weighted rows, (P + K + 1, P + K + 1).
        pinv: Pseudo-inverse of its fitted columns.
        like: Fit whose residuals give the noise; None for this fit's own.
    """

    evidence: Evidence
    columns: NDArray[np.intp]
    weights: FloatArray
    R: FloatArray
    pinv: FloatArray
    like: State | None = None

    @cached_property
    def solution(self) -> FloatArray:
        """Values of the fitted columns."""
        return np.asarray(self.pinv @ self.R[:, -1])

    @cached_property
    def values(self) -> FloatArray:
        """Values of all parameters, known ones too, (P,)."""
        values = np.where(np.isfinite(self.evidence.fixed), self.evidence.fixed, 0.0)
        values[self.evidence.free] = self.solution[: len(self.evidence.free)]
        return np.asarray(values)

    @cached_property
    def residual(self) -> FloatArray:
        """Residual on the R factor."""
        return np.asarray(self.R[:, -1] - self.R[:, self.columns] @ self.solution)

    @cached_property
    def dof(self) -> float:
        """Rows less fitted columns, at least 1."""
        return max(1.0, self.evidence.samples - len(self.columns))

    @cached_property
    def _split(self) -> tuple[FloatArray, FloatArray]:
        """Shares of the fitted columns in each nuisance column, and what they leave of it."""
        Z = self.R[:, self.evidence.count : -1]
        share = self.pinv @ Z
        return share, Z - self.R[:, self.columns] @ share

    @cached_property
    def noises(self) -> list[AutoregressiveNoise]:
        """Noise of each joint's weighted residuals."""
        if self.like is not None:
            return self.like.noises
        noises = []
        for weight, of_joint, count in zip(self.weights, self.evidence.tables, self.evidence.counts, strict=True):
            order = int(min(LARGEST_ORDER, count // 10))
            sums, pairs = LagSums(order), LagSums(order)
            for table, rest in zip(of_joint, self.evidence.at_rest, strict=True):
                residual = weight * (table[-1] - self.solution @ table[self.columns])
                lags = LagSums(order)
                lags.add(residual)
                number = LagSums(order)
                number.add(np.ones(len(residual)))
                keep = slice(0, 1) if rest else slice(None)
                sums.sums[keep] += lags.sums[keep]
                pairs.sums[keep] += number.sums[keep]
            lost = count / max(1.0, count - len(self.columns) / len(self.weights))
            gamma = lost * sums.sums / np.maximum(pairs.sums[0], 1.0)
            noises.append(AutoregressiveNoise.from_autocovariances(gamma, int(count)))
        return noises

    @cached_property
    def meat(self) -> FloatArray:
        """[W Z]ᵀ Γ [W Z] of all columns, (P + K, P + K)."""
        if self.like is not None:
            return self.like.meat
        width = self.R.shape[1] - 1
        total = np.zeros((width, width))
        for weight, of_joint, noise in zip(self.weights, self.evidence.tables, self.noises, strict=True):
            for table, rest in zip(of_joint, self.evidence.at_rest, strict=True):
                rows = weight * table[:-1]
                act = np.flatnonzero(rows.any(axis=1))
                some = rows[act]
                size = float(noise.variances[0])
                total[np.ix_(act, act)] += size * some @ some.T if rest else noise.quadratic_form(some)
        return total

    @cached_property
    def half(self) -> FloatArray:
        """Half widths of 95 % intervals of all parameters, 0 for known ones, (P,)."""
        bread = self.pinv @ self.pinv.T
        inner = self.meat[np.ix_(self.columns, self.columns)]
        variance = np.diag(bread @ inner @ bread)[: len(self.evidence.free)]
        half = np.zeros(self.evidence.count)
        half[self.evidence.free] = HALF_WIDTH * np.sqrt(np.maximum(variance, 0.0))
        return half

    def slope(self, nuisance: Nuisance) -> FloatArray:
        """Change of the fitted parameters by a fault of size 1, (XᵀX)⁻¹Xᵀ z.

        Args:
            nuisance: A fault of one number.

        Returns:
            Change of each parameter, 0 for known ones, (P,).
        """
        count, width = self.evidence.count, self.R.shape[1] - 1
        z = self.R[:, count:width] @ nuisance.matrix(width - count)[:, 0]
        slope = np.zeros(count)
        slope[self.evidence.free] = (self.pinv @ z)[: len(self.evidence.free)]
        return slope

    def test(self, nuisance: Nuisance, plain: State | None = None) -> Score | None:
        """Test one fault beside what is fitted.

        Args:
            nuisance: The fault.
            plain: Fit without protecting columns, whose parameters the fault moves; None for this one.

        Returns:
            The test; None where the columns leave no trace beside those fitted.
        """
        count, width = self.evidence.count, self.R.shape[1] - 1
        C = np.zeros((width, nuisance.matrix(width - count).shape[1]))
        C[count:] = nuisance.matrix(width - count)
        size = np.linalg.norm(self.R[:, count:-1] @ C[count:], axis=0)
        if (size == 0.0).all():
            return None
        C = C[:, size > 0.0] / size[size > 0.0]
        shares, rests = self._split
        share, apart = shares @ C[count:], rests @ C[count:]
        information = apart.T @ apart
        if len(information) > 1:
            basis, sizes, _ = np.linalg.svd(information)
            rotate = basis[:, sizes > HIDDEN**2]
            C, apart, share = C @ rotate, apart @ rotate, share @ rotate
            information = apart.T @ apart
        if not information.size or information[0, 0] <= HIDDEN**2:
            return None
        T = C.copy()
        T[self.columns] -= share
        score = apart.T @ self.residual
        noise = T.T @ self.meat @ T
        inverse = np.linalg.inv(information)
        step = inverse @ score
        covariance = inverse @ noise @ inverse
        m, rss = len(step), float(self.residual @ self.residual)
        p_value = self._p_value(score, noise, self.dof)
        if p_value < WORTH_A_LOOK:
            factor, blocks = self._uneven(T, step, noise)
            noise, covariance = factor * noise, factor * covariance
            p_value = self._p_value(score, noise, min(self.dof, blocks))
        gain = min(float(score @ step) / max(rss, 1e-300), 1.0 - 1e-12)
        evidence = -0.5 * self.dof * np.log1p(-gain) - m * np.log(max(self.dof, 2.0))
        plain = plain or self
        move = np.zeros(count)
        move[self.evidence.free] = -(plain.pinv @ (plain.R[:, :-1] @ (C @ step)))[: len(self.evidence.free)]
        delta, spread = C[count:] @ step, C[count:] @ covariance @ C[count:].T
        kept = np.array(nuisance.columns if nuisance.group else nuisance.columns[:1])
        return Score(
            nuisance,
            delta[kept],
            spread[np.ix_(kept, kept)],
            p_value,
            gain,
            float(evidence),
            move,
            plain.half * (1.0 if self.like is not None else np.sqrt(1.0 - gain)),
            self.dof,
        )

    @staticmethod
    def _p_value(score: FloatArray, noise: FloatArray, dof: float) -> float:
        """Probability of a score this large in noise of that covariance."""
        if len(score) == 1:
            statistic = float(score[0] ** 2 / max(noise[0, 0], TINY))
        else:
            statistic = float(score @ np.linalg.pinv(noise, rcond=1e-12, hermitian=True) @ score)
        return float(scipy.special.fdtrc(len(score), dof, statistic / len(score)))

    def _uneven(self, T: FloatArray, step: FloatArray, noise: FloatArray) -> tuple[float, float]:
        """How much more a score varies from block to block than stationary noise lets it, at least 1; and blocks.

        Noise that grows with the speed, or is common to the joints, shows in the scores of blocks of time.
        """
        scores = []
        for place, rest in enumerate(self.evidence.at_rest):
            tables = [of_joint[place] for of_joint in self.evidence.tables]
            count = tables[0].shape[1]
            total = np.zeros((len(step), count))
            for weight, table in zip(self.weights, tables, strict=True):
                rows = weight * T.T @ table[:-1]
                total += rows * (weight * (table[-1] - self.solution @ table[self.columns]) - step @ rows)
            blocks = max(1, count if rest else min(BLOCKS, count // BLOCK))
            scores += [part.sum(axis=1) for part in np.array_split(total, blocks, axis=1)]
        if len(scores) < FEWEST_BLOCKS:
            return 1.0, float(max(len(scores), FEWEST_BLOCKS))
        found = np.array(scores)
        seen = found.T @ found * len(found) / (len(found) - 1)
        ratio = float(np.trace(np.linalg.pinv(noise, rcond=1e-12, hermitian=True) @ seen)) / len(step)
        return max(1.0, ratio), float(len(found))


def r_factor(rows: FloatArray) -> FloatArray:
    """Reduce rows to their R factor.

    Args:
        rows: Rows, (N, P).

    Returns:
        The R factor, (min(N, P), P).
    """
    return np.asarray(np.linalg.qr(rows, mode="r"), dtype=np.float64)


def _pseudo_inverse(A: FloatArray) -> FloatArray:
    """Pseudo-inverse with columns scaled to unit length."""
    scale = np.linalg.norm(A, axis=0)
    scale = np.where(scale > 0.0, scale, 1.0)
    return np.asarray(np.linalg.pinv(A / scale, rcond=RANK) / scale[:, None])
