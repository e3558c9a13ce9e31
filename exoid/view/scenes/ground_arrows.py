"""Arrows of the forces of the ground on resting feet, from the centre of pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.ground_prediction import ground_forces
from exoid.leg.leg import Leg
from exoid.signals.link_wrenches import wrenches_on_links
from exoid.torques.contacts import level_rotation
from exoid.view.colours import MEASURED, PREDICTED

from .arrows import SMALLEST_SCALE, straight_arrow
from .commands import ROOT, Command, Tracks, child_path, set_object, set_transform
from .replay import Replay
from .scene import Layer
from .standing import Standing
from .transforms import align_z, homogeneous

PER_WEIGHT = 1.0
"""Length of the arrow of a force as large as the weight of the machine [m]."""

THICKNESS = 0.012
"""Thickness of arrows [m]."""

GAP = 0.03
"""Largest time between a frame and a sample whose force is drawn [s]."""

LEAST = 0.02
"""Smallest upward force that has a centre of pressure, over the weight."""

Loads = dict[str, tuple[FloatArray, FloatArray]]
"""Force [N] and moment about the link's origin [N·m] in its axes, (F, 3) each; zero where none is known."""


class GroundArrows(NamedTuple):
    """Drawing of the forces of the ground."""

    commands: list[Command]  # commands that draw them
    layers: list[Layer]  # measured and predicted forces
    tracks: Tracks  # their keyframes
    notes: tuple[str, ...]  # one sentence if forces could not be predicted
    points: FloatArray  # ends of the arrows [m], (k, 3)

    @classmethod
    def of(cls, source: Leg | Estimate, leg: Leg, replay: Replay, standing: Standing) -> GroundArrows:
        """Draw measured forces and, for an estimate, predicted ones."""
        drawn = cls([], [], {}, (), np.empty((0, 3)))
        drawn = drawn._with(_measured(leg, replay), "measured ground force", MEASURED, leg, replay, standing)
        if not isinstance(source, Estimate) or replay.recording.tau is None:
            return drawn
        try:
            predicted = _predicted(source, leg, replay, standing)
        except ExoidError as error:
            return drawn._replace(notes=(f"forces of the ground are not predicted: {error.what}",))
        return drawn._with(predicted, "predicted ground force", PREDICTED, leg, replay, standing)

    def _with(
        self, loads: Loads, label: str, colour: str, leg: Leg, replay: Replay, standing: Standing
    ) -> GroundArrows:
        """Add the arrows of one source."""
        q = replay.angles(leg)
        assert q is not None  # a leg that stands was recorded
        commands, paths, tracks, ends = list(self.commands), [], dict(self.tracks), [self.points]
        weight = sum(inertia.mass for inertia in leg.model.inertias) * float(np.linalg.norm(leg.model.gravity.linear))
        for link in (each for each in loads if each in standing.contacts):
            rotation, origin = standing.place(leg, q, link)
            force, moment = (np.einsum("fij,fj->fi", rotation, x) for x in loads[link])
            force[~standing.contacts[link] | (force[:, 2] < LEAST * weight)] = 0.0
            start = origin + _centre_of_pressure(force, moment, standing.soles[link])
            turn = np.array([align_z(each) if each.any() else np.eye(3) for each in force])
            length = PER_WEIGHT * np.linalg.norm(force, axis=1) / weight
            scale = np.where(length[:, np.newaxis] > 0.0, np.ones(3), SMALLEST_SCALE)
            scale[:, 2] = np.maximum(length, SMALLEST_SCALE)
            path = child_path(ROOT, f"{label} {link}")
            commands += [
                set_object(f"{path}/arrow", straight_arrow(1.0, THICKNESS, colour), shadows=False),
                set_transform(path, homogeneous(start[0], turn[0])),
                set_transform(f"{path}/arrow", np.diag([*scale[0], 1.0])),
            ]
            tracks[path] = {"position": start, "quaternion": quaternions(turn)}
            tracks[f"{path}/arrow"] = {"scale": scale}
            paths.append(path)
            ends.append(start + PER_WEIGHT * force / weight)
        layers = (
            [*self.layers, Layer(label, (colour,), tuple(paths), scale=f"arrow of {PER_WEIGHT:g} m = {weight:.3g} N")]
            if paths
            else self.layers
        )
        return GroundArrows(commands, layers, tracks, self.notes, np.vstack(ends))


def quaternions(rotation: FloatArray) -> FloatArray:
    """Quaternions (x, y, z, w) of rotation matrices (F, 3, 3), without jumps of sign, (F, 4)."""
    found = scipy.spatial.transform.Rotation.from_matrix(rotation).as_quat()
    jumps = np.cumprod(np.where((found[1:] * found[:-1]).sum(axis=1) < 0.0, -1.0, 1.0))
    return np.asarray(found * np.concatenate([[1.0], jumps])[:, np.newaxis])


def _centre_of_pressure(force: FloatArray, moment: FloatArray, height: float) -> FloatArray:
    """Point at the height h of the sole through which the force passes, from the link's origin [m], (F, 3)."""
    safe = np.where(force[:, 2] > 0.0, force[:, 2], 1.0)
    x = np.where(force[:, 2] > 0.0, (height * force[:, 0] - moment[:, 1]) / safe, 0.0)
    y = np.where(force[:, 2] > 0.0, (height * force[:, 1] + moment[:, 0]) / safe, 0.0)
    return np.column_stack([x, y, np.full(len(force), height)])


def _measured(leg: Leg, replay: Replay) -> Loads:
    """Measured wrenches at the frames."""
    loads: Loads = {}
    for link, wrench in wrenches_on_links(leg, replay.recording).items():
        own = wrench.about(np.zeros(3))
        loads[link] = (
            _at(replay.time, replay.recording.time, own.force),
            _at(replay.time, replay.recording.time, own.moment),
        )
    return loads


def _predicted(estimate: Estimate, leg: Leg, replay: Replay, standing: Standing) -> Loads:
    """Predicted wrenches at the frames, zero where there is no sample."""
    # Where torques do not determine the moment about x, as of a planar leg, the force acts on the middle of the sole.
    found: Loads = {}
    for link, each in ground_forces(estimate, replay.recording).items():
        near = np.abs(each.time[:, np.newaxis] - replay.time).min(axis=0) < GAP
        level = level_rotation(leg, link)  # level axes from link
        turning = each.moment.copy()
        known = np.isfinite(each.moment_half[:, 0])
        turning[:, 0] = np.where(known, turning[:, 0], standing.sides[link] * each.force[:, 2])
        force, moment = (_at(replay.time, each.time, x @ level) * near[:, np.newaxis] for x in (each.force, turning))
        found[link] = force, moment
    return found


def _at(frames: FloatArray, time: FloatArray, values: FloatArray) -> FloatArray:
    """Interpolate at the frames, (F, 3)."""
    return np.column_stack([np.interp(frames, time, column) for column in values.T])
