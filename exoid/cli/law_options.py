"""Options of a control law that is written as C."""

from __future__ import annotations

from typing import NamedTuple

from exoid.codegen.laws.safety import SafeTorque


class LawOptions(NamedTuple):
    """Options of a law; None for the default of each."""

    kp: str | None
    kd: str | None
    rate: float | None
    period: float | None
    role: list[str] | None
    limit: str | None
    slew: str | None
    safe: SafeTorque | None
    patience: float | None
    share: str | None
    amplification: str | None
    bandwidth: float | None

    def given(self) -> list[str]:
        """List the options that were given."""
        return [f"--{name}" for name, value in self._asdict().items() if value is not None]
