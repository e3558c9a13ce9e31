"""``exoid compare``: test whether two estimates differ by more than their errors."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Argument

import exoid
from exoid.errors import BadArgumentError

from .inputs import load_estimate
from .options import AsJson, EstimateName, Figures
from .outputs import check_outputs, print_result, save_figures


def compare(
    first: EstimateName,
    second: Annotated[str, Argument(metavar="B.JSON", help="Another, of other logs or by another estimator.")],
    figures: Figures = None,
    as_json: AsJson = False,
) -> None:
    """Test whether B differs from A: left and right, one day and another, with and without a wearer.

    Example: exoid compare est.json other.json
    """
    if Path(first).resolve() == Path(second).resolve():
        raise BadArgumentError("is given twice", where=first, remedy="name two estimates, of other logs or another leg")
    check_outputs({}, [first, second], figures)
    both = load_estimate(first), load_estimate(second)
    result = exoid.compare(*both)
    if figures is not None:
        save_figures(figures, exoid.view.report.comparison_figures(*both, result))
    print_result(result, as_json=as_json)
