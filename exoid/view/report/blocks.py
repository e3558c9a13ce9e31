"""Blocks that the reports of an identification and of an interaction share."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from exoid._typing import FloatArray
from exoid.control.wearer import Interaction
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.estimate.finding import Finding, findings_table
from exoid.signals import Recording
from exoid.view.scenes import scene

from .page import Block, EmbeddedPage, Text

SHOWN_SECONDS = 20.0
"""Length of the part of a recording that is drawn over time and replayed [s]."""

MAX_LINE_POINTS = 1000
"""Largest number of samples of a line: 50 per second."""


def shown_part(time: FloatArray, source: str) -> str:
    """Name the part of a recording that is drawn."""
    seconds = float(time[-1] - time[0])
    return f"{source} ({seconds:.0f} s)" if seconds <= SHOWN_SECONDS else f"the first {SHOWN_SECONDS:.0f} s of {source}"


def finding_blocks(findings: Sequence[Finding]) -> Iterator[Block]:
    """Table of findings, and what each means; nothing where there are none."""
    if findings:
        yield findings_table(findings)
        yield Text([sentence(line) for line in map(str, findings)])


def replay_blocks(
    estimate: Estimate, shown: Recording, sentences: str, interaction: Interaction | None = None
) -> Iterator[Block]:
    """Replay a recording in three dimensions, with the torque of a wearer if it is given."""
    try:
        replay = scene(estimate, recording=shown, interaction=interaction)
        page = EmbeddedPage(replay.html(), f"{replay.title} in three dimensions")
    except ExoidError as error:
        yield Text([f"The leg cannot be drawn: {error.what}."])
        return
    yield from (Text([sentences]), page)


def sentence(clause: str) -> str:
    """Make a clause a sentence: a capital letter first, a full stop last."""
    return f"{clause[:1].upper()}{clause[1:]}."
