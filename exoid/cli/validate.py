"""``exoid validate``: prediction of logs that an estimate was not fitted to."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from exoid import estimate as estimates

from .inputs import READ_AS_IT_IS, AsJson, DriveFile, EstimateName, LogNames, LogOptions, read_drives, read_logs
from .option_groups import expand_options

NOT_PREDICTED = 1
"""Exit status where the estimate does not predict the logs."""


@expand_options()
def validate(
    estimate: EstimateName,
    logs: LogNames,
    cutoff: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Cut-off of both torques, the same for all estimates that are compared."),
    ] = None,
    strict: Annotated[bool, typer.Option("--strict", help='Exit status 1 for "predicts poorly" too.')] = False,
    reading: LogOptions = READ_AS_IT_IS,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Predict the torque of the LOGs from their motion and compare it with the measured one.

    The exit status is 1 if the estimate does not predict them, and 2 for bad input.

    Example: exoid validate est.json bleex_swing:test
    """
    loaded = estimates.Estimate.load(estimate)
    reading.refuse_other(logs)
    recordings = read_logs(logs, reading)
    result = estimates.validate(loaded, recordings, cutoff=cutoff, actuators=read_drives(actuators, loaded.model.leg))
    typer.echo(json.dumps(result.to_json(), indent=1) if as_json else str(result))
    fails = ("does not predict", "predicts poorly") if strict else ("does not predict",)
    if result.verdict in fails:
        raise typer.Exit(NOT_PREDICTED)
