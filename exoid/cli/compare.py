"""``exoid compare``: test whether two estimates differ by more than their errors."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Argument

import exoid
from exoid.errors import BadArgumentError

from .options import AsJson, EstimateName
from .outputs import print_result


def compare(
    first: EstimateName,
    second: Annotated[str, Argument(metavar="B.JSON", help="Another, of other logs or by another estimator.")],
    as_json: AsJson = False,
) -> None:
    """Test whether B differs from A: left and right, one day and another, with and without a wearer.

    Example: exoid compare est.json other.json
    """
    if Path(first).resolve() == Path(second).resolve():
        raise BadArgumentError("is given twice", where=first, remedy="name two estimates, of other logs or another leg")
    print_result(exoid.compare(exoid.Estimate.load(first), exoid.Estimate.load(second)), as_json=as_json)
