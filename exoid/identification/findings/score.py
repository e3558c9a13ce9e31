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
from exoid.regression.noise import LARGEST_ORDER, AutoregressiveNoise, autocovariance_sums

from .evidence import RANK, TINY, Evidence, pseudo_inverse, r_factor
from .nuisances import Nuisance

HIDDEN = 1.0 / 300.0
"""A fault of whose column less than this part is not explained by the parameters cannot be tested."""

WORTH_A_LOOK = 0.01
"""Below this probability the variance of the score is also taken from blocks of time."""

LARGE_GAIN = 0.05
"""A fault that explains more than this part of the squared residuals is tested with the noise that is left then."""

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
class State:
    """Weighted least-squares fit of parameters and some nuisance columns.

    Attributes:
        evidence: The rows.
        columns: Indices of all fitted columns.
        weights: Weight of each joint's rows, (n,).
        R: R factor of all weighted rows, (P + K + 1, P + K + 1).
        pinv: Pseudo-inverse of its fitted columns.
        used: Indices of the columns that are fitted or tested; None for all.
        like: Fit whose residuals give the noise; None for this fit's own.
    """

    evidence: Evidence
    columns: NDArray[np.intp]
    weights: FloatArray
    R: FloatArray
    pinv: FloatArray
    used: NDArray[np.intp] | None = None
    like: State | None = None

    @classmethod
    def of(
        cls,
        evidence: Evidence,
        active: Sequence[int],
        like: State | None = None,
        tested: Sequence[int] | None = None,
        near: State | None = None,
    ) -> State:
        """Fit parameters and some nuisance columns.

        Args:
            evidence: The rows.
            active: Indices of nuisance columns.
            like: Fit whose weights and noise are taken; None for those of this fit's own residuals.
            tested: Indices of the other nuisance columns that are to be tested; None for all.
            near: Fit with nearly these columns, at whose weights to begin.

        Returns:
            The fit.
        """
        columns = evidence.places(active)
        if like is not None:
            return cls(evidence, columns, like.weights, like.R, pseudo_inverse(like.R[:, columns]), like=like)
        used = None if tested is None else np.union1d(columns, evidence.places(tested))
        weights = evidence.weights(columns, None if near is None else near.weights)
        R = r_factor(np.vstack([w * R for w, R in zip(weights, evidence.factors, strict=True)]))
        return cls(evidence, columns, weights, R, pseudo_inverse(R[:, columns]), used)

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
    def nuisances(self) -> FloatArray:
        """Nuisance columns of the R factor, (M, K)."""
        return self.R[:, self.evidence.count : -1]

    @cached_property
    def shares(self) -> FloatArray:
        """Shares of the fitted columns in each nuisance column, (F, K)."""
        return np.asarray(self.pinv @ self.nuisances)

    @cached_property
    def _tests(self) -> _Tests:
        """Score test of each nuisance column, before they are combined."""
        rests, k = self.nuisances - self.R[:, self.columns] @ self.shares, self.evidence.count
        crossed = self.meat[k:, self.columns] @ self.shares
        fitted = self.shares.T @ self.meat[np.ix_(self.columns, self.columns)] @ self.shares
        noise = self.meat[k:, k:] - crossed - crossed.T + fitted
        return _Tests(self.nuisances.T @ self.nuisances, rests.T @ rests, rests.T @ self.residual, noise)

    @cached_property
    def _residuals(self) -> list[list[FloatArray]]:
        """Weighted residuals of each joint, recording by recording."""
        pairs = zip(self.weights, self.evidence.tables, strict=True)
        return [[w * (table[-1] - self.solution @ table[self.columns]) for table in of_joint] for w, of_joint in pairs]

    @cached_property
    def noises(self) -> list[AutoregressiveNoise]:
        """Noise of each joint's weighted residuals."""
        if self.like is not None:
            return self.like.noises
        noises = []
        for of_joint, count in zip(self._residuals, self.evidence.counts, strict=True):
            order = int(min(LARGEST_ORDER, count // 10))
            sums, pairs = np.zeros((2, order + 1))
            for residual, rest in zip(of_joint, self.evidence.at_rest, strict=True):
                keep = slice(0, 1) if rest else slice(None)
                sums[keep] += autocovariance_sums(residual, order)[keep]
                pairs[keep] += np.maximum(len(residual) - np.arange(order + 1), 0)[keep]
            lost = count / max(1.0, count - len(self.columns) / len(self.weights))
            gamma = lost * sums / np.maximum(pairs[0], 1.0)
            noises.append(AutoregressiveNoise.from_autocovariances(gamma, int(count)))
        return noises

    @cached_property
    def meat(self) -> FloatArray:
        """[W Z]ᵀ Γ [W Z] of all columns, (P + K, P + K), zero where a column is neither fitted nor tested."""
        if self.like is not None:
            return self.like.meat
        width = self.R.shape[1] - 1
        total, used = np.zeros((width, width)), np.arange(width) if self.used is None else self.used
        for weight, of_joint, noise in zip(self.weights, self.evidence.tables, self.noises, strict=True):
            for table, rest in zip(of_joint, self.evidence.at_rest, strict=True):
                act = used[table[used].any(axis=1)]
                some = weight * table[act]
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
        return self._moved(nuisance.columns, nuisance.combination[:, 0])

    def reach(self, columns: Sequence[int], sizes: FloatArray, others: Sequence[int]) -> FloatArray:
        """Largest change of the fitted parameters by a fault of the same torque but another form.

        Args:
            columns: Indices of the nuisance columns of the fault.
            sizes: Their coefficients.
            others: Indices of the columns of which the other form may consist.

        Returns:
            Largest change of each parameter, 0 for known ones, (P,).
        """
        torque = float(np.linalg.norm(self.nuisances[:, list(columns)] @ sizes))
        kept = [k for k in others if self.nuisances[:, k].any()]
        _, values, axes = np.linalg.svd(self.nuisances[:, kept] / np.linalg.norm(self.nuisances[:, kept], axis=0))
        used = values > RANK * values[0]
        free = len(self.evidence.free)
        share = self.shares[:free, kept] / np.linalg.norm(self.nuisances[:, kept], axis=0)
        reach = np.zeros(self.evidence.count)
        reach[self.evidence.free] = torque * np.linalg.norm(share @ axes[: len(values)][used].T / values[used], axis=1)
        return reach

    def _moved(self, columns: Sequence[int], sizes: FloatArray) -> FloatArray:
        """Change of the fitted parameters by nuisance columns of these sizes, 0 for known ones, (P,)."""
        moved = np.zeros(self.evidence.count)
        free = len(self.evidence.free)
        moved[self.evidence.free] = self.shares[:free, list(columns)] @ sizes
        return moved

    def conspicuous(self, nuisances: Sequence[Nuisance]) -> list[Nuisance]:
        """Leave out faults of one number that explain little and are likely in noise alone: all are tested at once.

        Args:
            nuisances: The faults.

        Returns:
            Those that are worth a test, and all of several numbers.
        """
        tests, single = self._tests, [one for one in nuisances if not one.group]
        C = np.zeros((len(tests.score), len(single)))
        for k, one in enumerate(single):
            C[list(one.columns), k] = 1.0
        information, noise = ((C * (M @ C)).sum(axis=0) for M in (tests.information, tests.noise))
        score, rss = C.T @ tests.score, float(self.residual @ self.residual)
        p_values = scipy.special.fdtrc(1, self.dof, score**2 / np.maximum(noise, TINY))
        odd = (p_values < WORTH_A_LOOK) | (score**2 > LARGE_GAIN * rss * np.maximum(information, TINY))
        left_out = {one for one, is_odd in zip(single, odd, strict=True) if not is_odd}
        return [one for one in nuisances if one not in left_out]

    def test(self, nuisance: Nuisance, plain: State | None = None, limit: float = 1.0) -> Score | None:
        """Test one fault beside what is fitted.

        Args:
            nuisance: The fault.
            plain: Fit without protecting columns, whose parameters the fault moves; None for this one.
            limit: Faults that are less probable than this are not looked at further, if they explain little.

        Returns:
            The test; None where the columns leave no trace beside those fitted, or the fault is not significant.
        """
        columns, tests = list(nuisance.columns), self._tests
        own = np.ix_(columns, columns)
        C = nuisance.combination
        size = np.sqrt(np.diag(C.T @ tests.size[own] @ C))
        if (size == 0.0).all():
            return None
        C = C[:, size > 0.0] / size[size > 0.0]
        information = C.T @ tests.information[own] @ C
        if len(information) > 1:
            basis, sizes, _ = np.linalg.svd(information)
            C = C @ basis[:, sizes > HIDDEN**2]
            information = C.T @ tests.information[own] @ C
        if not information.size or information[0, 0] <= HIDDEN**2:
            return None
        score, noise = C.T @ tests.score[columns], C.T @ tests.noise[own] @ C
        inverse = np.linalg.inv(information) if len(information) > 1 else 1.0 / information
        step = inverse @ score
        m, rss = len(step), float(self.residual @ self.residual)
        gain = min(float(score @ step) / max(rss, 1e-300), 1.0 - 1e-12)
        p_value = self._p_value(score, noise, self.dof)
        if p_value < WORTH_A_LOOK:
            factor, blocks = self._uneven(columns, C, step, noise)
            noise = factor * noise
            p_value = self._p_value(score, noise, min(self.dof, blocks))
        if p_value >= limit and gain <= LARGE_GAIN:
            return None
        covariance = inverse @ noise @ inverse
        evidence = -0.5 * self.dof * np.log1p(-gain) - m * np.log(max(self.dof, 2.0))
        plain = plain or self
        kept = slice(None) if nuisance.group else slice(0, 1)
        return Score(
            nuisance,
            (C @ step)[kept],
            (C @ covariance @ C.T)[kept, kept],
            p_value,
            gain,
            float(evidence),
            -plain._moved(columns, C @ step),
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

    def _uneven(
        self, columns: Sequence[int], C: FloatArray, step: FloatArray, noise: FloatArray
    ) -> tuple[float, float]:
        """How much more a score varies from block to block than stationary noise lets it, at least 1; and blocks.

        Noise that grows with the speed, or is common to the joints, shows in the scores of blocks of time.
        """
        count, scores = self.evidence.count, []
        share, places = C.T @ self.shares[:, columns].T, count + np.array(columns)
        for place, rest in enumerate(self.evidence.at_rest):
            total = np.zeros((len(step), self.evidence.tables[0][place].shape[1]))
            for weight, tables, residuals in zip(self.weights, self.evidence.tables, self._residuals, strict=True):
                rows = weight * (C.T @ tables[place][places] - share @ tables[place][self.columns])
                total += rows * (residuals[place] - step @ rows)
            samples = total.shape[1]
            blocks = max(1, samples if rest else min(BLOCKS, samples // BLOCK))
            starts = np.linspace(0, samples, blocks, endpoint=False).astype(np.intp)
            scores.append(np.add.reduceat(total, starts, axis=1).T)
        found = np.vstack(scores)
        if len(found) < FEWEST_BLOCKS:
            return 1.0, float(FEWEST_BLOCKS)
        seen = found.T @ found * len(found) / (len(found) - 1)
        ratio = float(np.trace(np.linalg.pinv(noise, rcond=1e-12, hermitian=True) @ seen)) / len(step)
        return max(1.0, ratio), float(len(found))


class _Tests(NamedTuple):
    """Score tests of single nuisance columns: matrices (K, K) and scores (K,), which faults combine."""

    size: FloatArray  # ZᵀZ of the columns
    information: FloatArray  # Z⊥ᵀ Z⊥ of what the fitted columns leave of them
    score: FloatArray  # Z⊥ᵀ r
    noise: FloatArray  # covariance of the scores
