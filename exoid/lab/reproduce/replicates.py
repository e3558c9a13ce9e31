"""Replicates of a replay."""

from __future__ import annotations

from exoid.errors import ExoidError


def refuse_no_replicates(replicates: int) -> None:
    """Refuse a number of replicates below one."""
    if replicates < 1:
        raise ExoidError(f"{replicates} replicates", remedy="request at least one")
