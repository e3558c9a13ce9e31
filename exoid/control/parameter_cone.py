"""Convex set of parameters that an adaptive controller stays in: M(q) positive definite, friction not negative.

Point masses w ≥ 0 at fixed places on the links reproduce the rigid-body parameters A w, where column k of A is the
contribution of a unit mass at place k. Bodies of positive mass are physically consistent, so the kinetic energy is not
negative and M(q; A w) ⪰ 0 at every q. The set β = ε β₀ + A w, w ≥ 0, with a consistent β₀ is convex and has
M(q; β) ⪰ ε M(q; β₀) ≻ 0. Friction coefficients have unit columns, so they are ≥ 0; parameters without bounds have one
of each sign. The point nearest to β in the metric of a covariance C,

    min (β − ε β₀ − A w)ᵀ C⁻¹ (β − ε β₀ − A w)    over    w ≥ 0,

is a problem of non-negative least squares (C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974, ch. 23).
Projection on a convex set never increases the distance to a point of the set in that metric. So the Lyapunov function
of an adaptive controller decreases further by it (P. A. Ioannou, J. Sun, Robust Adaptive Control, 1996, sec. 4.4).

All consistent bodies are the set of :mod:`exoid.leg.lift`, which is larger and costs milliseconds. This one is an inner
approximation by a few hundred places, which costs some tenths of a millisecond.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.leg.lift.pseudo_inertia import make_consistent, pseudo_inertias

from .parameter_change import DIRECTIONS, point_masses

SHARES = (0.05, 0.2, 0.4, 0.6, 0.8, 1.0, 1.3)
"""Distances of the places from the joint, over the reach of the link."""

FLOOR = 0.1
"""Share ε of the initial mass matrix below which M(q) never falls."""


@dataclass(frozen=True, eq=False)
class ParameterCone:
    """Set β = floor + A w, w ≥ 0, of the parameters of a leg; made by :meth:`of`."""

    generators: FloatArray  # columns of A, (P, k)
    floor: FloatArray  # point ε β₀ from which the set begins, (P,)

    @classmethod
    def of(cls, leg: Leg, positive: NDArray[np.bool_]) -> ParameterCone:
        """Make the set of a leg, its floor at zero, with parameters behind the leg's of which some are positive."""
        bodies = np.hstack([point_masses(leg, link, places) for link, places in enumerate(_places(leg))])
        sizes = np.linalg.norm(bodies, axis=0)
        moving = sizes > 1e-9 * sizes.max()  # a mass on the vertical axis of the first joint moves no parameter
        bodies = bodies[:, moving] / sizes[moving]
        rest = np.eye(len(positive))
        rest = np.hstack([rest, -rest[:, ~positive]])
        return cls(np.asarray(scipy.linalg.block_diag(bodies, rest)), np.zeros(len(bodies) + len(positive)))

    def above(self, floor: FloatArray) -> ParameterCone:
        """Move the set to another floor."""
        return ParameterCone(self.generators, floor)

    def nearest(self, values: FloatArray, whiten: FloatArray) -> FloatArray:
        """Project a point on the set in the metric LᵀL, L = ``whiten``; a point inside stays exactly as it is."""
        columns = whiten @ self.generators
        scale = np.linalg.norm(columns, axis=0)
        masses = _non_negative(columns / scale, whiten @ (values - self.floor)) / scale
        found = self.floor + self.generators @ masses
        inside = np.linalg.norm(whiten @ (values - found)) <= 1e-7  # standard deviations
        return values if inside else np.asarray(found)


def _non_negative(columns: FloatArray, target: FloatArray) -> FloatArray:
    """Minimise |A w − b| over w ≥ 0, for columns of length 1."""
    # SciPy's `nnls` of version 1.15 and later sometimes stops elsewhere, with a false distance of zero
    # (github.com/scipy/scipy/issues/25389). So the conditions of Kuhn and Tucker are checked, Aᵀ(b − A w) ≤ 0, and = 0
    # where w > 0; where they fail, bounded least squares by another method take its place.
    masses, _ = scipy.optimize.nnls(columns, target)
    slope, least = columns.T @ (target - columns @ masses), 1e-10 * np.linalg.norm(target)
    if slope.max() > least or np.abs(slope[masses > 0.0]).max(initial=0.0) > least:
        masses = scipy.optimize.lsq_linear(columns, target, (0.0, np.inf), method="bvls", tol=1e-20).x
    return np.asarray(np.maximum(masses, 0.0))


def _places(leg: Leg) -> list[FloatArray]:
    """Places of the point masses of each link [m], (k, 3) each, in the frame of its joint."""
    model, places = leg.model, []
    for link, P in enumerate(pseudo_inertias(make_consistent(leg.link_parameters))):
        below = [model.jointPlacements[j].translation for j, parent in enumerate(model.parents) if parent == link + 1]
        reach = max([2.0 * float(np.sqrt(np.trace(P[:3, :3]) / P[3, 3])), *(float(np.linalg.norm(x)) for x in below)])
        places.append(np.vstack([share * reach * DIRECTIONS for share in SHARES]))
    return places
