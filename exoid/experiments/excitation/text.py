"""Predicted precision as a table, as text and as JSON."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from exoid.tools.json_values import attributes, named
from exoid.tools.tables import make_table, to_text

from .precision import Precision


def prediction_text(head: str, precision: Precision, more: Iterable[str] = ()) -> str:
    """Print a table of expected value and predicted precision with its head, and below it what is not determined."""
    p = precision
    columns = (p.names, p.scales.expected, p.std, p.relative, p.identifiability, p.units)
    table = make_table(
        ["parameter", "expected", "± std", "% of scale", "class", "unit"],
        [
            (name, f"{value:.4g}", _digits(std), _digits(100.0 * relative), grade, unit)
            for name, value, std, relative, grade, unit in zip(*columns, strict=True)
        ],
    )
    lines = []
    for word, phrase in (("not", "cannot be determined"), ("weakly", "will be determined weakly")):
        if names := [name for name, grade in zip(p.names, p.identifiability, strict=True) if grade == word]:
            lines.append(f"{', '.join(names)} {phrase}")
    if not lines:
        lines.append(f"every parameter is determined well, the worst to {_digits(100.0 * p.worst)} % of its scale")
    return to_text(head, table, f"condition number {p.condition_number:.0f}", *lines, *more)


def precision_to_json(precision: Precision) -> dict[str, Any]:
    """Convert a prediction to JSON types."""
    names = precision.names
    return {
        "predicted_std": named(names, precision.std),
        "relative_std": named(names, precision.relative),
        "determined": named(names, precision.identifiability),
        "scale": named(names, precision.scales.scale),
        **attributes(precision, "condition_number", "duration"),
    }


def _digits(x: float) -> str:
    return f"{x:.2g}" if math.isfinite(x) and x < 1000.0 else "∞" if not math.isfinite(x) else f"{x:.0f}"
