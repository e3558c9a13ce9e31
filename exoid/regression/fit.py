"""Ordinary and weighted least squares, the covariance under the noise of residuals, and the samples behind it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray, FloatArray

from .least_squares import RANK_OF_SQUARES, ROUNDING, TINY, RFactor, stack
from .noise import AutoregressiveNoise
from .problem import Fit, LeastSquaresProblem, Noises, RowProblem, RowSource, Uncertainty
from .residuals import Series, matrix_root, sandwich, series

BLOCKS = 20
"""Rows of all recordings are cut into about so many blocks at least, and into more if there are many samples."""

ACCURACY = 5e-4
"""Accuracy of the rows, over the RMS torque of their joint: no interval is narrower than for noise of this size.

Residuals of a simulation without noise are smaller, but they are the errors of filters and differences. These are not
random, and what they do to a parameter is not seen in the residuals.
"""


def ols(problem: LeastSquaresProblem) -> Fit:
    """Weigh every torque row alike, whichever joint it comes from: min Σ ‖W β − τ‖² (doc. 1, eq. (17)).

    Args:
        problem: The problem.

    Returns:
        The fit.
    """
    return Fit(problem.solve(stack(problem.r_factors)), [1.0] * len(problem.r_factors))


def wls(problem: LeastSquaresProblem) -> Fit:
    """Each joint's rows are divided by that joint's own residual of a fit before, of which the first is ordinary.

    A hip whose sensor errs by 1 N·m then no longer drowns an ankle whose sensor errs by 0.1 N·m.

    Args:
        problem: The problem.

    Returns:
        The fit.
    """
    # The first fit may sacrifice a joint of small torques. Where its residual then falls by more than half, its weight
    # was too small: with more rounds, 79 machines of the proving ground (seeds below 80) have 0.95 of the NRMSE.
    factors, floor, measured = problem.r_factors, noise_floor(problem), has_torque(problem)
    solution, rms = problem.solve(stack(factors)), np.full(len(factors), np.inf)
    for _ in range(6):
        left = [max(each.residual(solution.values) / math.sqrt(max(each.rows, 1)), floor) for each in factors]
        settled = np.where(measured | np.isinf(rms), left, rms)
        if (2.0 * settled >= rms).all():
            break
        rms = settled
        solution = problem.solve(stack(factors, (1.0 / rms).tolist()))
    return Fit(solution, (1.0 / rms).tolist())


def has_torque(problem: LeastSquaresProblem) -> BoolArray:
    """Whether rows have a torque: those of a passive joint or a free base fit ever better as parameters go to zero."""
    # so they keep the weight of a fit that did not know theirs
    return np.array([bool(each.R[:, -1].any()) for each in problem.r_factors])


def noise_floor(problem: LeastSquaresProblem) -> float:
    """Size below which a residual is rounding [N·m]."""
    torque = max(float(np.linalg.norm(t.R[:, -1])) / math.sqrt(max(t.rows, 1)) for t in problem.r_factors)
    # Residuals below this fraction of the leg's torque are rounding, not noise, and raise no weight further
    return 1e-9 * torque


def uncertainty_of(problem: RowProblem, fit: Fit, *, white: bool) -> Uncertainty:
    """Find the noise in the residuals of a fit and the covariance under it."""
    found = fit.uncertainty or correlated_uncertainty(problem, fit)
    if white:
        found = found._replace(covariance=fit.solution.covariance, dofs=None)
    if fit.uncertainty:
        return found
    # No variance is below that for white noise of `ACCURACY` of each joint's RMS torque, which then comes on top
    least = np.zeros_like(found.covariance)
    for r_factor, weight in zip(problem.r_factors, fit.weights, strict=True):
        if r_factor.rows:
            size = ACCURACY * float(np.linalg.norm(r_factor.R[:, -1])) / math.sqrt(r_factor.samples)
            root = weight**2 * size * r_factor.R[:, :-1] @ fit.solution.inverse
            least += root.T @ root
    if (np.diag(found.covariance) >= np.diag(least)).all():
        return found
    return found._replace(covariance=found.covariance + least)


def correlated_uncertainty(rows: RowSource, fit: Fit) -> Uncertainty:
    """Uncertainty of a least-squares estimate for correlated noise that need not be stationary, nor independent."""
    found = sandwich(rows, fit)
    changes, dofs, blocks = jackknife(rows, fit, found.noises)
    return Uncertainty(combine(found.covariance, changes, blocks), dofs, found.noises) if blocks else found


def combine(covariance: FloatArray, changes: FloatArray, blocks: int) -> FloatArray:
    """Combine the covariance of a noise model with changes D by blocks, whose squares add up to variances."""
    # DᵀD is singular, as blocks B are few. With D in units of the noise model, and axes E of its correlations R, it is
    # averaged with E diag(EᵀDᵀDE) Eᵀ, which counts as P blocks. A combination that the log determines stays certain, as
    # D along its axis is small. To scale each parameter alone makes it as uncertain as those that it confounds.
    uncertain = np.diag(covariance) > TINY  # others are known
    scale = np.sqrt(np.where(uncertain, np.diag(covariance), 1.0))
    sizes, E = np.linalg.eigh(covariance / np.multiply.outer(scale, scale))
    D = changes / scale
    aim = np.linalg.norm(D, axis=0)
    share = blocks / (blocks + np.count_nonzero(uncertain))
    root = np.hstack([math.sqrt(1.0 - share) * E * np.linalg.norm(D @ E, axis=0), math.sqrt(share) * D.T])
    # Variances are those of D as far as this leaves the rest certain: (R⁻¹)_ii^(−½) of a deviation is a parameter's own
    own = 1.0 / np.sqrt(E**2 @ (1.0 / np.maximum(sizes, max(RANK_OF_SQUARES * sizes[-1], TINY))))
    averaged = np.linalg.norm(root, axis=1)
    ratio = np.divide(aim, averaged, out=np.ones(len(aim)), where=averaged > 0.0)
    root *= (uncertain * scale * (1.0 + own * (ratio - 1.0)))[:, None]
    return np.asarray(root @ root.T)


def samples_left(
    rows: Sequence[RFactor], inverse: FloatArray, samples: Sequence[float], free: int
) -> tuple[FloatArray, FloatArray]:
    """Count independent samples less parameters, behind the rows of each group, (G,), and each parameter, (P,)."""
    # The rows W_g of group g, whose N_g samples are independent, are fitted by p_g = tr(A⁻¹ W_gᵀ W_g)
    # parameters, with A = Σ_g W_gᵀ W_g: these add up to P, and leave ν_g = N_g − p_g. The variance of a
    # parameter is the sum of what each group brings in, v_g = (A⁻¹ W_gᵀ W_g A⁻¹)_ii, and has (Σ v_g)² / Σ (v_g²
    # / ν_g) (Welch and Satterthwaite).
    if len(rows) == 1:
        left = max(1.0, samples[0] - free)
        return np.array([left]), np.full(len(inverse), left)
    factors = [of_group.R[:, : len(inverse)] for of_group in rows]
    roots = [R @ inverse for R in factors]
    fitted = np.array([np.einsum("ij,ij->", R, root) for R, root in zip(factors, roots, strict=True)])
    fitted *= free / fitted.sum()
    of_groups = np.maximum(1.0, np.array(samples) - fitted)
    brought = np.array([(root**2).sum(axis=0) for root in roots])
    total, spread = brought.sum(axis=0), (brought**2 / of_groups[:, None]).sum(axis=0)
    each = np.divide(total**2, spread, out=np.full(len(total), of_groups.min()), where=spread > 0.0)
    return of_groups, np.asarray(each)


def jackknife(rows: RowSource, fit: Fit, noises: Noises) -> tuple[FloatArray, FloatArray, int]:
    """Leave out one block of rows after the other, all joints at once: changes of the parameters, (B + P, P).

    Their squares add up to variances; the last are those of priors. Beside them stand the degrees of freedom, (P,),
    infinite where no noise of the rows enters, and the number of blocks B, 0 if there are too few to say anything.
    """
    # With A = WᵀW, block b has the score s_b and the information G_b. Without the block, the estimate moves by
    # d_b = −(A − G_b)⁻¹ s_b, and the variance of parameter i is (B − 1)/B Σ_b (d_bi − mean)² (Efron 1982). Its
    # degrees of freedom are 3 (Σ_b d_bi²)² / Σ_b d_bi⁴, at most B − 1. Joints share blocks, so that noise may
    # be common to them, and each block has noise of its own size.
    #
    # Blocks are independent only if they are long beside the memory of the noise. The rows of a joint are
    # therefore whitened by its noise model Γ = σ² Φ⁻¹ Φ⁻ᵀ. Sample t of the sandwich WᵀΓW has the score y_t η_t
    # and the information y_t x̃_tᵀ, with y = Φ⁻ᵀ X, x̃ = Φ X, and η = Φ e the whitened residuals. Both sum up
    # to those of the rows as they are: Σ_t y_t η_t = Xᵀ e, and Σ_t y_t x̃_tᵀ = XᵀX.
    inverse = fit.solution.inverse
    root = matrix_root(inverse)
    changes = np.vstack([_changes(noises, root, fit.clip, parts) for parts in series(rows, fit)])
    moved = np.abs(changes) > ROUNDING * np.abs(changes).max(axis=0, initial=0.0)
    count = np.maximum(moved.sum(axis=0), 1)
    changes = np.where(moved, changes - changes.sum(axis=0) / count, 0.0)
    squares = changes**2
    dofs = 3.0 * squares.sum(axis=0) ** 2 / np.maximum((squares**2).sum(axis=0), TINY)
    changes = np.vstack([changes * np.sqrt(1.0 - 1.0 / count), (inverse @ matrix_root(fit.solution.prior_noise)).T])
    of_rows, variances = (changes[: -len(inverse)] ** 2).sum(axis=0), (changes**2).sum(axis=0)
    dofs = np.clip(dofs, 1.0, np.maximum(count - 1, 1)) * (variances / np.maximum(of_rows, TINY)) ** 2
    return changes, np.where(of_rows > TINY, dofs, np.inf), len(moved) if len(moved) > 1 else 0


def _changes(noises: Noises, root: FloatArray, clip: float, parts: Sequence[Series]) -> FloatArray:
    """Change of the estimate without each block of one recording, (blocks, P)."""
    # so that all recordings have as many blocks, or ∛N of N independent samples if that is more
    heard = [noise for noise in (noises[part.kind, part.joint] for part in parts) if noise.samples]
    samples = min((noise.samples for noise in heard), default=1.0)
    independent = min((noise.samples * noise.effective_share for noise in heard), default=1.0)
    length = max(1, int(np.ceil(samples / max(BLOCKS, independent ** (1.0 / 3.0)))))
    cuts = range(0, len(parts[0].residual), length)
    scores, informations = np.zeros((len(cuts), len(root))), np.zeros((len(cuts), len(root), len(root)))
    for part in parts:
        X, Y, residual = _whitened(noises[part.kind, part.joint], part, clip)
        left, right = root[part.columns].T @ (Y * part.stands_for), X.T @ root[part.columns]
        for block, start in enumerate(cuts):
            rows = slice(start, start + length)
            scores[block] += left[:, rows] @ residual[rows]
            informations[block] += left[:, rows] @ right[rows]
    U, sizes, Vt = np.linalg.svd(np.eye(len(root)) - informations)
    # Without a block, at least this part of the information on any direction counts as left
    turned = np.einsum("bij,bi->bj", U, scores) / np.maximum(sizes, 0.1)
    return np.asarray(-np.einsum("bij,bi->bj", Vt, turned) @ root.T)


def _whitened(noise: AutoregressiveNoise, part: Series, clip: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Whiten the rows of a joint: Φ X, Φ⁻ᵀ X and Φ e."""
    # Noise looks the same with time reversed: η_t = e_t − Σ_i φ_i e_{t+i} is white, and Y is X filtered forwards.
    # Beyond the end and where samples are left out, e and X are zero, which leaves Σ y η = Xᵀ e exact.
    Y = scipy.signal.lfilter([1.0], noise.polynomial, part.X) if noise.order else part.X
    # clipped residuals carry no information
    rows = np.vstack([part.X * (np.abs(part.residual) < clip), part.residual])
    white = np.zeros_like(rows)
    for k, coefficient in enumerate(noise.polynomial[: rows.shape[1]]):
        white[:, : rows.shape[1] - k] += coefficient * rows[:, k:]
    return white[:-1], Y, white[-1]
