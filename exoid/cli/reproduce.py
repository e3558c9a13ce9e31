"""``exoid reproduce``: a document replayed on the virtual rig."""

from __future__ import annotations

import json
from functools import partial
from typing import Annotated, Literal

import typer
from rich.console import Console
from rich.progress import Progress, TaskID

from exoid.files import refuse_unwritable

from .inputs import AsJson, Report


def reproduce(
    document: Annotated[Literal["bleex", "cuhk"], typer.Argument(help="Which exoskeleton's document.")],
    seed: Annotated[int, typer.Option(min=0, help="Of random poses and sensor noise.")] = 0,
    figures: Annotated[str | None, typer.Option(metavar="DIR", help="Write the document's figures there.")] = None,
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Run a document's experiments on virtual rigs, identify, and print every table side by side."""
    from exoid import reproduce as replays  # noqa: PLC0415 - matplotlib would slow down the help
    from exoid.view.figure_files import make_folder, write_figures  # noqa: PLC0415

    if figures is not None:
        make_folder(figures)  # before the minute that the replay takes
    if report is not None:
        refuse_unwritable(report)
    with Progress(console=Console(stderr=True), transient=True) as bar:
        told = partial(_tell, bar, bar.add_task(f"replaying {document}", total=1.0))
        if document == "bleex":
            bleex = replays.reproduce_bleex(seed, progress=told)[0]
            text, data = replays.bleex_text(bleex), replays.bleex_json(bleex)
            draw, page = partial(replays.bleex_figures, bleex.left), partial(replays.bleex_page, bleex)
        else:
            cuhk = replays.reproduce_cuhk(seed, progress=told)[0]
            text, data = replays.cuhk_text(cuhk), replays.cuhk_json(cuhk)
            draw, page = partial(replays.cuhk_figures, cuhk), partial(replays.cuhk_page, cuhk)
    if figures is not None:
        for path in write_figures(draw(), figures):
            typer.echo(f"wrote {path}", err=True)
    if report is not None:
        page().write(report)
    typer.echo(json.dumps(data, indent=1) if as_json else text)


def _tell(bar: Progress, task: TaskID, share: float) -> None:
    bar.update(task, completed=share)
