"""Report of the torque between wearer and exoskeleton."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from exoid.control.wearer import Interaction
from exoid.control.wearer.interaction import HEADERS
from exoid.estimate import Estimate
from exoid.regression.rows import for_leg
from exoid.signals import Recording
from exoid.tools.tables import DataTable
from exoid.view.forces import draw_gait_profile, plot_interaction
from exoid.view.style import decimation

from .blocks import MAX_LINE_POINTS, SHOWN_SECONDS, finding_blocks, replay_blocks, sentence, shown_part
from .page import PAGE_COLUMN, Block, Page, Picture, Text, on_axes


def interaction_report(estimate: Estimate, found: Interaction, recordings: Sequence[Recording]) -> Page:
    """Report an interaction: figures of each joint, torque over time and phase, and a replay with arrows.

    Args:
        estimate: The estimate.
        found: The interaction.
        recordings: Recordings that it was computed from.

    Returns:
        A page: ``interaction_report(...).save("report.html")``.
    """
    parts = {f"_{k}" if k > 1 else "": part for k, part in enumerate(found.parts or (found,), 1)}
    contents: dict[str, Iterator[Block]] = {
        "Torque of the wearer": _figures(found),
        "Findings": finding_blocks(found.findings),
        "Over time": _over_time(estimate, parts),
        "Over the gait": _over_gait(estimate.model.leg.joint_labels, parts),
        "Replay": _replay(estimate, parts[""], recordings[0]),
    }
    title = f"{estimate.model.leg.description.name}: torque of the wearer in {found.source}"
    return Page.of(title, [sentence(str(found).rsplit("\n", 1)[-1])], contents)


def _figures(found: Interaction) -> Iterator[Block]:
    yield from (DataTable(part.source, HEADERS, part.rows()) for part in (*found.parts, found))
    yield Text(
        [
            "Positive torque pushes the joint in its positive direction; positive power drives the leg. The band holds "
            "the true torque with a probability of 95 %. Samples near the ends of a recording are left out, as filters "
            "have not settled there."
        ]
    )


def _over_time(estimate: Estimate, parts: Mapping[str, Interaction]) -> Iterator[Block]:
    for suffix, part in parts.items():
        time = part.time - part.time[0]
        shown = decimation(int(np.searchsorted(time, SHOWN_SECONDS)), MAX_LINE_POINTS)
        for joint, label in enumerate(estimate.model.leg.joint_labels):
            if not np.isnan(part.torque[:, joint]).all():
                yield Picture(
                    on_axes(plot_interaction, time[shown], part.torque[shown, joint], part.band[shown, joint], label),
                    f"Torque of the wearer at the {label} over time with its 95 % band",
                    f"{label}, {shown_part(part.time, part.source)}",
                    f"wearer_torque{suffix}",
                )


def _over_gait(labels: tuple[str, ...], parts: Mapping[str, Interaction]) -> Iterator[Block]:
    for suffix, part in parts.items():
        if part.period is not None:
            yield Picture(
                partial(draw_gait_profile, profile=part.by_phase(), labels=labels),
                "Torque and power of the wearer over the phase of the gait",
                f"{part.source}: mean ± standard deviation; a cycle of {part.period:.3g} s begins at the "
                f"{part.phase_source}",
                f"wearer_gait{suffix}",
                height=PAGE_COLUMN,
            )


def _replay(estimate: Estimate, part: Interaction, recording: Recording) -> Iterator[Block]:
    """Replay the beginning of a recording with arrows."""
    shown = for_leg(estimate.model, recording)
    shown = shown.between(shown.time[0], shown.time[0] + SHOWN_SECONDS)
    said = f"Shown: {shown_part(part.time, part.source)}. Arrows are the torque of the wearer, the limb is theirs."
    return replay_blocks(estimate, shown, said, interaction=part)
