"""Doubt about the form of friction: how much other forms may add to the torque, by the residuals of the training."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.estimate.evidence import MotionRanges
from exoid.estimate.finding import Finding
from exoid.estimate.model_error import COUNT, KINDS, AlternativeFriction, ModelError
from exoid.regression.diagnostics import JointNoise
from exoid.regression.least_squares import rms_residual, scaled_inverse
from exoid.regression.residuals import matrix_root
from exoid.regression.row_data import Rows
from exoid.regression.rows import chain, decimated, form_rows, prepare
from exoid.torques import Motion
from exoid.torques.catalog import radians

from .findings.checkup import Checkup
from .findings.sample import FittedLeg, few_of
from .findings.score import in_half_widths
from .findings.search import DOUBTFUL_MOVE
from .problem import Fitted

SMALLEST = 1e-12  # norm to divide by

CERTAIN = 5.0
"""Log evidence from which on friction of another form is named: 150 to 1. Walkers (seeds 20 to 25) had at most 3.6."""

SIZES = np.array([1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1])[:, np.newaxis]
"""Prior sizes of an alternative's torque, as parts of the RMS torque of its joint, (S, 1)."""


class FrictionRows(NamedTuple):
    """Usable rows of one row of the equation, with friction of other forms."""

    W: FloatArray  # columns of the parameters, (N, P)
    Z: FloatArray  # columns of the alternatives: those of its joint, (N, K), or of all joints, (N, n K)
    tau: FloatArray  # measured side, (N,)
    residual: FloatArray  # what the parameters leave of it, (N,)
    joint: int  # its joint; −1 for a row of no joint
    weight: float  # one over the RMS residual
    share: float  # independent samples over rows

    @classmethod
    def of(
        cls, parts: Sequence[Rows], values: FloatArray, row: int, joint: int, rms: float, noise: JointNoise
    ) -> FrictionRows:
        """Take one row of the equation of several recordings, the last columns of which are alternatives."""
        both = np.concatenate([one.W[one.usable[:, row], row] for one in parts])
        tau = np.concatenate([one.tau[one.usable[:, row], row] for one in parts])
        W, Z = both[:, : len(values)], both[:, len(values) :]
        size = float(np.sqrt(np.mean(tau**2))) if len(tau) else 0.0
        share = min(max(noise.effective_samples / max(noise.samples, 1), 0.0), 1.0)
        return cls(W, Z, tau, tau - W @ values, joint, 1.0 / max(rms, 1e-9 * size, SMALLEST), share)

    def own(self, columns: int) -> slice:
        """Places of the alternatives among those of all joints."""
        first = 0 if self.Z.shape[1] == columns else self.joint * COUNT
        return slice(first, first + self.Z.shape[1])


