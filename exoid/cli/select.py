"""``exoid select``: which friction model, filter and estimator predict best."""

from __future__ import annotations

import json
from functools import partial
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress, TaskID

from exoid import identification
from exoid.errors import ExoidError
from exoid.identification.selection import Candidate, friction_candidates

from .inputs import AsJson, Column, Degrees, LogOptions, Start, Stop, find_leg, read_logs, split_names

FRICTION = [candidate.name for candidate in friction_candidates()]
"""What is compared by default."""


def select(
    leg: Annotated[str, typer.Argument(metavar="LEG", help="bleex, cuhk, a dataset's name, or a URDF file.")],
    logs: Annotated[list[str], typer.Argument(metavar="LOG...", help="CSV files, or a dataset's name:train.")],
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="EST.JSON", help="Identify with the choice, and write it.")
    ] = None,
    test: Annotated[
        str | None, typer.Option(metavar="LOG", help="Validate the choice, once, on a log it was not made from.")
    ] = None,
    friction: Annotated[
        str | None, typer.Option(metavar="A,B", help=f"Models to compare; default: {', '.join(FRICTION)}.")
    ] = None,
    folds: Annotated[int, typer.Option(min=3, help="Stretches of each log that are predicted from the others.")] = 5,
    cutoff: Annotated[float, typer.Option(metavar="HZ", help="Low-pass behind which torques are compared.")] = 8.0,
    side: Annotated[str | None, typer.Option(help="left or right; by default the side in the log.")] = None,
    inertias: Annotated[str | None, typer.Option(help="Inertia set of a built-in leg.")] = None,
    joints: Annotated[str | None, typer.Option(metavar="A,B", help="Moving joints of a URDF; default: logged.")] = None,
    column: Column = None,
    degrees: Degrees = False,
    start: Start = None,
    stop: Stop = None,
    as_json: AsJson = False,
) -> None:
    """Select terms, filter and estimator for LEG by blocked cross-validation inside the LOGs."""
    recordings = read_logs(logs, LogOptions(column, degrees, start, stop))
    tested = read_logs([test], LogOptions(column, degrees))[0] if test is not None else None
    found = find_leg(leg, side, inertias, split_names(joints), recordings[0].joint_names)
    with Progress(console=Console(stderr=True), transient=True) as bar:
        told = partial(_tell, bar, bar.add_task("trying candidates", total=1.0))
        selection = identification.select_terms(
            found, recordings, _candidates(friction, cutoff), folds=folds, cutoff=cutoff, progress=told
        )
    estimate = selection.identify(recordings)
    if output is not None:
        estimate.save(output)
    data, text = selection.to_json(), [str(selection), str(estimate)]
    if tested is not None:
        validation = selection.validate(estimate, tested)
        data["test"] = validation.to_json()
        text.append(str(validation))
    typer.echo(json.dumps(data, indent=1) if as_json else "\n\n".join(text))


def _candidates(names: str | None, cutoff: float) -> list[Candidate]:
    """Friction models by name, all without."""
    known = {candidate.name: candidate for candidate in friction_candidates(cutoff)}
    wanted = list(known) if names is None else [name.strip() for name in names.split(",")]
    missing = [name for name in wanted if name not in known]
    if missing:
        raise ExoidError(f"no friction model {', '.join(missing)}", remedy=f"use some of {', '.join(known)}")
    return [known[name] for name in wanted]


def _tell(bar: Progress, task: TaskID, share: float) -> None:
    bar.update(task, completed=share)
