"""Effect of the rounding of a URDF's numbers on the regressor.

A URDF of four or five digits places parallel joint axes nearly parallel, and coaxial ones a little apart. Its regressor
then has directions that the robot's own does not have, with effects on the torques of the size of the rounding error.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray

ROUNDING = 5e-5
"""Largest error of a number with four decimals: rotations [rad] and positions [m] of joints."""

DRAWS = 4
"""Random roundings; each has as many rows as the regressor."""


def rounding_changes(
    model: pin.Model, regressor: Callable[[pin.Model], FloatArray], *, seed: int = 0
) -> list[FloatArray]:
    """Change the placement of every joint by random rounding errors, and compare the regressors."""
    rng = np.random.default_rng(seed)
    exact = regressor(model)
    return [regressor(_rounded(model, rng)) - exact for _ in range(DRAWS)]


def _rounded(model: pin.Model, rng: np.random.Generator) -> pin.Model:
    """Copy a model with random rounding errors of its joint placements."""
    copy = pin.Model(model)
    for j in range(1, copy.njoints):
        rotation, translation = rng.uniform(-ROUNDING, ROUNDING, (2, 3))
        copy.jointPlacements[j] = copy.jointPlacements[j] * pin.SE3(pin.exp3(rotation), translation)
    return copy
