"""Motion of a floating base in a replay: from its recorded pose, or from the feet that rest on the ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.leg.link_frames import link_frame
from exoid.signals import BaseMotion
from exoid.signals.link_wrenches import link_placements, refuse_unknown_links, wrenches_on_links
from exoid.torques.contacts import level_rotation
from exoid.torques.contacts.stretches import contact_of

from .leg_geometry import LegGeometry
from .replay import Replay
from .transforms import align_z


@dataclass(frozen=True, eq=False)
class Standing:
    """Pose of the base in the laboratory, z up, and the feet on the ground, frame by frame."""

    position: FloatArray  # position of the root link's origin [m], (F, 3)
    rotation: FloatArray  # rotation matrices, laboratory from root link, (F, 3, 3)
    floor: float  # height of the ground [m]
    # height of each foot's sole above the origin of its link [m], below zero for a sole beneath it
    soles: Mapping[str, float]
    sides: Mapping[str, float]  # sideward centre of each sole, from the origin of its link [m]
    contacts: Mapping[str, BoolArray]  # frames in which each foot rests, (F,) each

    @classmethod
    def of(cls, geometry: LegGeometry, replay: Replay) -> Standing | None:
        """Find the motion of the base in a replay."""
        leg, recording = geometry.leg, replay.recording
        q = replay.angles(leg)
        if not leg.base_rows or q is None:
            return None
        pose = None if recording.base is None else recording.base.pose
        if pose is None and any(wrench.axes == "world" for wrench in recording.wrenches.values()):
            raise BadArgumentError(
                "a wrench in the laboratory cannot be drawn where the pose of the base is not known",
                where=recording.file_name,
                remedy='record the pose, exoid.BaseMotion.from_pose(...), or give wrenches with axes="link"',
            )
        contacts = _contacts(leg, replay)
        drawn = {link: level_points(geometry, link) for link in contacts}
        soles = {link: float(points[:, 2].min()) for link, points in drawn.items()}
        sides = {link: float(points[:, 1].min() + points[:, 1].max()) / 2.0 for link, points in drawn.items()}
        if pose is not None:
            turns = scipy.spatial.transform.Rotation.from_quat(pose.quaternion)
            rotation = scipy.spatial.transform.Slerp(recording.time, turns)(replay.time).as_matrix()
            position = np.column_stack([np.interp(replay.time, recording.time, x) for x in pose.position.T])
        elif any(rests.any() for rests in contacts.values()):
            rotation, position = _carried(leg, q, contacts, soles, recording.base)
        else:
            return None
        standing = cls(position, rotation, 0.0, soles, sides, contacts)
        return standing if pose is None else replace(standing, floor=_floor(geometry, q, standing))

    def place(self, leg: Leg, q: FloatArray, link: str) -> tuple[FloatArray, FloatArray]:
        """Compute where a link is in the laboratory."""
        rotation, position = link_placements(leg, q, link)
        return self.rotation @ rotation, self.position + np.einsum("fij,fj->fi", self.rotation, position)


def _contacts(leg: Leg, replay: Replay) -> dict[str, BoolArray]:
    """Frames in which each foot rests: as recorded, or where its measured wrench says so."""
    recording, root = replay.recording, leg.description.root_link
    refuse_unknown_links(leg, recording)
    flags = dict(recording.contacts)
    for link, wrench in wrenches_on_links(leg, recording).items():
        found = None if link in flags or link == root else contact_of(leg, link, wrench)
        if found is not None:
            flags[link] = found
    nearest = np.rint(np.interp(replay.time, recording.time, np.arange(len(recording)))).astype(np.intp)
    return {link: np.asarray(rests)[nearest] for link, rests in flags.items() if link != root}


def level_points(geometry: LegGeometry, link: str) -> FloatArray:
    """Find the drawn points of a link that rests flat."""
    leg = geometry.leg
    body, placement = link_frame(leg.model, leg.description, link)
    corners = [visual.bounding_points for visual in geometry.visuals[body + 1]]
    if not corners:
        return np.zeros((1, 3))
    own = (np.vstack(corners) - placement.translation) @ placement.rotation
    return np.asarray(own @ level_rotation(leg, link).T)


def _carried(
    leg: Leg, q: FloatArray, contacts: Mapping[str, BoolArray], soles: Mapping[str, float], imu: BaseMotion | None
) -> tuple[FloatArray, FloatArray]:
    """Rotation and position of a base whose resting feet keep their points, on ground at z = 0."""
    # Each point stays where it was put down. A flat foot has three, which turn the base; so do three point feet, and
    # fewer move it only. In the air, and before the first contact, the base stands still.
    upright = np.eye(3) if imu is None else align_z(imu.specific_force[0]).T
    rotation, position = np.tile(upright, (len(q), 1, 1)), np.zeros((len(q), 3))
    points, level = {}, np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]])
    for link in contacts:  # in the frame of the base, (F, k, 3)
        own = level[: 3 if leg.contact_kind(link) == "flat" else 1] @ level_rotation(leg, link)
        turns, places = link_placements(leg, q, link)
        points[link] = np.einsum("fij,kj->fki", turns, own) + places[:, np.newaxis]
    anchors: dict[str, FloatArray] = {}
    first = next(f for f in range(len(q)) if any(rests[f] for rests in contacts.values()))
    for f in range(first, len(q)):
        before = max(f - 1, first)
        turn, place = rotation[before], position[before]
        resting = [link for link, rests in contacts.items() if rests[f]]
        put_down = {link: place + points[link][before] @ turn.T for link in resting}
        on_ground = {link: at * [1.0, 1.0, 0.0] - [0.0, 0.0, soles[link]] for link, at in put_down.items()}
        anchors = {link: anchors.get(link, at) for link, at in on_ground.items()}
        if resting:
            at, to = np.vstack([points[link][f] for link in resting]), np.vstack([anchors[link] for link in resting])
            if len(at) >= 3:
                found, _ = scipy.spatial.transform.Rotation.align_vectors(to - to.mean(axis=0), at - at.mean(axis=0))
                turn = found.as_matrix()
            place = to.mean(axis=0) - turn @ at.mean(axis=0)
        rotation[f], position[f] = turn, place
    rotation[:first], position[:first] = rotation[first], position[first]
    return rotation, position


def _floor(geometry: LegGeometry, q: FloatArray, standing: Standing) -> float:
    """Height of the soles of resting feet, else of the lowest drawn point [m]."""
    heights = [
        standing.place(geometry.leg, q, link)[1][rests, 2] + standing.soles[link]
        for link, rests in standing.contacts.items()
        if rests.any()
    ]
    if heights:
        return float(np.median(np.concatenate(heights)))
    points = [
        (geometry.bounding_points(each[np.newaxis]) @ turn.T + place)[:, 2].min()
        for each, turn, place in zip(q, standing.rotation, standing.position, strict=True)
    ]
    return float(min(points))
