"""Wrenches in the axes of their links, also those measured in the laboratory."""

from __future__ import annotations

import re
from difflib import get_close_matches
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.leg import Leg

from .recording import Recording
from .wrench import Wrench


class LinkPlacement(NamedTuple):
    """Placement of a link in the laboratory.

    Attributes:
        rotation: Rotation matrices, laboratory from link, (N, 3, 3).
        translation: Position of the link's origin [m], (N, 3).
    """

    rotation: FloatArray
    translation: FloatArray

    def behind(self, rotation: FloatArray, translation: FloatArray) -> LinkPlacement:
        """Chain a placement that is given in the axes of this link."""
        place = self.translation + np.einsum(
            "nij,...j->ni" if translation.ndim == 1 else "nij,nj->ni", self.rotation, translation
        )
        return LinkPlacement(self.rotation @ rotation, place)


def links_of(leg: Leg) -> tuple[str, ...]:
    """List the links of a leg's URDF."""
    return tuple(link.get("name", "") for link in leg.description.parse().findall("link"))


def refuse_unknown_links(leg: Leg, recording: Recording) -> None:
    """Refuse wrenches and contacts of links that the leg does not have.

    Args:
        leg: The leg.
        recording: The recording.

    Raises:
        ExoidError: A link is not in the URDF; names the closest ones.
    """
    links = links_of(leg)
    for kind, named in (("wrench", recording.wrenches), ("contact", recording.contacts)):
        for link in named:
            if link not in links:
                close = get_close_matches(link, links, n=3, cutoff=0.5)
                raise ExoidError(
                    f"a {kind} of {link!r}, which is no link of the leg"
                    + (f"; closest: {', '.join(close)}" if close else ""),
                    where=recording.source.name if recording.source else "",
                    remedy=f"name a link of the URDF: {', '.join(links)}",
                    command=f"name a link of the URDF in the header ({kind}_<link>…), or map its columns: "
                    f"--column {kind}_{close[0] if close else links[-1]}{'_fx' if kind == 'wrench' else ''}=HEADER",
                )


def link_placement(leg: Leg, recording: Recording, link: str) -> LinkPlacement:
    """Compute where a link is in the laboratory at each sample of a recording.

    The laboratory is that of the base's pose. For a base that stands still it is the root link, as it stands when the
    torso is upright.

    Args:
        leg: The leg.
        recording: Recording of its joints.
        link: Name of the link in the URDF.

    Returns:
        The placement.

    Raises:
        ExoidError: The leg has no such link, a joint is missing, or the pose of the base is not known.
    """
    if link not in links_of(leg):
        raise ExoidError(f"no link {link!r}", remedy=f"links of the leg are {', '.join(links_of(leg))}")
    q = recording.select(leg.joint_names).q
    frame, root = _frame(leg, link), _root_placement(leg, recording)
    inside = frame.placement.rotation, frame.placement.translation
    carrier = leg.model.names[frame.parentJoint]
    if carrier not in leg.joint_names:
        return root.behind(*inside)
    joint = leg.joint_names.index(carrier)
    rotation, translation = leg.forward_kinematics(q)
    return root.behind(rotation[:, joint], translation[:, joint]).behind(*inside)


def wrench_on_link(wrench: Wrench, placement: LinkPlacement) -> Wrench:
    """Turn a wrench into the axes of its link."""
    if wrench.axes == "link":
        return wrench
    if len(placement.translation) != len(wrench):
        raise ExoidError(
            f"a wrench of {len(wrench)} samples on a link with {len(placement.translation)}",
            remedy="give both at the same time stamps",
        )
    at_origin = wrench.about(placement.translation)
    force, moment = (np.einsum("nji,nj->ni", placement.rotation, x) for x in (at_origin.force, at_origin.moment))
    return Wrench(force, moment)


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
    return {
        link: one if one.axes == "link" else wrench_on_link(one, link_placement(leg, recording, link))
        for link, one in recording.wrenches.items()
    }


def _frame(leg: Leg, link: str) -> pin.Frame:
    """Frame of a link; the model numbers those of links that are named like a joint."""
    bodies = [frame for frame in leg.model.frames if frame.type == pin.FrameType.BODY]
    numbered = re.compile(rf"{re.escape(link)} \d+")
    same = [frame for frame in bodies if frame.name == link]
    return (same or [frame for frame in bodies if numbered.fullmatch(frame.name)])[0]


def _root_placement(leg: Leg, recording: Recording) -> LinkPlacement:
    """Placement of the root link in the laboratory."""
    samples = len(recording)
    if recording.base is not None:
        if recording.base.pose is None:
            raise ExoidError(
                "the pose of the base is not known: an IMU does not measure it",
                where=recording.source.name if recording.source else "",
                remedy="record it, exoid.BaseMotion.from_pose(...) or from_imu(..., pose=exoid.BasePose(...))",
                command="add the columns base_x…z, base_qx…w of a pose",
            )
        return LinkPlacement(recording.base.pose.rotation, recording.base.pose.position)
    still = LinkPlacement(np.broadcast_to(np.eye(3), (samples, 3, 3)), np.zeros((samples, 3)))
    if recording.torso is None:
        return still
    zero = np.zeros((1, len(leg.joint_names)))  # the tilted torso is where it puts the first joint
    (tilted, upright) = (leg.forward_kinematics(zero, torso) for torso in (recording.torso, None))
    rotation = tilted.rotation[0, 0] @ upright.rotation[0, 0].T
    return still.behind(rotation, tilted.translation[0, 0] - rotation @ upright.translation[0, 0])