class FrictionDoubt(NamedTuple):
    """Normal equations of coefficients c of friction of other forms, beside the parameters that absorb part of it."""

    rows: Sequence[FrictionRows]  # rows of the training on which friction acts
    speed: FloatArray  # largest speed of the training [rad/s], (n,)
    absorbed: FloatArray  # G, the alternatives that free parameters absorb, (P, n K)
    information: FloatArray  # H = XᵀX, (n K, n K)
    score: FloatArray  # h = Xᵀr, (n K,)
    unit: FloatArray  # coefficient that gives an alternative the RMS torque of its joint; 0 for one that never acts

    @classmethod
    def of(
        cls, rows: Sequence[FrictionRows], values: FloatArray, fixed: FloatArray, speed: FloatArray
    ) -> FrictionDoubt:
        """Form the normal equations."""
        # The candidates are presliding, Stribeck, quadratic and load-dependent friction, each alone and all together.
        # Each has coefficients c ~ N(0, s²), with s from 1e-4 to 0.1 of a joint's RMS torque. With X the alternatives'
        # weighted rows less what the parameters absorb, and r the weighted residuals, c has the posterior covariance
        # S = (XᵀX + s⁻²)⁻¹ and mean S Xᵀr, and the evidence is log p = ½ rᵀX S Xᵀr − ½ log|1 + s² XᵀX|. Rows count by
        # their share of independent samples.
        count = COUNT * len(speed)
        WW, G, H = np.zeros((len(values),) * 2), np.zeros((len(values), count)), np.zeros((count, count))
        torques, columns, h = np.zeros((3, count))  # sums of squares, of the torque and of an alternative in it
        for one in rows:
            own = one.own(count)
            WW += one.weight**2 * one.W.T @ one.W
            G[:, own] += one.weight**2 * one.W.T @ one.Z
            torques[own] += one.Z.any(axis=0) * (one.tau @ one.tau)
            columns[own] += (one.Z**2).sum(axis=0)
        used = np.isnan(fixed) & (np.diag(WW) > SMALLEST)
        G[used], G[~used] = scaled_inverse(WW[np.ix_(used, used)]) @ G[used], 0.0
        for one in rows:
            X = -one.W @ G
            X[:, one.own(count)] += one.Z
            H += one.share * one.weight**2 * X.T @ X
            h += one.share * one.weight**2 * X.T @ one.residual
        unit = np.sqrt(np.divide(torques, columns, out=np.zeros(count), where=columns > SMALLEST**2))
        # rows of a base, which no friction acts on, have other units, and say nothing of a joint
        return cls([one for one in rows if one.Z.any()], speed, G, H, h, unit)

    def model_error(self) -> ModelError:
        """Average E[c cᵀ] over all candidates by their evidence (Bayesian model averaging)."""
        joints, count, total = len(self.speed), len(self.unit), np.zeros_like(self.information)
        kinds = (*KINDS.values(), tuple(range(COUNT)))
        candidates = [self._candidate(np.tile(np.isin(np.arange(COUNT), columns), joints)) for columns in kinds]
        evidence = np.array([one.evidence for one in candidates])
        weights = np.exp(evidence - np.max(evidence))
        for weight, one in zip(weights / weights.sum(), candidates, strict=True):
            inner = np.diag(weight @ one.shrunk) + (one.means.T * weight) @ one.means
            total[np.ix_(one.chosen, one.chosen)] += one.vectors @ inner @ one.vectors.T
        L = matrix_root(total)
        squares, samples = np.zeros((2, joints + 1))  # those of rows of no joint behind the others
        for row in self.rows:
            squares[row.joint] += np.sum((row.Z @ L[row.own(count)] - row.W @ (self.absorbed @ L)) ** 2)
            samples[row.joint] += len(row.tau)
        mean = squares / np.maximum(samples, 1.0)
        explained = np.where(samples > 0.0, mean, mean[-1])[:-1]
        return ModelError(self.speed, -self.absorbed @ L, L.reshape(joints, COUNT, -1), explained)

    def findings(self, joints: Sequence[str], names: Sequence[str], half: FloatArray) -> Iterator[Finding]:
        """Name friction of another form, given half widths of the parameters' intervals."""
        for j, joint in enumerate(joints):
            own = [self._candidate(np.isin(np.arange(len(self.unit)) - j * COUNT, each)) for each in KINDS.values()]
            evidence = [np.logaddexp.reduce(one.evidence) - np.log(len(SIZES)) for one in own]
            best = int(np.argmax(evidence))
            if evidence[best] < CERTAIN:
                continue
            one, form = own[best], FORMS[[*KINDS][best]]
            c = one.vectors @ one.means[np.argmax(one.evidence)]
            H, h, G = self.information[np.ix_(one.chosen, one.chosen)], self.score[one.chosen], self.absorbed
            left = sum(x.share * x.weight**2 * x.residual @ x.residual for x in self.rows if x.joint in (j, -1))
            share = float((2.0 * c @ h - c @ H @ c) / left)
            moved = in_half_widths(G[:, one.chosen] @ c, half) > DOUBTFUL_MOVE
            text = f"{form} would explain {share:.0%} of what is left of the torque of {joint}"
            parameters = tuple(name for name, is_moved in zip(names, moved, strict=True) if is_moved)
            yield Finding("unmodelled-friction", joint, share, "1", "warning", text, REMEDY, parameters=parameters)

    def _candidate(self, acting: BoolArray) -> _Candidate:
        """Find the coefficients of some alternatives with each prior size."""
        chosen = np.flatnonzero(acting & (self.unit > 0.0))
        scale = self.unit[chosen]
        squares, vectors = np.linalg.eigh(scale[:, None] * self.information[np.ix_(chosen, chosen)] * scale)
        shrunk = SIZES**2 / (1.0 + SIZES**2 * np.clip(squares, 0.0, None))
        turned = vectors.T @ (scale * self.score[chosen])
        evidence = 0.5 * (shrunk @ turned**2 + np.log(shrunk / SIZES**2).sum(axis=1))
        return _Candidate(chosen, scale[:, None] * vectors, shrunk, shrunk * turned, evidence)


