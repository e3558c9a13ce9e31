"""Wrenches in the axes of their links, also those measured in the laboratory."""

from __future__ import annotations

from difflib import get_close_matches

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.dynamics import SegmentPlacements
from exoid.leg.leg import Leg
from exoid.leg.link_frames import link_frame

from .recording import Recording
from .wrench import Wrench


def refuse_unknown_links(leg: Leg, recording: Recording) -> None:
    """Refuse wrenches and contacts of links that are not in the URDF, and name the closest ones."""
    links = tuple(link.get("name", "") for link in leg.description.parse().findall("link"))
    for kind, named in (("wrench", recording.wrenches), ("contact", recording.contacts)):
        for link in named:
            if link not in links:
                close = get_close_matches(link, links, n=3, cutoff=0.5)
                raise BadArgumentError(
                    f"a {kind} of {link!r}, which is no link of the leg"
                    + (f"; closest: {', '.join(close)}" if close else ""),
                    where=recording.file_name,
                    remedy=f"name a link of the URDF: {', '.join(links)}; or say where a heel or toe is, "
                    'contacts={"<foot>_heel": (x, y, z)} of the leg',
                    command=f"name a link of the URDF in the header ({kind}_<link>…), or map its columns: "
                    f"--column {kind}_{close[0] if close else links[-1]}{'_fx' if kind == 'wrench' else ''}=HEADER",
                )


def link_placements(leg: Leg, q: FloatArray, link: str) -> SegmentPlacements:
    """Compute the placement of a link in the axes of the root link, (N, 3, 3) and (N, 3)."""
    body, placement = link_frame(leg.model, leg.description, link)
    own, place = np.array(placement.rotation), np.array(placement.translation)
    if body < 0:
        return SegmentPlacements(np.repeat(own[np.newaxis], len(q), 0), np.repeat(place[np.newaxis], len(q), 0))
    rotation, translation = leg.forward_kinematics(q)
    return SegmentPlacements(rotation[:, body] @ own, translation[:, body] + rotation[:, body] @ place)


def link_placement(leg: Leg, recording: Recording, link: str) -> SegmentPlacements:
    """Compute where a link is in the laboratory at each sample of a recording.

    The laboratory is that of the base's pose. For a base that stands still it is the root link, as it stands when the
    torso is upright.

    Args:
        leg: The leg.
        recording: Recording of its joints.
        link: Name of the link in the URDF.

    Returns:
        Rotation matrices, laboratory from link, (N, 3, 3), and positions of the link's origin [m], (N, 3).

    Raises:
        ExoidError: The leg has no such link, a joint is missing, or the pose of the base is not known.
    """
    names = leg.joint_names if set(leg.joint_names) <= set(recording.joint_names) else leg.joint_labels
    inside = link_placements(leg, recording.select(names).q, link)
    rotation, translation = np.eye(3), np.zeros(3)  # of the root link
    if recording.base is not None:
        if recording.base.pose is None:
            raise NotSupportedError(
                "the pose of the base is not known: an IMU does not measure it",
                where=recording.file_name,
                remedy="record it, exoid.BaseMotion.from_pose(...) or from_imu(..., pose=exoid.BasePose(...))",
                command="add the columns base_x…z, base_qx…w of a pose",
            )
        rotation, translation = recording.base.pose.rotation, recording.base.pose.position
    elif recording.torso is not None:  # the tilted torso is where it puts the first joint
        zero = np.zeros((1, len(leg.joint_names)))
        tilted, upright = (leg.forward_kinematics(zero, torso) for torso in (recording.torso, None))
        rotation = tilted.rotation[0, 0] @ upright.rotation[0, 0].T
        translation = tilted.translation[0, 0] - rotation @ upright.translation[0, 0]
    place = translation + (rotation @ inside.translation[..., np.newaxis])[..., 0]
    return SegmentPlacements(rotation @ inside.rotation, place)


def wrenches_on_links(leg: Leg, recording: Recording) -> dict[str, Wrench]:
    """Give all wrenches of a recording in the axes of their links.

    Args:
        leg: The leg.
        recording: Recording of its joints.

    Returns:
        Wrenches by link, each with ``axes="link"``.

    Raises:
        ExoidError: A link is not in the URDF, or a joint is missing.
    """
    refuse_unknown_links(leg, recording)
    found = dict(recording.wrenches)
    for link, wrench in found.items():
        if wrench.axes == "world":
            rotation, translation = link_placement(leg, recording, link)
            moved = wrench.about(translation)
            force, moment = (np.einsum("nji,nj->ni", rotation, x) for x in (moved.force, moved.moment))
            found[link] = Wrench(force, moment)
    return found
