"""Report of the torque between wearer and exoskeleton."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial

import numpy as np

from exoid.control.wearer import Interaction
from exoid.estimate import Estimate
from exoid.tools.tables import DataTable
from exoid.torques.position_units import heading
from exoid.view.forces import draw_gait_profile, plot_interaction
from exoid.view.style import decimation

from .blocks import MAX_LINE_POINTS, SHOWN_SECONDS, finding_blocks, sentence, shown_part
from .page import PAGE_COLUMN, Block, Page, Picture, Text, on_axes

NOTE = (
    "Positive torque pushes the joint in its positive direction; positive power drives the leg. The band holds the "
    "true torque with a probability of 95 %. Samples near the ends of a recording are left out, as filters have not "
    "settled there."
)


def interaction_report(estimate: Estimate, found: Interaction) -> Page:
    """Report an interaction: figures of each joint, and torque over time and phase.

    Args:
        estimate: The estimate.
        found: The interaction.

    Returns:
        A page: ``interaction_report(...).save("report.html")``.
    """
    contents: dict[str, Iterable[Block]] = {
        "Torque of the wearer": [DataTable(found.source, found.headers, found.rows()), Text([NOTE])],
        "Findings": finding_blocks(found.findings),
        "Over time": _over_time(estimate, found),
        "Over the gait": _over_gait(estimate.model.leg.joint_labels, found),
    }
    title = f"{estimate.model.leg.description.name}: torque of the wearer in {found.source}"
    return Page.of(title, [sentence(str(found).rsplit("\n", 1)[-1])], contents)


def _over_time(estimate: Estimate, found: Interaction) -> Iterator[Block]:
    time = found.time - found.time[0]
    shown = decimation(int(np.searchsorted(time, SHOWN_SECONDS)), MAX_LINE_POINTS)
    for joint, label in enumerate(estimate.model.leg.joint_labels):
        if not np.isnan(found.torque[:, joint]).all():
            drawn = (time[shown], found.torque[shown, joint], found.band[shown, joint])
            yield Picture(
                on_axes(plot_interaction, *drawn, label, found.units[joint].axes["torque"]),
                f"Torque of the wearer at the {label} over time with its 95 % band",
                f"{label}, {shown_part(found.time, found.source)}",
                "wearer_torque",
            )


def _over_gait(labels: tuple[str, ...], found: Interaction) -> Iterator[Block]:
    if found.period is not None:
        yield Picture(
            partial(draw_gait_profile, profile=found.by_phase(), labels=labels, unit=heading(found.units, "{torque}")),
            "Torque and power of the wearer over the phase of the gait",
            f"{found.source}: mean ± standard deviation; a cycle of {found.period:.3g} s begins at the "
            f"{found.phase_source}",
            "wearer_gait",
            height=PAGE_COLUMN,
        )
