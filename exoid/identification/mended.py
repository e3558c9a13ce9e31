"""Faults of logs that were mended before the fit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from exoid._typing import FloatArray
from exoid.findings import Finding


class Mended(NamedTuple):
    """Faults that were mended.

    Attributes:
        findings: What was mended in each group; empty for nothing.
        delays: Delays that were taken out of the torques of each group [s], (n,) each; empty for none.
    """

    findings: tuple[tuple[Finding, ...], ...] = ()
    delays: tuple[FloatArray, ...] = ()

    def shifted(self, delays: Sequence[FloatArray], findings: Sequence[Sequence[Finding]]) -> Mended:
        """Add delays that were taken out.

        Args:
            delays: Delays of the torques of each group [s], (n,) each.
            findings: What was shifted in each group.

        Returns:
            All that was mended.
        """
        both = zip(self.findings, findings, strict=True)
        return Mended(tuple((*before, *new) for before, new in both), tuple(delays))

    def findings_of(self, group: int) -> tuple[Finding, ...]:
        """What was mended in a group.

        Args:
            group: Index of the group.

        Returns:
            Findings.
        """
        return self.findings[group] if self.findings else ()


NOTHING_MENDED = Mended()
"""Stands for logs that were fitted as they are."""
