"""``exoid export``: an estimate as a URDF, or as C."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from exoid import estimate as estimates
from exoid.errors import ExoidError
from exoid.exported import sidecar_of

from .inputs import AsJson
from .outputs import check_outputs


def export(
    estimate: Annotated[str, typer.Argument(metavar="EST.JSON", help="Estimate of exoid identify -o.")],
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="LEG.URDF", help="Write the URDF there.")
    ] = None,
    c: Annotated[
        str | None, typer.Option("--c", metavar="LEG.C", help="Write the torques of a planar leg as C99 there instead.")
    ] = None,
    precision: Annotated[str | None, typer.Option(help="Precision of the C: double (default) or float.")] = None,
    as_json: AsJson = False,
) -> None:
    """Write an identified leg as a URDF, with LEG.exoid.json for parameters that a URDF cannot hold; or as C."""
    if (output is None) == (c is None):
        raise ExoidError("one file is written at a time", remedy="give either -o LEG.URDF or --c LEG.C")
    if c is None and precision is not None:
        raise ExoidError("--precision has no effect on a URDF", remedy="leave out --precision, or give --c LEG.C")
    sidecar = sidecar_of(Path(output)) if output is not None and Path(output).name else None
    check_outputs({"--output": output, "the file beside --output": sidecar, "--c": c}, [estimate])
    found = estimates.Estimate.load(estimate)
    written = found.to_c(c, precision=precision or "double") if c is not None else found.to_urdf(str(output))
    typer.echo(json.dumps(written.to_json(), indent=1) if as_json else str(written))
