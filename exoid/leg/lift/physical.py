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

import numpy as np

from exoid._typing import ArrayLike
from exoid.leg.leg import Leg

from .lift import fitting, lift


@dataclass(frozen=True)
class PhysicalCheck:
    """Physical consistency of parameters: true where they are consistent; ``print`` shows it.

    Attributes:
        reasons: Reasons why they are not, one sentence each; empty if they are.
    """

    reasons: tuple[str, ...]

    def __bool__(self) -> bool:
        """Tell whether the parameters are physically consistent."""
        return not self.reasons

    def __str__(self) -> str:
        """Print the result and the reasons."""
        return "\n".join([f"the parameters are {'not ' if self.reasons else ''}physically consistent", *self.reasons])


def check_physical(leg: Leg, values: ArrayLike) -> PhysicalCheck:
    """Check whether base parameters are physically consistent.

    For a planar leg, masses, centres of mass and positive inertias must exist that reduce to the values. Each segment,
    with the segments below it, must also have its centre of mass on the same side of its joint as in the URDF: the
    angle between the two is below 90°. For any other robot, :func:`exoid.leg.lift.lift` must reproduce the values.

    Args:
        leg: The leg, with its geometry and the side of each joint on which its segment is.
        values: Base parameters, (p,), in the order of ``leg.parameter_names``.

    Returns:
        The result with its reasons.

    Raises:
        ExoidError: The values do not fit the leg or are not finite.

    Example:
        >>> leg = exoid.load_leg("bleex", inertias="cad")
        >>> bool(check_physical(leg, leg.parameters)), bool(check_physical(leg, -leg.parameters))
        (True, False)
    """
    array = fitting(leg, values)
    if leg.chain is None:
        feasible = lift(leg, array).feasible
        return PhysicalCheck(() if feasible else ("no links with positive mass density have these base parameters",))
    segments, reasons, least = array.reshape(-1, 3), list[str](), 0.0  # lightest mass of all segments below
    n = len(segments)
    for k in range(n - 1, -1, -1):
        X, Y, J = segments[k].tolist()
        link, cumulative = leg.link_labels[k], leg.cumulative and k < n - 1
        j, name = (J - float(segments[k + 1, 2]), f"J{k + 1} − J{k + 2}") if cumulative else (J, f"J{k + 1}")
        h, d = np.array([Y, -X]), leg.chain.offsets[k] if k < n - 1 else np.zeros(2)
        free = j - least * float(d @ d)
        if j <= 0.0:
            reasons.append(f"{link}: {name} = {j:.3g} kg·m² is not positive")
        elif free <= 0.0:
            reasons.append(f"{link}: {least:.3g} kg below it are too much for {name} = {j:.3g} kg·m²")
        least = (float(h @ h) + least * (j - 2.0 * float(h @ d))) / free if min(j, free) > 0.0 else 0.0
        own_X, own_Y, _ = leg.parameters.reshape(-1, 3)[k]
        if h @ np.array([own_Y, -own_X]) <= 0.0:
            where = f"X{k + 1} = {X:.3g}, Y{k + 1} = {Y:.3g} kg·m"
            reasons.append(f"{link}: its centre of mass is on the wrong side of its joint ({where})")
    return PhysicalCheck(tuple(reversed(reasons)))
