"""``exoid validate``: prediction of logs that an estimate was not fitted to."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from exoid import estimate as estimates

from .inputs import (
    AsJson,
    BasePosition,
    ColumnPairs,
    Degrees,
    DriveFile,
    Format,
    LogOptions,
    Mask,
    Names,
    Passive,
    Received,
    Segments,
    Start,
    Stop,
    Topic,
    Unmeasured,
    WrenchFrames,
    read_drives,
    read_logs,
    refuse_other_segments,
)
from .payloads import PayloadOptions, refuse_other_payloads

NOT_PREDICTED = 1
"""Exit status where the estimate does not predict the logs."""


def validate(
    estimate: Annotated[str, typer.Argument(metavar="EST.JSON", help="Estimate of exoid identify -o.")],
    logs: Annotated[list[str], typer.Argument(metavar="LOG...", help="Logs of any kind, or a dataset's name:test.")],
    cutoff: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Cut-off of both torques, the same for all estimates that are compared."),
    ] = None,
    strict: Annotated[bool, typer.Option("--strict", help='Exit status 1 for "predicts poorly" too.')] = False,
    column: ColumnPairs = None,
    degrees: Degrees = False,
    start: Start = None,
    stop: Stop = None,
    topic: Topic = None,
    received: Received = False,
    segments: Segments = None,
    mask: Mask = None,
    names: Names = None,
    format: Format = None,
    passive: Passive = None,
    unmeasured: Unmeasured = None,
    payload: PayloadOptions = None,
    base_position: BasePosition = None,
    wrench: WrenchFrames = None,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Predict the torque of the LOGs from their motion and compare it with the measured one.

    The exit status is 1 if the estimate does not predict them, and 2 for bad input.
    """
    loaded = estimates.Estimate.load(estimate)
    refuse_other_segments(segments, logs)
    refuse_other_payloads(payload, logs)
    recordings = read_logs(
        logs,
        LogOptions(
            column,
            degrees,
            start,
            stop,
            topic,
            received,
            segments,
            mask,
            names=names,
            format=format,
            passive=passive,
            unmeasured=unmeasured,
            payloads=payload,
            base_position=base_position,
            wrenches=wrench,
        ),
    )
    result = estimates.validate(loaded, recordings, cutoff=cutoff, actuators=read_drives(actuators, loaded.model.leg))
    if as_json:
        typer.echo(json.dumps(result.to_json(), indent=1))
    else:
        typer.echo(str(result))
    fails = ("does not predict", "predicts poorly") if strict else ("does not predict",)
    if result.verdict in fails:
        raise typer.Exit(NOT_PREDICTED)
