"""Numbers by name on the command line: what is known of parameters beside the logs."""

from __future__ import annotations

from collections.abc import Sequence

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


def _named(pairs: Sequence[str] | None, option: str) -> list[tuple[str, str, str]]:
    split = [(pair, *pair.partition("=")[::2]) for pair in pairs or ()]
    names = [name.strip() for _, name, _ in split]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ExoidError(f"{option} says {', '.join(twice)} twice", remedy="say it once")
    return [(pair, name.strip(), text) for pair, name, text in split]


def _number(text: str, pair: str, option: str) -> float:
    try:
        return float(text)
    except ValueError:
        example = "X1=4.25" if option == "--known" else "J3=0.05:0.01"
        raise ExoidError(f"{option} {pair}", remedy=f"write numbers, such as {option} {example}") from None
