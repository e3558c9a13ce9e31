"""Placements of links in the base, for links that carry no joint too."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.leg.leg import Leg
from exoid.signals.link_wrenches import link_placements


def level_rotation(leg: Leg, link: str) -> FloatArray:
    """Orientation of a link where all joint angles are zero and the base is upright: flat on the ground, (3, 3).

    Args:
        leg: The leg.
        link: Name of the link in the URDF.

    Returns:
        Rotation, level axes from link.
    """
    return np.asarray(link_placements(leg, np.zeros((1, len(leg.joint_names))), link).rotation[0])
