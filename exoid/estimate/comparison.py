"""Two estimates side by side: do they differ by more than their errors?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.regression.least_squares import RANK_OF_SQUARES
from exoid.tools.json_values import attributes, named
from exoid.tools.read_only import ReadOnly
from exoid.tools.tables import DataTable, Report, make_table, with_error

from .data import EstimateData

SIGNIFICANT = 0.05  # a smaller probability is called a difference


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(ReadOnly, Report):
    """Wald test of two estimates, parameter by parameter and of all together; prints itself as a table.

    Attributes:
        names: Parameters that both have, (P,).
        units: Their units.
        difference: Second less first, (P,).
        std: Its standard deviation, (P,).
        p_values: p-value of each difference alone: probability of a larger one between estimates of the same leg, (P,).
        adjusted: The same for the largest of all differences (Holm), so that one in twenty comparisons of equal legs,
            not one in twenty parameters, is called different, (P,).
        statistic: F statistic of all differences together.
        p_value: p-value of all differences together.
        notes: Notes on what is known or has a prior in both.
        dof: Degrees of freedom of each difference, (P,).
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    difference: FloatArray
    std: FloatArray
    p_values: FloatArray
    adjusted: FloatArray
    statistic: float
    p_value: float
    notes: tuple[str, ...] = ()
    dof: FloatArray = field(kw_only=True)

    @property
    def differ(self) -> bool:
        """Whether the legs differ, at 5 %, all parameters together."""
        return self.p_value < SIGNIFICANT

    @property
    def different(self) -> tuple[str, ...]:
        """Parameters that differ, at 5 % of all."""
        return tuple(name for name, p in zip(self.names, self.adjusted, strict=True) if p < SIGNIFICANT)

    def to_json(self) -> dict[str, Any]:
        """Turn a comparison into what JSON can hold.

        Returns:
            Differences and p-values by name, and the test of all.
        """
        by_name = ("difference", "std", "p_values", "adjusted", "units")
        return {
            **{key: named(self.names, getattr(self, key)) for key in by_name},
            "remarks": list(self.notes),
            **attributes(self, "statistic", "p_value"),
        }

    def __repr__(self) -> str:
        """Name the parameters that differ."""
        return f"Comparison(p_value={self.p_value:.3g}, different: {', '.join(self.different) or 'none'})"

    def _report(self) -> list[DataTable | str]:
        """Title, table, and conclusion."""
        rows = [
            (name, *with_error(difference, std), unit, f"{p:.3f}", f"{adjusted:.3f}")
            for name, difference, std, unit, p, adjusted in zip(
                self.names, self.difference, self.std, self.units, self.p_values, self.adjusted, strict=True
            )
        ]
        table = make_table(("parameter", "difference", "± std", "unit", "p", "p of all (Holm)"), rows)
        conclusion = "the estimates differ" if self.differ else "no difference beyond their errors"
        return [
            f"Second less first estimate, {len(rows)} common parameters",
            table,
            f"all together: F = {self.statistic:.2f}, p = {self.p_value:.2g}: {conclusion}",
            f"different at 5 % of all: {', '.join(self.different) or 'none'}",
            *(f"note: {note}" for note in self.notes),
        ]


