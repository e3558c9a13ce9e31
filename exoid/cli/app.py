"""The ``exoid`` command, with the options of all verbs."""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import sys
import warnings
from typing import Annotated

import typer

import exoid
from exoid.errors import ExoidError
from exoid.tools.tables import NARROWEST, WIDTH, line_width

from .messages import quiet
from .verbs import VERBS, LazyVerbs

BAD_INPUT = 2
"""Exit status for bad input or usage."""

PROGRAM_ERROR = 1
"""Exit status for an error that exoid did not expect."""

TRACEBACK = "--traceback"
"""Option by which an error is not turned into one line."""

QUIET = "--quiet"
"""Option by which nothing but errors is written to standard error."""

app = typer.Typer(
    name="exoid",
    cls=LazyVerbs,
    help="Identify exoskeleton legs from a URDF and logs, with uncertainties, and use the result.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,  # plain help: no unit in brackets is taken for markup, and no word is cut
    pretty_exceptions_enable=False,
)
for _name, _text in VERBS.items():  # `LazyVerbs` imports a verb when it is called
    app.command(_name, help=_text, short_help=_text)(lambda: None)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"exoid {exoid.__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and stop.")
    ] = False,
    traceback: Annotated[
        bool, typer.Option(TRACEBACK, help="Show where in the program an error was raised; also after the verb.")
    ] = False,
    silent: Annotated[
        bool, typer.Option(QUIET, help="Write only errors to standard error; also after the verb.")
    ] = False,
) -> None:
    """Options before the verb."""


def main() -> None:
    """Run the command line; any error ends in one line on standard error.

    The exit status is 2 for bad input, and 1 for an error of the program.
    """
    os.environ["MPLBACKEND"] = "agg"  # figures are files: another backend may be unknown, or open windows
    words = [word for word in sys.argv[1:] if word not in (TRACEBACK, QUIET)]
    quiet.set(QUIET in sys.argv[1:])
    warnings.simplefilter("ignore" if quiet.get() else "once", UserWarning)
    if TRACEBACK not in sys.argv[1:]:  # else Python says the place in the program, too
        warnings.formatwarning = lambda text, *_: f"warning: {text}\n"
    if "COLUMNS" in os.environ or (sys.stdout is not None and sys.stdout.isatty()):
        line_width.set(min(WIDTH, max(NARROWEST, shutil.get_terminal_size().columns)))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # names of files need not be text
    try:
        _run(words)
    except Exception as error:
        if TRACEBACK in sys.argv[1:]:
            raise
        line, status = describe_error(error)
        typer.echo(f"exoid: {line}", err=True)
        with contextlib.suppress(OSError):  # what a full disk left in the buffer was said above
            _flush()
        sys.exit(status)


def _run(words: list[str]) -> None:
    """Run a verb, and write what is left to write: a full disk is noticed only then."""
    try:
        status = app(words, standalone_mode=False)
    except SystemExit:
        _flush()
        raise
    except typer.Abort:
        status = PROGRAM_ERROR
    except Exception as error:
        if type(error).__name__ != "NoArgsIsHelpError":  # of Typer or of Click, by Typer's version
            raise
        typer.echo(error, err=True)
        status = BAD_INPUT
    _flush()
    sys.exit(status if isinstance(status, int) else 0)


def _flush() -> None:
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or the interpreter tries again when it ends
        raise


def describe_error(error: Exception) -> tuple[str, int]:
    """Describe an error in one line."""
    if isinstance(error, ExoidError):
        return error.for_command(), BAD_INPUT
    usage = getattr(error, "format_message", None)  # wrong options; a class of Typer or of Click, by Typer's version
    what = " ".join((usage() if usage else str(error)).split())
    if usage:
        what = what.rstrip(".").partition(", unable to parse")[0]
        for python, plain in (("valid float", "number"), ("valid integer", "whole number"), ("valid number", "number")):
            what = what.replace(python, plain)
        context = getattr(error, "ctx", None)
        stop = "" if what.endswith("?") else "."
        return f"{what}{stop} To fix it: see {context.command_path if context else 'exoid'} --help", BAD_INPUT
    if isinstance(error, OSError):
        where = f"{error.filename}: " if error.filename else ""
        return f"{where}{error.strerror or what}. To fix it: check this file, free space and permissions", BAD_INPUT
    if isinstance(error, MemoryError):
        return "there is not enough memory. To fix it: ask for less, or close other programs", BAD_INPUT
    kind = type(error).__name__
    remedy = f"run again with {TRACEBACK} to see where; the input is unusual, or exoid has an error: please report it"
    # Largest number of characters of an unexpected error.
    return f"{kind}: {what[:300]}. To fix it: {remedy}", PROGRAM_ERROR
