"""Blocks that the reports of an identification and of an interaction share."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from exoid._typing import FloatArray
from exoid.estimate.finding import Finding, findings_table

from .page import Block, Text

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


def sentence(clause: str) -> str:
    """Make a clause a sentence: a full stop last, and a capital letter first, but not of a name such as mcx_thigh."""
    first = clause[:1].upper() if re.match(r"[a-z]+\b", clause) else clause[:1]
    return f"{first}{clause[1:]}."
