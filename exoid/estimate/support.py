"""What an estimate was fitted to while some links rested on the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any


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


def supports_to_json(supports: Sequence[Support]) -> list[dict[str, Any]]:
    """Turn supports into what JSON can hold."""
    return [{"name": one.name, "seconds": one.seconds, "residual_rms": dict(one.residual_rms)} for one in supports]


def supports_from_json(data: Sequence[Mapping[str, Any]]) -> tuple[Support, ...]:
    """Read what :func:`supports_to_json` wrote."""
    return tuple(
        Support(
            str(one["name"]), float(one["seconds"]), {str(row): float(rms) for row, rms in one["residual_rms"].items()}
        )
        for one in data
    )