def compare(first: EstimateData, second: EstimateData) -> Comparison:
    """Test whether two estimates of the same parameters agree: left and right, before and after, with and without.

    With d = β₂ − β₁ on the common names and C = C₁ + C₂, each d_i / √C_ii follows Student's t with the degrees of
    freedom of Welch and Satterthwaite, and dᵀ C⁻¹ d Hotelling's T², if both legs are the same. A prior that both were
    given counts as two independent ones, and a note says so. Parameters that were held fixed in both are not tested.

    Two estimators of one recording, or recordings that overlap, have errors that depend on each other in a way that
    the estimates do not say. The error of a difference is then at most the sum of both errors, and C at most
    2 (C₁ + C₂). These bounds take the place of C: a p-value is at most the one stated, and a note says so.

    Args:
        first: An estimate.
        second: Another one of the same parameters.

    Returns:
        Differences with their tests.

    Raises:
        ExoidError: They are of two machines, there is no common parameter, or units differ.
    """
    joints = [estimate.model.leg.joint_labels for estimate in (first, second)]
    if joints[0] != joints[1]:
        what = f"estimates of two machines, with joints {', '.join(joints[0])} and {', '.join(joints[1])}"
        raise BadArgumentError(what, remedy="compare estimates of one machine, or of two of its legs")
    shared = {source.sha256 for source in first.inputs} & {source.sha256 for source in second.inputs}
    names = tuple(name for name in first.names if name in second.names)
    if not names:
        raise BadArgumentError(
            f"no common parameter: {', '.join(first.names)} and {', '.join(second.names)}",
            remedy="identify the same leg with the same terms",
        )
    one, other = ([estimate.names.index(name) for name in names] for estimate in (first, second))
    units = tuple(first.units[k] for k in one)
    if units != tuple(second.units[k] for k in other):
        raise BadArgumentError("units of the common parameters differ", remedy="compare estimates of legs of one kind")
    difference = second.values[other] - first.values[one]
    held = np.array([name in first.prior_knowledge.known and name in second.prior_knowledge.known for name in names])
    C1, C2 = first.covariance[np.ix_(one, one)], second.covariance[np.ix_(other, other)]
    dof1, dof2, least = first.dof_each[one], second.dof_each[other], min(first.dof, second.dof)
    notes, std, C, dof = _notes(first, second), None, C1 + C2, welch(np.diag(C1), np.diag(C2), dof1, dof2)
    if shared:  # of dependent errors: the sum of standard deviations (Cauchy and Schwarz), and 2 (C₁ + C₂)
        std, C, dof = np.sqrt(np.diag(C1)) + np.sqrt(np.diag(C2)), 2.0 * C, np.minimum(dof1, dof2)
        sources = ", ".join(dict.fromkeys(source.name for source in first.inputs if source.sha256 in shared))
        note = (
            f"both estimates were made from {sources}: their errors depend on each other, so ± is the largest error "
            "that the difference can have, the sum of both, and p-values are upper bounds"
        )
        notes = (note, *notes)
    found = wald(names, units, difference, C, dof, least, held=held, notes=notes, std=std)
    doubts = [one for each in (first, second) for one in each.findings if one.severity != "info"]
    doubtful = [name for name in found.different if any(name in one.parameters for one in doubts)]
    if doubtful:
        kinds = dict.fromkeys(one.kind for one in doubts if not set(one.parameters).isdisjoint(doubtful))
        note = f"{', '.join(doubtful)} may differ by what was found in the logs ({', '.join(kinds)}), not by the leg"
        found = replace(found, notes=(*found.notes, note))
    return found


def wald(
    names: tuple[str, ...],
    units: tuple[str, ...],
    difference: FloatArray,
    covariance: FloatArray,
    dof: FloatArray,
    least: float,
    *,
    held: NDArray[np.bool_] | None = None,
    notes: tuple[str, ...] = (),
    std: FloatArray | None = None,
) -> Comparison:
    """Test whether differences are zero, each alone and all together."""
    std = np.sqrt(np.clip(np.diag(covariance), 0.0, None)) if std is None else std
    tested = np.ones(len(names), dtype=np.bool_) if held is None else ~held
    known = std == 0.0
    sure = tested & known & (difference != 0.0)  # no error explains these
    p = 2.0 * scipy.stats.t.sf(np.abs(difference) / np.where(known, 1.0, std), dof)
    p_values = np.where(sure, 0.0, np.where(tested & ~known, p, 1.0))
    within = difference[tested], covariance[np.ix_(tested, tested)], least
    statistic, p_value = (np.inf, 0.0) if sure.any() else hotelling(*within)
    dof = np.broadcast_to(np.asarray(dof, dtype=np.float64), difference.shape).copy()
    return Comparison(names, units, difference, std, p_values, holm(p_values), statistic, p_value, notes, dof=dof)


