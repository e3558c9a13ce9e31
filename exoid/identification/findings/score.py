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
from exoid.regression.least_squares import RANK, TINY, scaled_inverse, scaled_pinv
from exoid.regression.noise import LARGEST_ORDER, AutoregressiveNoise, autocovariance_sums

from .evidence import Evidence, r_factor
from .kinds import Nuisance

WORTH_A_LOOK, LARGE_GAIN = 0.01, 0.05
"""Below this probability the variance of a score is also taken from blocks of time. A fault that explains more than the
second of the squared residuals of two joints is tested with the noise that is left then."""

HIDDEN = (1.0 / 300.0) ** 2  # what the parameters explain of a fault, but for a 300th, cannot be tested
HALF_WIDTH = 1.96  # half of a 95 % interval, in standard deviations


class Score(NamedTuple):
    """Test of one fault."""

    nuisance: Nuisance  # the fault
    delta: FloatArray  # estimate, (m,)
    std: FloatArray  # its standard deviations, (m,)
    p_value: float  # probability of an estimate this far from zero in noise alone
    gain: float  # part of the squared residuals of two joints that it explains
    evidence: float  # improvement of the log likelihood, less a penalty for its m numbers (BIC)
    move: FloatArray  # change of the parameters when the fault is taken into account, (P,)
    half: FloatArray  # half widths of the parameters' intervals without the fault's residual, (P,)
    dof: float  # degrees of freedom of the test

    @property
    def moves(self) -> FloatArray:
        """Changes of the parameters in half widths, (P,)."""
        return in_half_widths(self.move, self.half)


def in_half_widths(change: FloatArray, half: FloatArray) -> FloatArray:
    """Changes of parameters in half widths of their intervals, 0 for known ones."""
    return np.divide(np.abs(change), half, out=np.zeros_like(change), where=half > 0.0)


class _Tests(NamedTuple):
    """Score tests of single nuisance columns: matrices (K, K) and scores (K,), which faults combine."""

    size: FloatArray  # ZᵀZ of the columns
    information: FloatArray  # Z⊥ᵀ Z⊥ of what the fitted columns leave of them
    score: FloatArray  # Z⊥ᵀ r
    noise: FloatArray  # covariance of the scores


