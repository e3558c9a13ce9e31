"""Arrows of the forces of the ground on resting feet, from the centre of pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.ground_prediction import ground_forces
from exoid.leg.leg import Leg
from exoid.signals.link_wrenches import wrenches_on_links
from exoid.torques.contacts import level_rotation
from exoid.view.colours import MEASURED, PREDICTED

from .arrows import SMALLEST_SCALE, THICKNESS, straight_arrow
from .commands import ROOT, Drawing, Layer, child_path, moving, set_object
from .leg_geometry import LegGeometry
from .replay import Replay, at_frames
from .standing import Standing
from .transforms import align_z

LENGTH = 0.6
"""Length of the largest force's arrow over the reach of the leg: it ends below the hip, whatever the force."""

Loads = dict[str, tuple[FloatArray, FloatArray]]
"""Force [N] and moment about the link's origin [N·m] in its axes, (F, 3) each; zero where none is known."""


class Forces(NamedTuple):
    """Forces on one link in the laboratory."""

    force: FloatArray  # force [N], (F, 3), zero where it is not drawn
    start: FloatArray  # centre of pressure [m], (F, 3)


def draw_ground_forces(source: Leg | Estimate, geometry: LegGeometry, replay: Replay, standing: Standing) -> Drawing:
    """Draw measured forces and, for an estimate, predicted ones; both on the scale of the largest that is drawn."""
    leg, drawing = geometry.leg, Drawing()
    shown = {("measured ground force", MEASURED): _in_laboratory(_measured(leg, replay), leg, replay, standing)}
    if isinstance(source, Estimate) and replay.recording.tau is not None:
        try:
            predicted = _predicted(source, leg, replay, standing)
        except ExoidError as error:
            drawing += Drawing(notes=(f"forces of the ground are not predicted: {error.what}",))
        else:
            shown["predicted ground force", PREDICTED] = _in_laboratory(predicted, leg, replay, standing)
    sizes = [float(np.linalg.norm(each.force, axis=1).max()) for by_link in shown.values() for each in by_link.values()]
    largest, longest = max(sizes, default=0.0) or 1.0, LENGTH * geometry.skeleton.reach
    text = f"arrow of {longest:.2g} m = {largest:.4g} N"
    for (label, colour), by_link in shown.items():
        paths = []
        for link, (force, start) in by_link.items():
            turn = np.array([align_z(each) if each.any() else np.eye(3) for each in force])
            length = longest * np.linalg.norm(force, axis=1) / largest
            scale = np.where(length[:, np.newaxis] > 0.0, np.ones(3), SMALLEST_SCALE)
            scale[:, 2] = np.maximum(length, SMALLEST_SCALE)
            paths.append(child_path(ROOT, f"{label} {link}"))
            arrow = straight_arrow(1.0, THICKNESS * geometry.skeleton.reach, colour)
            drawing += Drawing([set_object(f"{paths[-1]}/arrow", arrow, shadows=False)])
            drawing += moving(paths[-1], start, turn) + moving(f"{paths[-1]}/arrow", np.zeros((1, 3)), scale=scale)
        if paths:
            drawing += Drawing(layers=[Layer(label, (colour,), tuple(paths), scale=text)])
    return drawing


def _in_laboratory(loads: Loads, leg: Leg, replay: Replay, standing: Standing) -> dict[str, Forces]:
    """Forces on the links that rest, from their centres of pressure."""
    q, found = replay.angles(leg), {}
    assert q is not None  # a leg that stands was recorded
    weight = sum(inertia.mass for inertia in leg.model.inertias) * float(np.linalg.norm(leg.model.gravity.linear))
    for link in (each for each in loads if each in standing.contacts):
        rotation, origin = standing.place(leg, q, link)
        force, moment = (np.einsum("fij,fj->fi", rotation, x) for x in loads[link])
        # A force that hardly pushes up has no centre of pressure.
        force[~standing.contacts[link] | (force[:, 2] < 0.02 * weight)] = 0.0
        found[link] = Forces(force, origin + _centre_of_pressure(force, moment, standing.soles[link]))
    return found


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
        force, moment = (at_frames(replay.time, replay.recording.time, x) for x in (own.force, own.moment))
        loads[link] = force, moment
    return loads


def _predicted(estimate: Estimate, leg: Leg, replay: Replay, standing: Standing) -> Loads:
    """Predicted wrenches at the frames, zero where there is no sample."""
    # Where torques do not determine the moment about x, as of a planar leg, the force acts on the middle of the sole.
    found: Loads = {}
    for link, each in ground_forces(estimate, replay.recording).items():
        level = level_rotation(leg, link)  # level axes from link
        turning = each.moment.copy()
        known = np.isfinite(each.moment_half[:, 0])
        turning[:, 0] = np.where(known, turning[:, 0], standing.sides[link] * each.force[:, 2])
        force, moment = (
            np.nan_to_num(at_frames(replay.time, each.time, x @ level, gap=0.03)) for x in (each.force, turning)
        )
        found[link] = force, moment
    return found
