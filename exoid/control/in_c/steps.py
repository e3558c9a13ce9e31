"""Statements of each law in C, from the templates beside this file."""

from __future__ import annotations

from importlib import resources


def step_of(name: str) -> str:
    """Read the statements of a law."""
    return resources.files(__package__).joinpath("steps", f"{name}.c.jinja").read_text(encoding="utf-8")
