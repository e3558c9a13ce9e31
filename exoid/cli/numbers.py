"""Numbers on the command line: by parameter, and by joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError


def parse_known(pairs: Sequence[str] | None) -> dict[str, float]:
    """Turn "X1=4.25" into a value by name."""
    return {name: _number(text, pair, "--known") for pair, name, text in _named(pairs, "--known")}


def parse_prior(pairs: Sequence[str] | None) -> dict[str, tuple[float, float]]:
    """Turn "J3=0.05:0.01" or "J3=0.05±0.01" into a value and its standard deviation by name."""
    found = {}
    for pair, name, text in _named(pairs, "--prior"):
        value, _, std = text.replace("±", ":").partition(":")
        found[name] = (_number(value, pair, "--prior"), _number(std, pair, "--prior"))
    return found


def joint_values(text: str, option: str, joints: Sequence[str], *, one_for_all: bool = False) -> FloatArray:
    """Turn "22,55" into one number for each joint."""
    try:
        values = np.array([float(part) for part in text.split(",")])
    except ValueError:
        values = np.array([])
    if len(values) not in ((1, len(joints)) if one_for_all else (len(joints),)) or not np.isfinite(values).all():
        alternative = ", or one for all" if one_for_all else ""
        raise ExoidError(
            f"{option} {text}", remedy=f"give one number for each of {', '.join(joints)}: A,B,…{alternative}"
        )
    return np.broadcast_to(values, (len(joints),)).copy()


def _named(pairs: Sequence[str] | None, option: str) -> list[tuple[str, str, str]]:
    split = [(pair, *pair.partition("=")[::2]) for pair in pairs or ()]
    names = [name.strip() for _, name, _ in split]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ExoidError(f"{option} gives {', '.join(twice)} twice", remedy="give each once")
    return [(pair, name.strip(), text) for pair, name, text in split]


def _number(text: str, pair: str, option: str) -> float:
    try:
        return float(text)
    except ValueError:
        example = "X1=4.25" if option == "--known" else "J3=0.05:0.01"
        raise ExoidError(f"{option} {pair}", remedy=f"write numbers, such as {option} {example}") from None