class _Candidate(NamedTuple):
    """Some alternatives: their coefficients c = V m with each prior size, m of the covariance diag(s)."""

    chosen: NDArray[np.intp]  # their places, (C,)
    vectors: FloatArray  # V, (C, C)
    shrunk: FloatArray  # s, (S, C)
    means: FloatArray  # mean of m, (S, C)
    evidence: FloatArray  # log evidence over that of none, (S,)


FORMS = {
    "presliding": "presliding",
    "stribeck": "Stribeck friction",
    "quadratic": "quadratic friction",
    "load": "friction that grows with the load",
}
REMEDY = "add a term of this form; exoid select compares those of a leg in the air"


def doubt_in_the_air(
    fitted: FittedLeg, checkup: Checkup, residual_rms: FloatArray, noise: Sequence[JointNoise]
) -> FrictionDoubt | None:
    """Doubt about the friction of a leg none of whose rows depends on contacts."""
    if checkup.ranges is None or not checkup.moving:
        return None
    columns = np.r_[: len(fitted.values), -COUNT:0]
    parts = [one._replace(W=one.W[..., columns]) for one in checkup.moving]
    each = enumerate(zip(residual_rms.tolist(), noise, strict=True))
    rows = [FrictionRows.of(parts, fitted.values, j, j, *of_joint) for j, of_joint in each]
    return FrictionDoubt.of(rows, fitted.values, fitted.fixed, checkup.ranges.speed)


def doubt_on_ground(
    fitted: Fitted, parts: Sequence[int], noise: Sequence[JointNoise]
) -> tuple[FrictionDoubt, MotionRanges]:
    """Doubt about the friction of a leg that stands, and the ranges of its motion."""
    problem, values, leg = fitted.problem, fitted.values(parts[0]), fitted.models[parts[0]].leg
    ready = [
        [decimated(prepare(group.model, one, group.preparation, stops=False)) for one in few_of(group.data)]
        for group in (problem.groups[k] for k in parts)
        if group.preparation is not None
    ]
    ranges = reduce(MotionRanges.joined, (MotionRanges.of(one.motion, one.inside) for x in ready for one in x))
    other = AlternativeFriction(values[: len(leg.parameter_names)], ranges.speed, radians(leg))
    rows = list[FrictionRows]()
    for k, of_group in zip(parts, ready, strict=True):
        model, logs = replace(problem.groups[k].model, extras=(other,)), list[Rows]()
        for one in of_group:
            assert isinstance(one.motion, Motion)
            whole = one._replace(motion=one.motion._replace(states=model.motion(*one.motion[:4]).states))
            logs.append(chain([form_rows(model, whole, stretch) for stretch in whole.stretches()]))
        first = int(problem.starts[0, k])
        for r, (joint, of_row) in enumerate(zip(model.row_joints, problem.groups[k].by_row, strict=True)):
            rows.append(FrictionRows.of(logs, values, r, joint, rms_residual(of_row, values), noise[first + r]))
    fixed = problem.prior_knowledge.fixed_values(problem.names)[problem.places[parts[0]][: len(values)]]
    return FrictionDoubt.of(rows, values, fixed, ranges.speed), ranges
