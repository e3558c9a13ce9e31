"""``exoid export``: from an estimate to a URDF."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from exoid import identification

from .inputs import AsJson


def export(
    estimate: Annotated[str, typer.Argument(metavar="EST.JSON", help="What exoid identify -o wrote.")],
    output: Annotated[str, typer.Option("--output", "-o", metavar="LEG.URDF", help="Write the URDF there.")],
    as_json: AsJson = False,
) -> None:
    """Write the identified inertias and friction into the URDF, and what it has no place for into LEG.exoid.json."""
    written = identification.Estimate.load(estimate).to_urdf(output)
    if as_json:
        typer.echo(json.dumps(identification.export_to_json(written), indent=1))
    else:
        typer.echo(str(written))
