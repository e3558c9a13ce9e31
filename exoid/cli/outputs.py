"""What verbs write: files that are checked before the work for them begins, and the result as a table or as JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import typer

from exoid.errors import BadArgumentError
from exoid.tools.files import make_folder, refuse_input, refuse_unwritable

from .messages import note

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from exoid.lab.reproduce import ReplayReport


def check_outputs(
    outputs: Mapping[str, str | os.PathLike[str] | None],
    inputs: Iterable[str | os.PathLike[str] | None] = (),
    folder: str | None = None,
) -> None:
    """Check that files can be written, differ from each other and are no inputs; make the folder of the figures."""
    if folder is not None:
        make_folder(folder)
    read = [each for each in inputs if each is not None]
    options: dict[str, str] = {}
    for option, path in outputs.items():
        if path is None:
            continue
        refuse_input(path, read)
        refuse_unwritable(path)
        rival = options.setdefault(os.path.realpath(path), option)
        if rival != option:
            what = f"{rival} and {option} name one file"
            raise BadArgumentError(what, where=str(path), remedy="give each its own name")


def print_result(result: Any, *, as_json: bool, data: object = None) -> None:  # noqa: ANN401 - any that prints itself
    """Print a result as its text, or as JSON: ``data``, or what its ``to_json`` says."""
    typer.echo(json.dumps(result.to_json() if data is None else data, indent=1) if as_json else str(result))


def save_figures(folder: str | None, figures: Mapping[str, Figure], file_format: str = "png") -> None:
    """Write figures into a folder."""
    from exoid.view.style import write_figures  # noqa: PLC0415 - matplotlib would slow down the help

    if folder is not None:
        for path in write_figures(folder, figures, file_format):
            note(f"wrote {path}")


def show_report(
    report: ReplayReport, figures: str | None, page: str | None, file_format: str = "png", *, as_json: bool
) -> None:
    """Write figures and page of a report, if they were asked for, and print it."""
    if figures is not None:
        save_figures(figures, report.figures(), file_format)
    if page is not None:
        report.page().save(page)
        note(f"wrote {page}")
    print_result(report, as_json=as_json, data=report.data)
