"""Ground forces in the report of a leg that stands."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.estimate import Estimate, ground_forces
from exoid.estimate.ground_prediction import GroundForce, level_wrench
from exoid.signals import Recording
from exoid.signals.link_wrenches import wrenches_on_links
from exoid.tools.tables import DataTable
from exoid.view.forces import plot_ground_force
from exoid.view.scenes.leg_geometry import LegGeometry
from exoid.view.scenes.standing import level_points
from exoid.view.style import decimation

from .blocks import MAX_LINE_POINTS, SHOWN_SECONDS
from .page import PAGE_COLUMN, Block, Picture, Text

NOTE = (
    "Forces of the ground follow from joint torques and motion alone; force plates are drawn, but not used. The 95 % "
    "band holds errors of the parameters and noise of torques, angles and IMU, not that of the plates. The centre of "
    "pressure is at the height of the sole, from the origin of the link."
)


class FootForce(NamedTuple):
    """Force of the ground on one foot in one recording."""

    link: str  # the foot
    predicted: GroundForce  # force from joint torques
    measured: GroundForce | None  # that of a force plate at the same samples; None for none
    height: float  # height of the sole above the origin of the link [m]


def ground_blocks(estimate: Estimate, recordings: Sequence[Recording]) -> Iterator[Block]:
    """Show the forces of the ground on resting feet: a table of all recordings, and pictures over time."""
    if not estimate.supports or not estimate.model.leg.base_rows:
        return
    each = [(recording.file_name or "array", list(_feet(estimate, recording))) for recording in recordings]
    rows = [_row(name, foot) for name, feet in each for foot in feet]
    if not rows:
        return
    yield Text([NOTE])
    headers = ("recording", "foot", "time [s]", "vertical, mean [N]", "± 95 % [N]", "rms to plate [N]")
    caption = "Vertical force of the ground on resting feet, from joint torques"
    yield DataTable(caption, headers, rows)
    shown: set[frozenset[str]] = set()
    for name, feet in each:
        links = frozenset(foot.link for foot in feet)
        if links in shown:
            continue
        shown.add(links)
        for foot in feet:
            seconds = min(foot.predicted.time[-1] - foot.predicted.time[0], SHOWN_SECONDS)
            yield Picture(
                partial(_draw, foot=foot),
                f"Vertical force of the ground on {foot.link} and its centre of pressure over time, with 95 % bands",
                f"{foot.link} in {name}, {seconds:.0f} s from its first rest",
                "ground_force",
                height=0.9 * PAGE_COLUMN,
            )


def _feet(estimate: Estimate, recording: Recording) -> Iterator[FootForce]:
    """Predict the force on each foot that rests in a recording; none where no foot carries the leg alone."""
    leg = estimate.model.leg
    try:
        found = ground_forces(estimate, recording)
    except ExoidError:
        return
    geometry = LegGeometry.of(leg, (), None)
    plates, q = wrenches_on_links(leg, recording), estimate.model.select(recording).q
    for link, force in found.items():
        rows = np.searchsorted(recording.time, force.time - 0.5 / recording.sample_rate)
        measured = level_wrench(leg, q, link, plates[link], rows) if link in plates else None
        yield FootForce(link, force, measured, float(level_points(geometry, link)[:, 2].min()))


def _row(name: str, foot: FootForce) -> tuple[str, ...]:
    """Summarize the vertical force."""
    force, half = foot.predicted.force[:, 2], foot.predicted.force_half[:, 2]
    seconds = len(force) * float(np.median(np.diff(foot.predicted.time))) if len(force) > 1 else 0.0
    cells = (name, foot.link, f"{seconds:.1f}", f"{force.mean():.1f}", f"{half.mean():.2g}")
    if foot.measured is None:
        return (*cells, "–")
    aside = foot.measured.force[:, 2] - force
    return (*cells, f"{np.sqrt(np.mean(aside**2)):.2g}")


def _draw(figure: Figure, foot: FootForce) -> None:
    """Draw the vertical force above, and the centre of pressure forward below."""
    force = foot.predicted
    end = int(np.searchsorted(force.time, force.time[0] + SHOWN_SECONDS))
    shown: slice | NDArray[np.intp] = decimation(end, MAX_LINE_POINTS)
    above, below = figure.subplots(2, 1, sharex=True)
    plate = None if foot.measured is None else foot.measured.force[shown, 2]
    time = force.time[shown]
    label = f"{foot.link}\nforce [N]"
    plot_ground_force(above, time, force.force[shown, 2], force.force_half[shown, 2], plate, label).set_xlabel("")
    centre, half = 1e3 * force.center_of_pressure(foot.height)[shown, 0], 1e3 * _centre_half(force, foot.height)[shown]
    plate = None if foot.measured is None else 1e3 * foot.measured.center_of_pressure(foot.height)[shown, 0]
    plot_ground_force(below, time, centre, half, plate, "centre of\npressure [mm]")
    below.get_legend().remove()


def _centre_half(force: GroundForce, height: float) -> FloatArray:
    """Half the width of the 95 % band of the centre of pressure forward, (N,): x = (h f_x − m_y) / f_z."""
    (fx, _, fz), (_, my, _) = force.force_half.T, force.moment_half.T
    x = force.center_of_pressure(height)[:, 0]
    return np.asarray(np.sqrt((height * fx) ** 2 + my**2 + (x * fz) ** 2) / np.abs(force.force[:, 2]))
