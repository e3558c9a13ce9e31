"""``exoid reproduce``: a document replayed on the virtual rig."""

from __future__ import annotations

import json
from typing import Annotated, Literal

import typer
from rich.console import Console
from rich.progress import Progress

from exoid import reproduce as replays

from .inputs import AsJson


def reproduce(
    document: Annotated[Literal["bleex", "cuhk"], typer.Argument(help="Which exoskeleton's document.")],
    seed: Annotated[int, typer.Option(min=0, help="Of random poses and sensor noise.")] = 0,
    figures: Annotated[str | None, typer.Option(metavar="DIR", help="Write the document's figures there.")] = None,
    as_json: AsJson = False,
) -> None:
    """Run a document's experiments on virtual rigs, identify, and print every table side by side."""
    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(f"replaying {document}", total=1.0)
        told = lambda share: bar.update(task, completed=share)  # noqa: E731
        if document == "bleex":
            bleex = replays.reproduce_bleex(seed, progress=told)[0]
            text, data = replays.bleex_text(bleex), replays.bleex_json(bleex)
        else:
            cuhk = replays.reproduce_cuhk(seed, progress=told)[0]
            text, data = replays.cuhk_text(cuhk), replays.cuhk_json(cuhk)
    typer.echo(json.dumps(data, indent=1) if as_json else text)
