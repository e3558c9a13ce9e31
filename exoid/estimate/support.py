"""What an estimate was fitted to while some links rested on the ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Support:
    """Samples at which the same links rested by wrenches that were not measured."""

    name: str  # these links, or "measured"
    seconds: float  # how long they rested in all recordings [s]
    residual_rms: Mapping[str, float]  # RMS residual of each row [N, N·m], by its name

    def __str__(self) -> str:
        """Write one line."""
        sizes = ", ".join(f"{row} {rms:.3g}" for row, rms in self.residual_rms.items())
        return f"{self.name}: {self.seconds:.1f} s, residual RMS [N, N·m]: {sizes}"
