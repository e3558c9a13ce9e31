"""What verbs write: files that are checked before the work for them begins, and the result as a table or as JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import typer

from exoid.errors import BadArgumentError
from exoid.tools.files import make_folder, refuse_input, refuse_unwritable

from .messages import note, status
from .refusals import refuse_missing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from exoid.lab.reproduce import ReplayReport
    from exoid.view.report.page import Page


def check_outputs(
    outputs: Mapping[str, str | os.PathLike[str] | None],
    inputs: Iterable[str | os.PathLike[str] | None] = (),
    folder: str | None = None,
) -> None:
    """Check that inputs are there, and that outputs can be written and differ; make the folder of the figures."""
    read = [each for each in inputs if each is not None]
    for each in read:
        refuse_missing(os.fspath(each))
    if folder is not None:
        refuse_input(folder, read)
        make_folder(folder)
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


def save_figures(folder: str | None, figures: Mapping[str, Figure]) -> None:
    """Write figures of a paper into a folder."""
    from exoid.view.style import write_figures  # noqa: PLC0415 - matplotlib would slow down the help

    if folder is not None:
        for path in write_figures(folder, figures):
            note(f"wrote {path}")


def save_page(make: Callable[[], Page], figures: str | None, page: str | None) -> None:
    """Write a page and its pictures as figures of a paper, if they were asked for."""
    if figures is None and page is None:
        return
    with status("drawing"):
        drawn = make()
        if page is not None:
            drawn.save(page)
            note(f"wrote {page}")
        save_figures(figures, {} if figures is None else drawn.figures())


def show_report(report: ReplayReport, figures: str | None, page: str | None, *, as_json: bool) -> None:
    """Write figures and page of a report, if they were asked for, and print it."""
    save_page(report.page, figures, page)
    print_result(report, as_json=as_json, data=report.data)
