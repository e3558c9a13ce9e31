"""Physical consistency of base parameters: in closed form for planar legs, by the lift for any other robot.

A body of mass m, moments h = mc and inertia j about its joint is consistent in the plane if and only if m j > |h|²: the
inertia about its centre of mass is then positive. A planar segment carries the mass M' of all segments below it at d,
the next joint. Its own parameters are h = (Y, −X) and j, without the J below it. For the mass M of the segment and all
segments below, the condition is

    (M − M')(j − M'|d|²) > |h − M'd|²    ⇔    M'|d|² < j  and  M > (|h|² + M'(j − 2 h·d)) / (j − M'|d|²).

The bound on M grows with M', so the lightest leg follows segment by segment from the foot upwards. The leg is
consistent if and only if at every segment this lightest M' is below j/|d|². With M' = 0 the bound is M ≥ (X² + Y²)/j,
which needs no lengths.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.leg.leg import Leg
from exoid.tools.tables import make_table, to_text

from .lift import fitting, lift


class MassBound(NamedTuple):
    """Bounds of the mass of a segment and all segments below it [kg]."""

    masses: str  # sum of masses that is bounded, such as "m_shank + m_foot"
    formula: str  # lower bound without lengths, such as "(X2² + Y2²)/(J2 − J3)"
    least: float  # value of this bound; infinite if the inertia is not positive
    least_with_lengths: float  # sharp lower bound, from the positions of the joints
    most: float  # sharp upper bound j/|d|², from the inertia of the segment above; infinite for the first segment


@dataclass(frozen=True)
class PhysicalCheck:
    """Physical consistency of parameters; ``print`` shows it.

    Attributes:
        physical: Whether the parameters are physically consistent.
        reasons: Reasons why they are not, one sentence each.
        bounds: Bounds of masses, segment by segment from the torso; empty for a leg that is not a planar chain.
    """

    physical: bool
    reasons: tuple[str, ...]
    bounds: tuple[MassBound, ...]

    def __bool__(self) -> bool:
        """Tell whether the parameters are physically consistent."""
        return self.physical

    def __str__(self) -> str:
        """Print the result, the reasons and the bounds."""
        result = f"the parameters are {'' if self.physical else 'not '}physically consistent"
        if not self.bounds:
            return to_text(result, *self.reasons)
        headers = ("mass [kg]", "≥", "at least", "with these lengths", "below")
        rows = [(b.masses, b.formula, *(f"{x:.2f}" if np.isfinite(x) else "∞" for x in b[2:])) for b in self.bounds]
        return to_text(result, *self.reasons, make_table(headers, rows))


def check_physical(leg: Leg, values: ArrayLike) -> PhysicalCheck:
    """Check whether base parameters are physically consistent.

    For a planar leg, masses, centres of mass and positive inertias must exist that reduce to the values. Each segment,
    with the segments below it, must also have its centre of mass on the same side of its joint as in the URDF: the
    angle between the two is below 90°. For any other robot, :func:`exoid.leg.lift.lift` must reproduce the values.

    Args:
        leg: The leg, with its geometry and the side of each joint on which its segment is.
        values: Base parameters, (p,), in the order of ``leg.parameter_names``.

    Returns:
        The result with its reasons, and for a planar leg bounds of the masses, which motion does not determine.

    Raises:
        ExoidError: The values do not fit the leg or are not finite.

    Example:
        >>> leg = exoid.load_leg("bleex", inertias="cad")
        >>> tuple(round(bound.least, 2) for bound in check_physical(leg, leg.parameters).bounds)
        (8.94, 5.05, 1.81)
    """
    array = fitting(leg, values)
    if leg.chain is None:
        lifted = lift(leg, array)
        if lifted.feasible:
            return PhysicalCheck(True, (), ())
        return PhysicalCheck(False, ("no links with positive mass density have these base parameters",), ())
    bounds, reasons = _planar(leg, array.reshape(-1, 3))
    return PhysicalCheck(not reasons, tuple(reasons), tuple(bounds))


def _planar(leg: Leg, segments: FloatArray) -> tuple[list[MassBound], list[str]]:
    assert leg.chain is not None
    links, n = leg.link_labels, len(segments)
    joined = np.append(segments[1:, 2], 0.0) if leg.cumulative else np.zeros(n)
    carriers = [
        _Carrier(np.array([Y, -X]), float(J - below), d)
        for (X, Y, J), below, d in zip(segments, joined, [*leg.chain.offsets, np.zeros(2)], strict=True)
    ]
    names = [f"J{k + 1} − J{k + 2}" if leg.cumulative and k < n - 1 else f"J{k + 1}" for k in range(n)]
    least, reasons = np.zeros(n + 1), []
    for k in range(n - 1, -1, -1):
        carrier, below = carriers[k], least[k + 1] if np.isfinite(least[k + 1]) else 0.0
        least[k] = carrier.least(below)
        if carrier.j <= 0.0:
            reasons.append(f"{links[k]}: {names[k]} = {carrier.j:.3g} kg·m² is not positive")
        elif not np.isfinite(least[k]):
            reasons.append(f"{links[k]}: {below:.3g} kg below it are too much for {names[k]} = {carrier.j:.3g} kg·m²")
        X, Y, _ = leg.parameters.reshape(-1, 3)[k]
        if carrier.h @ np.array([Y, -X]) <= 0.0:
            where = f"X{k + 1} = {segments[k, 0]:.3g}, Y{k + 1} = {segments[k, 1]:.3g} kg·m"
            reasons.append(f"{links[k]}: its centre of mass is on the wrong side of its joint ({where})")
    bounds, most = [], np.inf
    for k, (carrier, name) in enumerate(zip(carriers, names, strict=True)):
        masses = " + ".join(f"m_{link}" for link in links[k:])
        formula = f"(X{k + 1}² + Y{k + 1}²)/" + (f"({name})" if "−" in name else name)
        bounds.append(MassBound(masses, formula, carrier.least(0.0), float(least[k]), most))
        most = carrier.most_below(most)
    return bounds, reasons[::-1]


class _Carrier(NamedTuple):
    """A segment that carries mass M' at d: h, j and d of the module docstring."""

    h: FloatArray
    j: float
    d: FloatArray

    def least(self, below: float) -> float:
        """Smallest mass of the segment and all below it, given the mass below; infinite if there is none."""
        free = self.j - below * float(self.d @ self.d)
        if self.j <= 0.0 or free <= 0.0:
            return np.inf
        return (float(self.h @ self.h) + below * (self.j - 2.0 * float(self.h @ self.d))) / free

    def most_below(self, most: float) -> float:
        """Largest mass below, given that of the segment and all below it: :meth:`least` solved for M'."""
        squared = float(self.d @ self.d)
        if self.j <= 0.0:
            return 0.0
        if not np.isfinite(most):
            return self.j / squared if squared > 0.0 else np.inf
        room = most * self.j - float(self.h @ self.h)
        slope = self.j - 2.0 * float(self.h @ self.d) + most * squared
        return room / slope if room > 0.0 < slope else 0.0