@dataclass(frozen=True, eq=False)
class State:
    """Weighted least-squares fit of parameters and some nuisance columns."""

    evidence: Evidence  # the rows
    columns: NDArray[np.intp]  # indices of all fitted columns
    weights: FloatArray  # weight of each joint's rows, (n,)
    R: FloatArray  # R factor of all weighted rows, (P + K + 1, P + K + 1)
    pinv: FloatArray  # pseudo-inverse of its fitted columns
    solution: FloatArray  # values of the fitted columns
    residual: FloatArray  # residual on the R factor
    shares: FloatArray  # shares of the fitted columns in each nuisance column, (F, K)
    like: State | None  # fit whose residuals give the noise; None for this fit's own
    dof: float  # rows less fitted columns, at least 1

    @classmethod
    def of(
        cls, evidence: Evidence, active: Sequence[int], *, like: State | None = None, near: State | None = None
    ) -> State:
        """Fit parameters and some nuisance columns, from weights near those of another fit."""
        count = len(evidence.fixed)
        columns = np.append(evidence.free, count + np.array(active, dtype=np.intp))  # nuisances follow the parameters
        if like is None:
            weights = evidence.weights(columns, None if near is None else near.weights)
            R = r_factor(np.vstack([w * R for w, R in zip(weights, evidence.factors, strict=True)]))
            R = evidence.reduced(R, np.arange(R.shape[1] - 1))
        else:
            weights, R = like.weights, like.R
        pinv = scaled_pinv(R[:, columns])
        solution = pinv @ R[:, -1]
        residual, shares = R[:, -1] - R[:, columns] @ solution, pinv @ R[:, count:-1]
        dof = max(1.0, sum(int(part.usable.sum()) for part in evidence.parts) - len(columns))
        return cls(evidence, columns, weights, R, pinv, solution, residual, shares, like, dof)

    @property
    def values(self) -> FloatArray:
        """Values of all parameters, known ones too, (P,)."""
        return np.nan_to_num(self.evidence.fixed) + self._spread(self.solution[: len(self.evidence.free)])

    def alone(self, k: int) -> tuple[float, float]:
        """Value of a parameter by the rows, beside all that are free, and its standard deviation; 0 ± ∞ if unseen."""
        others = self.columns[self.columns != k]
        share = scaled_pinv(self.R[:, others]) @ self.R[:, k]
        rest = self.R[:, k] - self.R[:, others] @ share
        size = float(rest @ rest)
        if size <= HIDDEN * float(self.R[:, k] @ self.R[:, k]):
            return 0.0, np.inf
        every, a = np.append(others, k), np.append(-share, 1.0)
        std = float(np.sqrt(a @ self.meat[np.ix_(every, every)] @ a)) / size
        return float(np.nan_to_num(self.evidence.fixed[k]) + rest @ self.R[:, -1] / size), std

    @cached_property
    def _tests(self) -> _Tests:
        """Score test of each nuisance column, before they are combined."""
        k = len(self.evidence.fixed)
        nuisances = self.R[:, k:-1]
        rests = nuisances - self.R[:, self.columns] @ self.shares
        crossed = self.meat[k:, self.columns] @ self.shares
        fitted = self.shares.T @ self.meat[np.ix_(self.columns, self.columns)] @ self.shares
        noise = self.meat[k:, k:] - crossed - crossed.T + fitted
        return _Tests(nuisances.T @ nuisances, rests.T @ rests, rests.T @ self.residual, noise)

    @cached_property
    def _residuals(self) -> list[list[FloatArray]]:
        """Weighted residuals of each joint, recording by recording."""
        pairs = zip(self.weights, self.evidence.tables, strict=True)
        return [[w * (table[-1] - self.solution @ table[self.columns]) for table in of_joint] for w, of_joint in pairs]

    @cached_property
    def meat(self) -> FloatArray:
        """[W Z]ᵀ Γ [W Z] of all columns, (P + K, P + K)."""
        if self.like is not None:
            return self.like.meat
        total = np.zeros((self.R.shape[1] - 1,) * 2)
        each = zip(self.weights, self.evidence.tables, self._residuals, self.evidence.counts, strict=True)
        for weight, tables, residuals, count in each:
            # an autoregressive model of the joint's residuals; poses have no neighbours in time
            order = int(min(LARGEST_ORDER, count // 10))
            sums, pairs = np.zeros(order + 1), 0
            for residual, rest in zip(residuals, self.evidence.at_rest, strict=True):
                sums[: 1 if rest else None] += autocovariance_sums(residual, order)[: 1 if rest else None]
                pairs += len(residual)
            lost = count / max(1.0, count - len(self.columns) / len(self.weights))
            noise = AutoregressiveNoise.from_autocovariances(lost * sums / max(pairs, 1.0), int(count))
            for table, rest in zip(tables, self.evidence.at_rest, strict=True):
                act = np.flatnonzero(table[:-1].any(axis=1))
                some = weight * table[act]
                size = float(noise.variances[0])
                total[np.ix_(act, act)] += size * some @ some.T if rest else noise.quadratic_form(some)
        return total

    @cached_property
    def covariance(self) -> FloatArray:
        """Covariance of all parameters, 0 for known ones, (P, P)."""
        bread, count = self.pinv @ self.pinv.T, len(self.evidence.free)
        covariance = bread @ self.meat[np.ix_(self.columns, self.columns)] @ bread
        return self._spread(self._spread(covariance[:count, :count]).T)

    @cached_property
    def half(self) -> FloatArray:
        """Half widths of 95 % intervals of all parameters, 0 for known ones, (P,)."""
        return np.asarray(HALF_WIDTH * np.sqrt(np.maximum(np.diag(self.covariance), 0.0)))

    def moved(self, columns: Sequence[int], sizes: FloatArray) -> FloatArray:
        """Change of the parameters by nuisance columns of these sizes, (XᵀX)⁻¹Xᵀ z δ, 0 for known ones, (P,)."""
        return self._spread(self.shares[: len(self.evidence.free), list(columns)] @ sizes)

    def reach(self, columns: Sequence[int], sizes: FloatArray, others: Sequence[int]) -> FloatArray:
        """Largest change of the parameters by a fault of the same torque that consists of other columns, (P,)."""
        nuisances = self.R[:, len(self.evidence.fixed) : -1]
        torque = float(np.linalg.norm(nuisances[:, list(columns)] @ sizes))
        kept = [k for k in others if nuisances[:, k].any()]
        norms = np.linalg.norm(nuisances[:, kept], axis=0)
        _, values, axes = np.linalg.svd(nuisances[:, kept] / norms)
        used = values > RANK * values[0]
        share = self.shares[: len(self.evidence.free), kept] / norms
        return self._spread(torque * np.linalg.norm(share @ axes[: len(values)][used].T / values[used], axis=1))

    def _spread(self, of_free: FloatArray) -> FloatArray:
        """Put numbers, or rows, of free parameters among those of all, (P, ...)."""
        every = np.zeros((len(self.evidence.fixed), *of_free.shape[1:]))
        every[self.evidence.free] = of_free
        return every

    def test(self, nuisance: Nuisance, plain: State, limit: float = 1.0) -> Score | None:
        """Test one fault; None where it leaves no trace beside the fit, or is likely in noise and explains little."""
        # the parameters that it moves are those of a plain fit, without protecting columns
        columns, tests = list(nuisance.columns), self._tests
        own, whole = np.ix_(columns, columns), max(float(self.residual @ self.residual), TINY)
        large = LARGE_GAIN * self.evidence.share_of_two
        quiet = len(columns) == 1 and tests.score[columns[0]] ** 2 <= large * whole * tests.information[own][0, 0]
        if quiet and p_value_of(tests.score[columns], tests.noise[own], self.dof) >= limit:
            return None  # as below, but most columns end here
        size = np.sqrt(np.diag(tests.size)[columns])
        C = np.eye(len(columns))[:, size > 0.0] / size[size > 0.0]
        information = C.T @ tests.information[own] @ C
        if len(information) > 1:
            basis, sizes, _ = np.linalg.svd(information)
            C = C @ basis[:, sizes > HIDDEN]
            information = C.T @ tests.information[own] @ C
        if not information.size or information[0, 0] <= HIDDEN:
            return None
        score, noise = C.T @ tests.score[columns], C.T @ tests.noise[own] @ C
        inverse = np.linalg.inv(information) if len(information) > 1 else 1.0 / information
        step = inverse @ score
        gain = min(float(score @ step) / whole, 1.0 - 1e-12)
        p_value = p_value_of(score, noise, self.dof)
        if p_value < WORTH_A_LOOK:
            factor, blocks = self._uneven(columns, C, step, noise)
            noise = factor * noise
            p_value = p_value_of(score, noise, min(self.dof, blocks))
        if p_value >= limit and gain <= large:
            return None
        delta, std = C @ step, np.sqrt(np.diag(C @ inverse @ noise @ inverse @ C.T))
        evidence = float(-0.5 * self.dof * np.log1p(-gain) - len(step) * np.log(max(self.dof, 2.0)))
        half = plain.half * (1.0 if self.like is not None else np.sqrt(1.0 - gain))
        of_two = gain / self.evidence.share_of_two
        return Score(nuisance, delta, std, p_value, of_two, evidence, -plain.moved(columns, delta), half, self.dof)

    def _uneven(
        self, columns: Sequence[int], C: FloatArray, step: FloatArray, noise: FloatArray
    ) -> tuple[float, float]:
        """How much more a score varies from block to block than stationary noise lets it, at least 1; and blocks."""
        # Noise that grows with the speed, or is common to the joints, shows in the scores of blocks of time: at most 60
        # of a recording, of at least 8 rows. Fewer than 10 say nothing.
        count, scores = len(self.evidence.fixed), []
        share, places = C.T @ self.shares[:, columns].T, count + np.array(columns)
        for place, rest in enumerate(self.evidence.at_rest):
            total = np.zeros((len(step), self.evidence.tables[0][place].shape[1]))
            for weight, tables, residuals in zip(self.weights, self.evidence.tables, self._residuals, strict=True):
                rows = weight * (C.T @ tables[place][places] - share @ tables[place][self.columns])
                total += rows * (residuals[place] - step @ rows)
            samples = total.shape[1]
            blocks = max(1, samples if rest else min(60, samples // 8))
            starts = np.linspace(0, samples, blocks, endpoint=False).astype(np.intp)
            scores.append(np.add.reduceat(total, starts, axis=1).T)
        found = np.vstack(scores)
        if len(found) < 10:
            return 1.0, 10.0
        seen = found.T @ found * len(found) / (len(found) - 1)
        ratio = float(np.trace(scaled_inverse(noise) @ seen)) / len(step)
        return max(1.0, ratio), float(len(found))


def p_value_of(score: FloatArray, noise: FloatArray, dof: float) -> float:
    """Probability of a score this large in noise of that covariance."""
    if len(score) == 1:
        statistic = float(score[0] ** 2 / max(noise[0, 0], TINY))
    else:
        statistic = float(score @ scaled_inverse(noise) @ score)
    return float(scipy.special.fdtrc(len(score), dof, statistic / len(score)))
