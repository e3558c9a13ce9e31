"""The ``exoid`` command, with the options of all verbs."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

import exoid
from exoid.errors import ExoidError

from .verbs import LazyVerbs, add_verbs

BAD_INPUT = 2
"""Exit status for bad input or usage."""

app = typer.Typer(
    name="exoid",
    cls=LazyVerbs,
    help="Identify exoskeleton legs from a URDF and logs, with uncertainties, and use the result.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
add_verbs(app)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"exoid {exoid.__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Options before the verb."""


def main() -> None:
    """Run the command line; bad input ends in one line on standard error and exit status 2."""
    try:
        app()
    except ExoidError as error:
        typer.echo(f"exoid: {error}", err=True)
        sys.exit(BAD_INPUT)
