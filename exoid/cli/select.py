"""``exoid select``: friction of each joint, filter and estimator that predict best."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from exoid import identification

from .inputs import (
    ANY_LEG,
    READ_AS_IT_IS,
    AsJson,
    DriveFile,
    LegName,
    LegOptions,
    LogNames,
    LogOptions,
    read_drives,
    read_logs,
)
from .legs import refuse_unknown_leg
from .option_groups import expand_options
from .outputs import check_outputs
from .progress import progress_bar


@expand_options()
def select(
    leg: LegName,
    logs: LogNames,
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="EST.JSON", help="Write the selected model's estimate."),
    ] = None,
    test: Annotated[
        str | None, typer.Option(metavar="LOG", help="Validate the selected model, once, on another log.")
    ] = None,
    folds: Annotated[int, typer.Option(min=3, help="Blocks of each log, each predicted from the others.")] = 5,
    cutoff: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Low-pass of the compared torques; default: 8, less for logs below 20 Hz."),
    ] = None,
    choice: LegOptions = ANY_LEG,
    reading: LogOptions = READ_AS_IT_IS,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Select friction of each joint, filter and estimator for LEG by blocked cross-validation inside the LOGs.

    Example: exoid select bleex bleex_swing:train -o est.json
    """
    refuse_unknown_leg(leg)
    check_outputs({"--output": output}, [leg, *logs, test])
    reading.refuse_other([*logs, *([test] if test else [])])
    recordings = read_logs(logs, reading)
    tested = None if test is None else read_logs([test], reading._replace(start=None, stop=None))[0]
    found = choice.find(leg, recordings[0].joint_names)
    drives = read_drives(actuators, found)
    if drives is not None:
        recordings = [drives.torque(each) for each in recordings]
        tested = None if tested is None else drives.torque(tested)
    with progress_bar("selecting friction") as progress:
        selection = identification.select_terms(found, recordings, folds=folds, cutoff=cutoff, progress=progress)
    estimate = selection.estimate
    if output is not None:
        estimate.save(output)
    data, text = selection.to_json(), [str(selection), str(estimate)]
    if tested is not None:
        validation = selection.validate(estimate, tested)
        data["test"] = validation.to_json()
        text.append(str(validation))
    typer.echo(json.dumps(data, indent=1) if as_json else "\n\n".join(text))
