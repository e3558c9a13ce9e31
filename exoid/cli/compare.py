"""``exoid compare``: test whether two estimates differ by more than their errors."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from exoid import estimate as estimates

from .inputs import AsJson


def compare(
    first: Annotated[str, typer.Argument(metavar="A.JSON", help="Estimate of exoid identify -o.")],
    second: Annotated[str, typer.Argument(metavar="B.JSON", help="Another, of other logs or by another estimator.")],
    as_json: AsJson = False,
) -> None:
    """Test whether B differs from A: left and right, one day and another, with and without a wearer.

    Example: exoid compare est.json other.json
    """
    result = estimates.compare(*(estimates.Estimate.load(path) for path in (first, second)))
    if as_json:
        typer.echo(json.dumps(result.to_json(), indent=1))
    else:
        typer.echo(str(result))
