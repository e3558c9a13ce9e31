"""Several estimates in words: what they share, what is their own, and what to know before trusting them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich.table import Table

from exoid.estimate.file import estimate_to_json
from exoid.estimate.text import assumptions, condition, written
from exoid.tables import make_table, to_text

from .equality import Equality
from .result import Together

HEADERS = ("value", "± std", "95 % from", "to", "unit", "determined")
"""Of what tables say of a parameter."""

DIFFERENT = 0.05
"""Probability with which own parameters of equal legs would be said to differ."""


def report(together: Together) -> str:
    """Print estimates that share parameters."""
    kind = next(iter(together.estimates.values())).estimator
    title = f"{', '.join(together.groups)}: {kind} estimate of {len(together.shared)} shared parameters"
    parts: list[Table | str] = [f"{title}, {len(together.own)} own each"]
    numbers = dict(zip(together.names, _numbers(together), strict=True))
    if together.shared:
        rows = [(name, *numbers[name]) for name in together.shared]
        parts.append(make_table(("shared", *HEADERS), rows))
    if together.own:
        parts.append(make_table(("own", *HEADERS, "p equal"), _own_rows(together, numbers)))
    return to_text(*parts, *_remarks(together))


def together_to_json(together: Together) -> dict[str, Any]:
    """Turn estimates that share parameters into what JSON can hold."""
    names = together.names
    of_each = {
        "values": together.values.tolist(),
        "std": together.std.tolist(),
        "interval_95": together.interval().tolist(),
        "units": together.units,
        "determined": together.verdicts,
        "degrees_of_freedom": together.dofs.tolist(),
    }
    return {
        **{key: dict(zip(names, column, strict=True)) for key, column in of_each.items()},
        "shared": list(together.shared),
        "own": list(together.own),
        "condition_number": together.condition_number,
        "covariance": together.covariance.tolist(),
        "equal": _equality_to_json(together.equal),
        "agreement": None if together.agreement is None else _equality_to_json(together.agreement),
        "warnings": list(together.warnings),
        "notes": list(together.notes),
        "groups": {group: estimate_to_json(together[group]) for group in together},
    }


def _numbers(together: Together) -> Iterator[tuple[str, ...]]:
    """Write each parameter's numbers."""
    columns = (together.values, together.std, together.interval(), together.units, together.verdicts)
    for value, std, interval, unit, judged in zip(*columns, strict=True):
        yield *written(value, std, interval), unit, judged


def _own_rows(together: Together, numbers: dict[str, tuple[str, ...]]) -> Iterator[tuple[str, ...]]:
    """Own parameters side by side, with the probability that they are the same in all groups."""
    for k, name in enumerate(together.own):
        for group in range(len(together)):
            place = together.names[together.layout.place(name, group)]
            p = f"{together.equal.p_values[k]:.3f}" if group == 0 and len(together) > 1 else ""
            yield place, *numbers[place], p


def _remarks(together: Together) -> Iterator[str]:
    for group in together:
        estimate = together[group]
        residuals = zip(estimate.joint_names, estimate.residual_rms, strict=True)
        yield f"residual RMS of {group} [N·m]: " + ", ".join(f"{joint} {rms:.3g}" for joint, rms in residuals)
    yield condition(together.condition_number)
    if together.own and len(together) > 1:
        yield f"own parameters that differ at 5 % of all: {', '.join(together.equal.below(DIFFERENT)) or 'none'}"
    if together.agreement is not None and together.shared:
        least = float(together.agreement.adjusted.min())
        yield f"shared parameters, each group alone: the smallest p of {len(together.shared)} is {least:.2g} (Holm)"
    yield from assumptions(together.assumed, together.bounded)
    yield from (f"warning: {warning}" for warning in together.warnings)
    yield from (f"note: {note}" for note in together.notes)


def _equality_to_json(equality: Equality) -> dict[str, Any]:
    columns = {"p_values": equality.p_values, "adjusted": equality.adjusted}
    return {key: dict(zip(equality.names, column.tolist(), strict=True)) for key, column in columns.items()}
