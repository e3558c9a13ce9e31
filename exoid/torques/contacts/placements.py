"""Placements of links in the base, for links that carry no joint too."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.leg.dynamics import SegmentPlacements
from exoid.leg.leg import Leg
from exoid.leg.link_frames import link_frame


def link_placements(leg: Leg, q: FloatArray, link: str) -> SegmentPlacements:
    """Compute the placement of a link in the axes of the root link."""
    body, placement = link_frame(leg.model, leg.description, link)
    own, place = np.array(placement.rotation), np.array(placement.translation)
    if body < 0:
        return SegmentPlacements(np.repeat(own[np.newaxis], len(q), 0), np.repeat(place[np.newaxis], len(q), 0))
    rotation, translation = leg.forward_kinematics(q)
    return SegmentPlacements(rotation[:, body] @ own, translation[:, body] + rotation[:, body] @ place)


def level_rotation(leg: Leg, link: str) -> FloatArray:
    """Orientation of a link where all joint angles are zero and the base is upright: flat on the ground, (3, 3).

    Args:
        leg: The leg.
        link: Name of the link in the URDF.

    Returns:
        Rotation, level axes from link.
    """
    return np.asarray(link_placements(leg, np.zeros((1, len(leg.joint_names))), link).rotation[0])
