"""Report of a replay or a study: printed, as JSON, as figures and as a page."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.estimate import Estimate
from exoid.tools.json_values import attributes, named
from exoid.tools.tables import DataTable, Report, with_error
from exoid.view.report.page import Block, Page, Picture, Text
from exoid.view.style import COLUMN

from .sequential.estimate import SequentialEstimate

LABELS = {
    "sequential": "document's",
    "cad": "CAD",
    "table_ii": "Table II",
    "no_rotor": "multisine, no rotor",
}
"""Name of a model in tables and figures, where it differs from that in the JSON."""


class Drawing(NamedTuple):
    """A figure that is drawn when it is asked for."""

    caption: str
    draw: Callable[[Figure], object]
    height: float = 0.7  # [columns of a paper]
    width: float = 1.0  # [columns of a paper]


@dataclass(frozen=True, eq=False, repr=False)
class ReplayReport(Report):
    """Report of a replay or a study; prints itself.

    Attributes:
        title: Title of the page.
        about: What was done, on the page.
        findings: Sentences about each part; the first of each is its summary.
        tables: Tables, from top to bottom.
        data: Results in JSON types.
        drawings: Figures by file name.
    """

    title: str
    about: str
    findings: Sequence[Sequence[str]]
    tables: Sequence[DataTable]
    data: dict[str, Any]
    drawings: Mapping[str, Drawing]

    def _report(self) -> list[DataTable | str]:
        lines = [line for first, *others in self.findings for line in (first, *(f"- {each}" for each in others), "")]
        return [*lines, *self.tables]

    def figures(self) -> dict[str, Figure]:
        """Draw the figures.

        Returns:
            Figures by file name.
        """
        return self.page().figures()

    def page(self) -> Page:
        """Make a page: findings, figures and tables.

        Returns:
            The page.
        """
        findings = [Text(lines) for first, *others in self.findings for lines in ([first], others) if lines]
        pictures = [
            Picture(
                *(each.draw, each.caption, each.caption, name, each.width * COLUMN, each.height * COLUMN),
                full=each.width > 1.5,
            )
            for name, each in self.drawings.items()
        ]
        contents: dict[str, Sequence[Block]] = {"Findings": findings[1:], "Figures": pictures, "Tables": self.tables}
        return Page.of(self.title, [line for line in (self.about, self.findings[0][0]) if line], contents)


def estimate_cells(
    estimate: Estimate | SequentialEstimate, name: str, true: float, *, relative: bool = False
) -> tuple[str, ...]:
    """Write value, standard deviation and error of a parameter."""
    if name not in estimate.names:
        return "–", "–", "–"
    k = estimate.names.index(name)
    value, std = float(estimate.values[k]), float(estimate.std[k])
    return *with_error(value, std), f"{100.0 * (value / true - 1.0):+.2f} %" if relative else f"{value - true:+.3g}"


def estimate_json(estimate: Estimate | SequentialEstimate, *more: str) -> dict[str, Any]:
    """Convert values and standard deviations by name, and further attributes, to JSON types."""
    each = {name: named(estimate.names, getattr(estimate, name)) for name in ("values", "std")}
    return each | attributes(estimate, *more)


def errors_table(motion: str, nrmse: Mapping[str, FloatArray], joints: Sequence[str]) -> DataTable:
    """Make a table of the torque error of each model on a motion."""
    rows = [(LABELS.get(name, name), *(f"{error:.4f}" for error in errors)) for name, errors in nrmse.items()]
    return DataTable(f"NRMSE of the torque on {motion}", ("model", *joints), rows)
