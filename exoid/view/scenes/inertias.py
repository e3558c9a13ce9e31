"""Inertias as things to look at: a steel ball of the mass, and the ellipsoid of even density with the same inertia."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray

from .parts import Look, Part, ellipsoid, moved

STEEL = 7850.0
"""Density of the balls that stand for masses [kg/m³]."""

SHELL = 0.2
"""Opacity of ellipsoids."""

THINNEST = 0.03
"""Semi-axes are drawn no thinner than this share of the longest, as those of bodies that cannot exist have none."""


def ball(inertia: pin.Inertia, colour: str) -> Part:
    """Draw a steel ball of the body's mass at its centre of mass."""
    radius = (3.0 * inertia.mass / (4.0 * np.pi * STEEL)) ** (1.0 / 3.0)
    return ellipsoid(radius, Look(colour)).at(moved(inertia.lever))


def shell(inertia: pin.Inertia, colour: str) -> Part:
    """Draw the ellipsoid of even density that has the body's mass and inertia.

    About the principal axes I_x = m (b² + c²)/5 and so on, so that a² = 5 (I_y + I_z − I_x)/2m.
    """
    semi_axes, axes = equivalent_axes(inertia)
    return ellipsoid(semi_axes, Look(colour, SHELL)).at(moved(inertia.lever, axes))


def equivalent_axes(inertia: pin.Inertia) -> tuple[FloatArray, FloatArray]:
    """Semi-axes of the ellipsoid [m], (3,), and their directions as columns, (3, 3), right-handed."""
    moments, axes = np.linalg.eigh(inertia.inertia)
    squares = 2.5 * (moments.sum() - 2.0 * moments) / inertia.mass
    semi_axes = np.sqrt(np.maximum(squares, 0.0))
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    return np.maximum(semi_axes, THINNEST * max(float(semi_axes.max()), 1e-3)), axes