def _notes(first: EstimateData, second: EstimateData) -> tuple[str, ...]:
    """Say what differs in what was known before, and which priors count twice."""
    held, held_too = first.prior_knowledge.known, second.prior_knowledge.known
    unlike = [f"{name} ({x:.6g} and {held_too[name]:.6g})" for name, x in held.items() if held_too.get(name, x) != x]
    priors = second.prior_knowledge.prior.values
    of_both = [name for name, pair in first.prior_knowledge.prior.values.items() if priors.get(name) == pair]
    notes, urdfs = [], [each.model.leg.description for each in (first, second)]
    if urdfs[0].sha256 != urdfs[1].sha256:
        notes.append(f"the URDFs {' and '.join(urdf.name for urdf in urdfs)} differ: these may be two machines")
    if unlike:
        notes.append(f"{', '.join(unlike)} held at different values: that was assumed, not found, and may move others")
    if of_both:
        notes.append(
            f"both were given the same prior of {', '.join(of_both)}, whose error is counted as if it were two: "
            "differences may be surer than stated"
        )
    return tuple(notes)


def welch(v1: FloatArray, v2: FloatArray, dof1: float | FloatArray, dof2: float | FloatArray) -> FloatArray:
    """Degrees of freedom of sums of two variances (Welch and Satterthwaite); 1 where both are zero."""
    known = v1 + v2 == 0.0
    return np.asarray(np.where(known, 1.0, v1 + v2) ** 2 / np.where(known, 1.0, v1**2 / dof1 + v2**2 / dof2))


def hotelling(difference: FloatArray, covariance: FloatArray, dof: float) -> tuple[float, float]:
    """Hotelling's T² as F, with the smaller degrees of freedom of the two."""
    std = np.sqrt(np.diag(covariance))
    std = np.where(std > 0.0, std, 1.0)
    sizes, vectors = np.linalg.eigh(covariance / np.multiply.outer(std, std))
    seen = sizes > RANK_OF_SQUARES * max(sizes.max(initial=0.0), RANK_OF_SQUARES)
    rank = int(seen.sum())
    if rank == 0:
        return 0.0, 1.0
    squared = float(((vectors[:, seen].T @ (difference / std)) ** 2 / sizes[seen]).sum())
    left = max(dof - rank + 1.0, 1.0)
    statistic = squared * left / (rank * max(dof, left))
    return statistic, float(scipy.stats.f.sf(statistic, rank, left))


def holm(p_values: FloatArray) -> FloatArray:
    """Adjust for the number of tests, the smallest first."""
    order = np.argsort(p_values)
    steps = np.arange(len(p_values), 0, -1) * p_values[order]
    adjusted = np.empty_like(p_values)
    adjusted[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return adjusted


class Equality(NamedTuple):
    """Wald test of each parameter: is it the same in all groups?"""

    names: tuple[str, ...]  # the parameters
    p_values: FloatArray  # probability of larger differences if it were, (P,)
    adjusted: FloatArray  # p-values adjusted for the number of tests (Holm), (P,)

    def below(self, level: float) -> tuple[str, ...]:
        """Parameters that differ, if in so many of all comparisons of equal groups any may be said to."""
        return tuple(name for name, p in zip(self.names, self.adjusted, strict=True) if p < level)


def equality_of(
    places: Mapping[str, Sequence[int]], values: FloatArray, covariance: FloatArray, dof: FloatArray
) -> Equality:
    """Compare the values that groups found for each of some parameters."""
    # With d the differences to the first group, and C their covariance, dᵀ C⁻¹ d is Hotelling's T², with the smallest
    # degrees of freedom of the groups.
    p_values = np.ones(len(places))
    for k, several in enumerate(places.values()):
        contrast = np.column_stack([-np.ones(len(several) - 1), np.eye(len(several) - 1)])
        difference = contrast @ values[several]
        spread = contrast @ covariance[np.ix_(several, several)] @ contrast.T
        p_values[k] = hotelling(difference, spread, float(dof[several].min()))[1]
    return Equality(tuple(places), p_values, holm(p_values))
