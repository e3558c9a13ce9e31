"""From R factors to values, weights and an estimate, and back from an estimate to an R factor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotIdentifiableError
from exoid.estimate import Estimate, Evidence
from exoid.estimate.data import Input
from exoid.estimate.finding import ordered
from exoid.identification.findings.physics import unbalanced, with_negative
from exoid.regression.diagnostics import parameter_scale
from exoid.regression.least_squares import RANK, ROUNDING, TINY, RFactor, Solution, scaled_lstsq, solve, stack
from exoid.signals import FiniteDifference, ZeroPhase

from .findings import doubts_of, findings_of
from .settings import LAGS, Settings
from .state import Correlation, Information, State
from .stream import Stream

FEWEST_ROWS = 100
"""Fewest rows of a joint from which the size of its noise is taken, once there was an earlier value."""


def solved(settings: Settings, state: State, information: Information) -> State:
    """Put information in; values, standard deviations and weights follow as soon as it determines them."""
    state = state._replace(information=information)
    R = belief(settings, state)
    inverse, enough = inverse_of(R), information.rows[:-1] >= FEWEST_ROWS
    if inverse is None and not np.isfinite(state.std[0]):
        return state
    # Few rows may have given a joint a weight so large that the others count as rounding: weights follow all the same
    values = scaled_lstsq(R[:-1, :-1], R[:-1, -1]) if inverse is None else inverse @ R[:-1, -1]
    sizes, prior = residual_rms(information, values), bool(information.R[-1].any())
    if not settings.driven.all():  # rows of passive joints fit ever better as parameters go to zero: as `wls` has them
        table = information.R[:-1].reshape(-1, settings.count + 1)
        equal = residual_rms(information, scaled_lstsq(table[:, :-1], table[:, -1]))
        sizes = np.where(settings.driven, sizes, 1.0 / state.weights if prior else equal)
    state = state._replace(weights=np.where(enough, 1.0 / sizes, state.weights))
    return state if inverse is None else state._replace(values=values, std=np.sqrt((inverse**2).sum(axis=1)))


def inverse_of(R: FloatArray) -> FloatArray | None:
    """Inverse of the triangle of an R factor [R z]; None where it does not determine a parameter."""
    root = R[:-1, :-1]
    size = np.sqrt((root**2).sum(axis=0))
    # Less than RANK: a joint's weight may be a thousand times another's, whose rows still determine a parameter
    if not size.all() or not (np.abs(np.diag(root)) > ROUNDING * size).all():
        return None
    return np.asarray(scipy.linalg.lapack.dtrtri(root)[0])


def belief(settings: Settings, state: State) -> FloatArray:
    """[R z] of all that is known, R β = z + noise of unit size, (P + 1, P + 1); zero before the first rows."""
    independent = np.sqrt(state.correlation.inflation.mean())
    table = state.information.R * np.append(state.weights / independent, 1.0)[:, None, None]
    return np.asarray(np.linalg.qr(table.reshape(-1, settings.count + 1), mode="r"))


def root_of(settings: Settings, state: State) -> FloatArray:
    """L of the covariance P = L Lᵀ of what is known; of hardly anything where parameters are not determined."""
    inverse = inverse_of(belief(settings, state))
    return 1e6 * np.eye(settings.count) if inverse is None else inverse


def residual_rms(information: Information, values: FloatArray) -> FloatArray:
    """RMS residual of each joint [N·m], (n,); at least the rounding of the torque."""
    rows = np.maximum(information.rows[:-1], 1e-9)
    norms = np.linalg.norm(information.R[:-1] @ np.append(values, -1.0), axis=1)
    torque = np.linalg.norm(information.R[:-1, :, -1], axis=1) / np.sqrt(rows)
    return np.asarray(np.maximum(np.maximum(norms / np.sqrt(rows), 1e-9 * float(torque.max())), TINY))


def follow_residuals(settings: Settings, before: Correlation, e: FloatArray, used: NDArray[np.bool_]) -> Correlation:
    """Add the residuals (m, n) of a block to their autocorrelation, with a time constant of a minute."""
    m, width = len(e), LAGS + 1
    discount = float(np.exp(-m * settings.stride / settings.rate / 60.0))
    both, mask = np.concatenate([before.tail, e]), np.concatenate([before.used, used])
    lagged, masked = (  # (m, n, K + 1), lag 0 first
        np.lib.stride_tricks.sliding_window_view(x, width, axis=0)[-m:, :, ::-1] for x in (both, mask)
    )
    sums = discount * before.sums + np.einsum("mj,mjk->kj", e, lagged)
    counts = discount * before.counts + np.einsum("mj,mjk->kj", used.astype(np.float64), masked)
    # Behind a low-pass, and where the model errs, one row resembles the next. The variance of a mean of N such rows is
    # c/N of that of one, with c = 1 + 2 Σ_k ρ_k. Sums of slowly varying columns times rows have the same factor; those
    # of columns that vary faster than the noise a smaller one, so that intervals are rather too wide than too narrow.
    # ρ counts from 200 pairs of rows on, and up to the first below 0.02.
    products = sums / np.maximum(counts, 1.0)
    rho = np.divide(products[1:], products[0], out=np.zeros_like(sums[1:]), where=products[0] > 0.0)
    believed = np.cumprod((rho > 0.02) & (counts[1:] >= 200.0), axis=0)
    inflation = np.maximum(settings.filter_inflation, 1.0 + 2.0 * (np.minimum(rho, 1.0) * believed).sum(axis=0))
    return Correlation(both[-LAGS:], mask[-LAGS:], sums, counts, inflation)


def repeats(correlation: Correlation, rows: FloatArray) -> FloatArray:
    """Factor by which errors that repeat in each stride widen the variance of each joint's rows, (n,)."""
    # A share r of the variance that repeats every k rows does not average out: N rows hold N/k times the same errors.
    # r is the mean ρ of one, two, … strides, of the stride beyond the first negative ρ for which it is most sure. Of m
    # strides, less than 0.2/√m may be chance among as many lags (tuned on 0.5 s a stride, scripts/study_loads.py).
    sums, counts = correlation.sums, np.maximum(correlation.counts, 1.0)
    rho = np.divide(sums / counts, sums[0] / counts[0], out=np.zeros_like(sums), where=sums[0] > 0.0)
    later = np.cumsum(rho < 0.0, axis=0) > 0
    rho = np.where(later & (counts >= 200.0), rho, 0.0)
    lags = np.arange(1, len(rho))
    means = np.array([rho[lag::lag].mean(axis=0) for lag in lags])
    sure = means * np.sqrt(LAGS // lags)[:, None]
    best, joints = sure.argmax(axis=0), np.arange(rho.shape[1])
    share = np.where(sure[best, joints] > 0.2, np.minimum(means[best, joints], 1.0), 0.0)
    return np.asarray(1.0 + share * np.maximum(rows[: len(share)] / lags[best] - 1.0, 0.0))


def estimate_of(settings: Settings, state: State, stream: Stream) -> Estimate:
    """Make the estimate of a state, with findings."""
    # The covariance is A⁻¹ (Σ_j w_j⁴ s_j² c_j A_j) A⁻¹ with A = Σ_j w_j² A_j: the noise of joint j has the size s_j,
    # and c_j of its rows say as much as one independent row.
    model, (R, rows) = settings.model, state.information
    if not rows[:-1].any() and not R[-1].any():
        what, remedy = "no row so far: nothing can be estimated", "move the leg, and update for longer"
        raise NotIdentifiableError(what, remedy=remedy, parameters=model.names)
    inflation = state.correlation.inflation
    samples = np.append(rows[:-1] / inflation, rows[-1])
    factors = [RFactor(R[j], round(rows[j]), float(samples[j])) for j in range(len(R))]

    def rms_of(values: FloatArray) -> FloatArray:
        """RMS residuals; those of earlier weights where rows are too few to tell the size of the noise."""
        few = (rows[:-1] < FEWEST_ROWS) & bool(R[-1].any())
        return np.asarray(np.where(few, 1.0 / state.weights, residual_rms(state.information, values)))

    first = state.values if R[-1].any() else solve(stack(factors), model.names).values
    weights = np.where(settings.driven, 1.0 / rms_of(first), state.weights)
    own = np.append(weights, np.sqrt(np.mean(inflation)))
    try:
        solution = solve(stack(factors, own.tolist()), model.names)
    except NotIdentifiableError:
        # What was given up is known 1e5 times worse: no rank is left of it beside the rows of a joint that weighs more
        both = stack(factors, own.tolist()).R
        inverse = inverse_of(both) if R[-1].any() else None
        if inverse is None:
            raise
        A = inverse @ inverse.T
        solution = Solution(inverse @ both[:-1, -1], A, 1.0 / RANK, samples.sum() - len(A), A, np.zeros_like(A))
    rms = rms_of(solution.values)
    inflation = inflation * repeats(state.correlation, rows)
    noise = np.append(weights**4 * rms**2 * inflation, own[-1] ** 4)
    middle = np.einsum("s,sij,sik->jk", noise, R[:, :, :-1], R[:, :, :-1])
    unbiased = max(samples.sum(), 2.0) / max(solution.dof, 1.0)
    covariance = unbiased * solution.inverse @ middle @ solution.inverse
    scale = parameter_scale([factor for factor in factors[:-1] if factor.rows] or factors)
    source = None if settings.cutoff is None else "passed to the recursive estimator"
    found = Estimate(
        model=model,
        values=solution.values,
        covariance=0.5 * (covariance + covariance.T),
        condition_number=max(solution.condition_number, 1.0),
        dof=max(solution.dof, 1.0),
        residual_rms=rms,
        estimator="recursive wls",
        preparation=FiniteDifference() if settings.cutoff is None else ZeroPhase(cutoff=settings.cutoff),
        inputs=(Input("stream", "", state.samples, settings.rate, passive=settings.passive),),
        evidence=Evidence(parameter_scale=scale, cutoff_source=source),
    )
    apart = unbalanced(model, ([one] for one in factors[:-1]), found.values)
    findings = ordered((*findings_of(settings, state, stream), *doubts_of(found, state), *apart))
    return with_negative(replace(found, findings=findings))


def started(settings: Settings, state: State, start: Estimate) -> State:
    """Put an estimate's values and covariance in the place of what was known before the rows."""
    floor = 1e-9  # standard deviation of what is known exactly, over the scale
    scale = np.sqrt(np.diag(start.covariance))
    scale = np.where(scale > 0.0, scale, floor * np.maximum(np.abs(start.values), 1.0))
    sizes, axes = np.linalg.eigh(start.covariance / np.outer(scale, scale))
    root = (axes / np.sqrt(np.maximum(sizes, floor))).T / scale
    R = state.information.R.copy()
    table = np.zeros((settings.count + 1, settings.count + 1))
    table[:-1, :-1], table[:-1, -1] = root, root @ start.values
    if np.abs(table).max() > 1e150:  # whose squares no number holds
        what = "the start has values or standard deviations that no leg has"
        raise BadArgumentError(what, where=start.leg.description.name, remedy="identify the leg again")
    R[-1] = np.linalg.qr(table, mode="r")
    information = Information(R, np.append(np.zeros(settings.n), start.dof))
    state = state._replace(information=information, checkpoints=(information,) * 3)
    return state._replace(values=start.values.copy(), std=scale, weights=1.0 / np.maximum(start.residual_rms, 1e-9))
