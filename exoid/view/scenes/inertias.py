"""Inertias as visuals: a steel ball of the mass, and the ellipsoid of uniform density with the same inertia."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray

from .transforms import homogeneous
from .visual import Material, Visual, ellipsoid

STEEL = 7850.0
"""Density of the balls that represent masses [kg/m³]."""

OPACITY = 0.2
"""Opacity of ellipsoids."""

THINNEST = 0.03
"""Smallest semi-axis that is drawn, as a share of the longest: bodies that cannot exist have semi-axes of zero."""


def mass_ball(inertia: pin.Inertia, colour: str) -> Visual:
    """Make a steel ball of the body's mass at its centre of mass."""
    radius = (3.0 * inertia.mass / (4.0 * np.pi * STEEL)) ** (1.0 / 3.0)
    return ellipsoid(radius, Material(colour)).placed(homogeneous(inertia.lever))


def surface_points(ellipsoid: Visual) -> FloatArray:
    """Points on an ellipsoid, in the frame in which it is drawn [m], (26, 3): along its axes and between them."""
    steps = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if i or j or k], float)
    directions = steps / np.linalg.norm(steps, axis=1, keepdims=True)
    return np.asarray(directions @ ellipsoid.transform[:3, :3].T + ellipsoid.transform[:3, 3])


def inertia_ellipsoid(inertia: pin.Inertia, colour: str) -> Visual:
    """Make the ellipsoid of uniform density that has the body's mass and inertia."""
    # About its principal axes I_x = m (b² + c²)/5, and likewise for y and z. Hence a² = 5 (I_y + I_z − I_x)/2m.
    moments, axes = np.linalg.eigh(inertia.inertia)
    squares = 2.5 * (moments.sum() - 2.0 * moments) / inertia.mass
    semi_axes = np.sqrt(np.maximum(squares, 0.0))
    axes[:, 2] *= np.sign(np.linalg.det(axes))  # right-handed
    drawn = np.maximum(semi_axes, THINNEST * max(float(semi_axes.max()), 1e-3))
    return ellipsoid(drawn, Material(colour, OPACITY)).placed(homogeneous(inertia.lever, axes))
