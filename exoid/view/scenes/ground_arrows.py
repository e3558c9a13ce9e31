"""Arrows of the forces of the ground on resting feet, from the centre of pressure."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.ground_prediction import ground_forces, level_wrench
from exoid.leg.leg import Leg
from exoid.leg.link_frames import link_frame
from exoid.signals.link_wrenches import wrenches_on_links
from exoid.torques.contacts import level_rotation
from exoid.view.colours import MEASURED, PREDICTED

from .arrows import SMALLEST_SCALE, THICKNESS, straight_arrow
from .commands import ROOT, Drawing, Layer, child_path, moving, set_object
from .leg_geometry import LegGeometry
from .readings import Readings
from .replay import Replay, at_frames
from .standing import Standing
from .transforms import align_z

SHOWN = {"measured ground force": MEASURED, "predicted ground force": PREDICTED}
"""Label and colour of the forces."""


class Load(NamedTuple):
    """Force of the ground on a foot at the frames, in its level axes."""

    force: FloatArray  # force [N], (F, 3), zero where it is not known or the foot hardly rests
    centre: FloatArray  # centre of pressure from the origin of the link [m], (F, 3)


Loads = dict[str, dict[str, Load]]
"""Loads by label and link."""


def ground_loads(source: Leg | Estimate, leg: Leg, replay: Replay, standing: Standing) -> tuple[Loads, tuple[str, ...]]:
    """Find measured and, for an estimate, predicted loads of resting feet; and why they cannot be predicted."""
    recording = replay.recording
    q = np.zeros((len(recording), len(leg.joint_names)))  # the axes of a floating base are those of the laboratory
    found = {link: level_wrench(leg, q, link, each) for link, each in wrenches_on_links(leg, recording).items()}
    measured, predicted = ((link, recording.time, each, np.inf) for link, each in found.items()), []
    notes: tuple[str, ...] = ()
    if isinstance(source, Estimate) and recording.tau is not None:
        try:
            predicted = [(link, each.time, each, 0.03) for link, each in ground_forces(source, recording).items()]
        except ExoidError as error:
            notes = (f"forces of the ground are not predicted: {error.what}",)
    weight = sum(each.mass for each in leg.model.inertias) * float(np.linalg.norm(leg.model.gravity.linear))
    loads: Loads = {label: {} for label in SHOWN}
    for label, several in zip(SHOWN, (measured, predicted), strict=True):
        for link, time, each, gap in several:
            if link in standing.contacts:
                with np.errstate(divide="ignore", invalid="ignore"):  # without a force there is no centre
                    centre = each.center_of_pressure(standing.soles[link])
                # Where torques do not determine the moment about x, the force acts on the middle of the sole.
                centre = np.where(np.isnan(centre), (0.0, standing.sides[link]), centre)
                force, centre = (np.nan_to_num(at_frames(replay.time, time, x, gap)) for x in (each.force, centre))
                # A force that hardly pushes up has no centre of pressure.
                rests = (standing.contacts[link] & (force[:, 2] > 0.02 * weight))[:, np.newaxis]
                centre = np.column_stack([centre, np.full(len(centre), standing.soles[link])])
                loads[label][link] = Load(np.where(rests, force, 0.0), np.where(rests, centre, 0.0))
    return loads, notes


def draw_ground_forces(geometry: LegGeometry, replay: Replay, standing: Standing, loads: Loads) -> Drawing:
    """Draw the forces from the centres of pressure, all on the scale of the largest that is drawn."""
    leg, q, drawing = geometry.leg, replay.angles(geometry.leg), Drawing()
    assert q is not None  # a leg that stands was recorded
    sizes = [float(np.linalg.norm(each.force, axis=1).max()) for by_link in loads.values() for each in by_link.values()]
    # The arrow of the largest force ends below the hip, whatever the force.
    largest, longest = max(sizes, default=0.0) or 1.0, 0.6 * geometry.skeleton.reach
    text = f"arrow of {longest:.2g} m = {largest:.4g} N"
    for label, colour in SHOWN.items():
        paths = []
        for link, load in loads[label].items():
            rotation, origin = standing.place(leg, q, link)
            force, start = (np.einsum("fij,fj->fi", rotation @ level_rotation(leg, link).T, x) for x in load)
            turn = np.array([align_z(each) if each.any() else np.eye(3) for each in force])
            length = longest * np.linalg.norm(force, axis=1) / largest
            scale = np.where(length[:, np.newaxis] > 0.0, np.ones(3), SMALLEST_SCALE)
            scale[:, 2] = np.maximum(length, SMALLEST_SCALE)
            paths.append(child_path(ROOT, f"{label} {link}"))
            arrow = straight_arrow(1.0, THICKNESS * geometry.skeleton.reach, colour)
            drawing += Drawing([set_object(f"{paths[-1]}/arrow", arrow, shadows=False)])
            drawing += moving(paths[-1], origin + start, turn)
            drawing += moving(f"{paths[-1]}/arrow", np.zeros((1, 3)), scale=scale)
        if paths:
            drawing += Drawing(layers=[Layer(label, (colour,), tuple(paths), scale=text)])
    return drawing


def foot_readings(geometry: LegGeometry, loads: Loads) -> Iterator[Readings]:
    """Read vertical force and centre of pressure of each foot."""
    measured, predicted = loads.values()
    for link in dict.fromkeys([*measured, *predicted]):
        body = link_frame(geometry.leg.model, geometry.leg.description, link).body
        known = measured.get(link) or predicted[link]
        yield Readings(
            link,
            geometry.body_paths[body + 1],
            geometry.joint_colours[body],
            1e3 * known.centre[:, 0],
            measured[link].force[:, 2] if link in measured else np.full(len(known.force), np.nan),
            predicted[link].force[:, 2] if link in predicted else None,
            True,
            ("mm CoP", "N"),
            foot=True,
        )
