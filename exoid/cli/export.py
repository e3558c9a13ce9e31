"""``exoid export``: an estimate as a URDF, or as C."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from exoid import estimate as estimates
from exoid.codegen import CSource
from exoid.errors import ExoidError
from exoid.estimate import Export
from exoid.lift import MASS_FACTOR, PULL

from .inputs import AsJson


def export(
    estimate: Annotated[str, typer.Argument(metavar="EST.JSON", help="Estimate of exoid identify -o.")],
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="LEG.URDF", help="Write the URDF there.")
    ] = None,
    c: Annotated[
        str | None, typer.Option("--c", metavar="LEG.C", help="Write the torques of a planar leg as C99 there instead.")
    ] = None,
    mass_factor: Annotated[
        float | None,
        typer.Option(
            help="Largest factor by which the mass of a link may change; beyond it nothing is written "
            f"(default: {MASS_FACTOR:g})."
        ),
    ] = None,
    pull: Annotated[
        float | None,
        typer.Option(
            help="Weight of the URDF's own links where the estimate is not that of possible links; 1 takes their "
            f"inertias as known to 50 % (default: {PULL:g})."
        ),
    ] = None,
    precision: Annotated[str | None, typer.Option(help="Precision of the C: double (default) or float.")] = None,
    as_json: AsJson = False,
) -> None:
    """Write an identified leg as a URDF, with LEG.exoid.json for parameters that a URDF cannot hold; or as C."""
    if (output is None) == (c is None):
        raise ExoidError("one file is written at a time", remedy="give either -o LEG.URDF or --c LEG.C")
    if c is None and precision is not None:
        raise ExoidError("--precision has no effect on a URDF", remedy="leave out --precision, or give --c LEG.C")
    if c is not None and (mass_factor is not None or pull is not None):
        raise ExoidError(
            "--mass-factor and --pull have no effect on C", remedy="leave them out, or write a URDF with -o LEG.URDF"
        )
    found = estimates.Estimate.load(estimate)
    if c is not None:
        written: CSource | Export = found.to_c(c, precision=precision or "double")
    else:
        written = found.to_urdf(
            str(output),
            pull=PULL if pull is None else pull,
            mass_factor=MASS_FACTOR if mass_factor is None else mass_factor,
        )
    typer.echo(json.dumps(written.to_json(), indent=1) if as_json else str(written))
