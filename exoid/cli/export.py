"""``exoid export``: from an estimate to a URDF, or to C."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from exoid import codegen
from exoid import estimate as estimates
from exoid.errors import ExoidError

from .inputs import AsJson


def export(
    estimate: Annotated[str, typer.Argument(metavar="EST.JSON", help="What exoid identify -o wrote.")],
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="LEG.URDF", help="Write the URDF there.")
    ] = None,
    c: Annotated[
        str | None, typer.Option("--c", metavar="LEG.C", help="Write the torques of a planar leg as C99 there instead.")
    ] = None,
    precision: Annotated[str | None, typer.Option(help="Of the C: double (default) or float.")] = None,
    as_json: AsJson = False,
) -> None:
    """Write what was identified into the URDF, and what that has no place for into LEG.exoid.json; or write it as C."""
    if (output is None) == (c is None):
        raise ExoidError("one file is written at a time", remedy="give either -o LEG.URDF or --c LEG.C")
    if c is None and precision is not None:
        raise ExoidError("--precision has no effect on a URDF", remedy="leave out --precision, or give --c LEG.C")
    found = estimates.Estimate.load(estimate)
    written: estimates.Export | codegen.CSource
    if output is not None:
        written = found.to_urdf(output)
        as_data = written.to_json()
    else:
        written = found.to_c(str(c), precision=precision or "double")
        as_data = codegen.c_source_to_json(written)
    typer.echo(json.dumps(as_data, indent=1) if as_json else str(written))
