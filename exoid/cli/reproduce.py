"""``exoid reproduce``: a document replayed on the virtual rig, or the study of stance beside both."""

from __future__ import annotations

import json
from functools import partial
from typing import Annotated, Literal

import typer

from exoid.tools.files import make_folder

from .inputs import AsJson, Report
from .messages import note
from .outputs import check_outputs
from .progress import progress_bar


def reproduce(
    document: Annotated[
        Literal["bleex", "cuhk", "stance"], typer.Argument(help="Exoskeleton of the document, or stance.")
    ],
    seed: Annotated[int, typer.Option(min=0, help="Seed of random poses and sensor noise.")] = 0,
    figures: Annotated[str | None, typer.Option(metavar="DIR", help="Folder for the document's figures.")] = None,
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Run a document's experiments on virtual rigs, identify, and print every table side by side.

    "stance" is a study beside the documents: BLEEX swings, stands and walks, with and without force plates.

    Example: exoid reproduce cuhk --report cuhk.html
    """
    from exoid.lab import reproduce as replays  # noqa: PLC0415 - matplotlib would slow down the help
    from exoid.view.figure_files import write_figures  # noqa: PLC0415

    if figures is not None:
        make_folder(figures)  # before the minute that the replay takes
    check_outputs({"--report": report})
    with progress_bar(f"replaying {document}") as progress:
        if document == "bleex":
            bleex = replays.reproduce_bleex(seed, progress=progress)[0]
            text, data = replays.bleex_text(bleex), replays.bleex_json(bleex)
            draw, page = partial(replays.bleex_figures, bleex.left), partial(replays.bleex_page, bleex)
        elif document == "stance":
            stance = replays.reproduce_stance(seed, progress=progress)
            text, data = replays.stance_text(stance), replays.stance_json(stance)
            draw, page = partial(replays.stance_figures, stance), partial(replays.stance_page, stance)
        else:
            cuhk = replays.reproduce_cuhk(seed, progress=progress)[0]
            text, data = replays.cuhk_text(cuhk), replays.cuhk_json(cuhk)
            draw, page = partial(replays.cuhk_figures, cuhk), partial(replays.cuhk_page, cuhk)
    if figures is not None:
        for path in write_figures(figures, draw()):
            note(f"wrote {path}")
    if report is not None:
        page().save(report)
        note(f"wrote {report}")
    typer.echo(json.dumps(data, indent=1) if as_json else text)
