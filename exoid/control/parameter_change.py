"""Covariance of the changes that an adaptive controller expects: payloads on the links, and other friction."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.leg.lift.pseudo_inertia import make_consistent, pseudo_inertias
from exoid.tools.numbers import checked

DIRECTIONS = np.array([d for d in product((-1.0, 0.0, 1.0), repeat=3) if 0 < np.count_nonzero(d) < 3])
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)
"""Directions of the places of a payload: unit vectors, (18, 3)."""

LEAST_STD = 1e-6
"""Smallest standard deviation of a combination of parameters, over the largest, each in its own."""

SPREAD = np.sqrt(3.0)
"""Distance of these places from the centre of mass, in standard deviations of the link's own mass distribution."""


@dataclass(frozen=True)
class ExpectedChange:
    """Standard deviations of what may change on a leg after its identification.

    Attributes:
        payload: Mass strapped to each link [kg]; its place is distributed like the link's own mass.
        friction: Change of each friction coefficient, relative to the coefficient.

    Raises:
        ExoidError: A number is negative or not finite.
    """

    payload: float = 1.0
    friction: float = 0.3

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("payload", "friction"):
            checked(getattr(self, name), name, least=0.0)


def payload_covariance(payload: float, leg: Leg) -> FloatArray:
    """Covariance E[δ δᵀ] of changes δ of the leg's parameters by a payload [kg] at a point of each link, (p, p)."""
    changes = []
    for link, P in enumerate(pseudo_inertias(make_consistent(leg.link_parameters))):
        centre = P[:3, 3] / P[3, 3]
        squares, axes = np.linalg.eigh(P[:3, :3] / P[3, 3] - np.outer(centre, centre))
        reach = axes * np.sqrt(squares)
        places = centre + SPREAD * np.vstack([np.zeros(3), DIRECTIONS]) @ reach.T
        changes.append(point_masses(leg, link, places) / np.sqrt(len(places)))
    change = payload * np.hstack(changes)
    return np.asarray(change @ change.T)


def point_masses(leg: Leg, link: int, places: FloatArray) -> FloatArray:
    """Parameters of unit masses at some places of a link, (p, k)."""
    own = leg.reduction.collect[:, 10 * link : 10 * link + 10]
    bodies = [pin.Inertia(1.0, place, np.zeros((3, 3))).toDynamicParameters() for place in places]
    return np.asarray(own @ np.transpose(bodies))


def regular(covariance: FloatArray, values: FloatArray) -> FloatArray:
    """Make a covariance positive definite: combinations that are known exactly get a very small variance."""
    std = np.sqrt(np.diagonal(covariance))
    scale = np.where(std > 0.0, std, LEAST_STD * np.maximum(np.abs(values), LEAST_STD))
    correlation = covariance / np.outer(scale, scale)
    np.fill_diagonal(correlation, 1.0)  # also of parameters that are known exactly: their scale is their deviation
    eigenvalues, axes = np.linalg.eigh(correlation)
    clipped = np.maximum(eigenvalues, LEAST_STD**2 * max(float(eigenvalues[-1]), 1.0))
    return np.asarray((axes * clipped) @ axes.T * np.outer(scale, scale))
