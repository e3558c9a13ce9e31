"""Refusing a floating base where only torques of joints are known."""

from __future__ import annotations

from exoid.errors import NotSupportedError

from .leg_data import LegData


def refuse_floating_base(leg: LegData, what: str) -> None:
    """Refuse a leg whose base floats."""
    if leg.base == "floating":
        raise NotSupportedError(
            f"{what} needs a base that is held, and that of this leg floats",
            where=leg.description.name,
            remedy='make the leg with base="fixed"',
        )
