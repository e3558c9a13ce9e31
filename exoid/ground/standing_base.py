"""Motion of a base that a foot on level ground carries."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are first used

from exoid.leg import Leg
from exoid.signals import BaseMotion, Recording

from .placements import level_rotation, link_placements

CUTOFF = 15.0
"""Cut-off frequency of the motion [Hz], above that of the filter that follows."""


def standing_base(leg: Leg, recording: Recording, link: str) -> BaseMotion:
    """Derive the motion of the base from the joint angles while a link rests flat on level ground.

    The link stands as it does where all joints of the URDF are at zero and the base is upright. Elsewhere the result
    has no meaning.

    Args:
        leg: The leg.
        recording: The recording, with even time stamps.
        link: Link that rests.

    Returns:
        Motion of the base at all samples.
    """
    rotation, position = link_placements(leg, recording.q, link)
    turn = level_rotation(leg, link) @ np.swapaxes(rotation, 1, 2)  # laboratory from base
    place = -np.einsum("nij,nj->ni", turn, position)
    quaternion = scipy.spatial.transform.Rotation.from_matrix(turn).as_quat()
    cutoff = min(0.2 * recording.sample_rate, CUTOFF)
    return BaseMotion.from_pose(place, quaternion, recording.time, cutoff=cutoff)
