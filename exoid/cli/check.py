"""``exoid check``: the mistakes that logs have, before or beside an identification."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from exoid import identification
from exoid.findings import Finding, finding_lines, findings_table, findings_to_json
from exoid.tables import to_text
from exoid.torques import TERMS

from .inputs import (
    AsJson,
    BasePosition,
    ColumnPairs,
    Degrees,
    DriveFile,
    FloatingBase,
    Format,
    LogOptions,
    MovingBase,
    Names,
    Passive,
    Received,
    Start,
    Stop,
    Topic,
    Unmeasured,
    WrenchFrames,
    find_leg,
    given_terms,
    read_drives,
    read_logs,
    refuse_unknown_leg,
    split_names,
)
from .numbers import parse_known
from .payloads import PayloadOptions, refuse_other_payloads


def check(
    leg: Annotated[
        str, typer.Argument(metavar="LEG", help="bleex, cuhk, a dataset, a URDF file, or a robot such as panda.")
    ],
    logs: Annotated[list[str], typer.Argument(metavar="LOG...", help="Logs of any kind, or a dataset's name:train.")],
    side: Annotated[str | None, typer.Option(help="left, right or both; by default the side in the log.")] = None,
    inertias: Annotated[str | None, typer.Option(help="Inertia set of a built-in leg.")] = None,
    joints: Annotated[str | None, typer.Option(metavar="A,B", help="Moving joints of a URDF; default: logged.")] = None,
    terms: Annotated[str | None, typer.Option(metavar="A,B", help=f"{', '.join(TERMS)}; none for none.")] = None,
    cutoff: Annotated[
        float | None, typer.Option(metavar="HZ", help="Of the zero-phase low-pass; by default chosen from the logs.")
    ] = None,
    known: Annotated[
        list[str] | None, typer.Option(metavar="NAME=VALUE", help="Hold a parameter fixed. Repeatable.")
    ] = None,
    column: ColumnPairs = None,
    degrees: Degrees = False,
    start: Start = None,
    stop: Stop = None,
    topic: Topic = None,
    received: Received = False,
    names: Names = None,
    format: Format = None,
    passive: Passive = None,
    unmeasured: Unmeasured = None,
    payload: PayloadOptions = None,
    base_position: BasePosition = None,
    wrench: WrenchFrames = None,
    moving_base: MovingBase = False,
    floating_base: FloatingBase = False,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Check the LOGs of LEG for late, frozen, clipped or swapped channels, wrong units and zeros, and straps."""
    refuse_unknown_leg(leg)
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
            names=names,
            format=format,
            passive=passive,
            unmeasured=unmeasured,
            payloads=payload,
            base_position=base_position,
            wrenches=wrench,
        ),
    )
    found_leg = find_leg(
        leg,
        side,
        inertias,
        split_names(joints),
        recordings[0].joint_names,
        moving_base=moving_base,
        floating_base=floating_base,
    )
    found = identification.check(
        found_leg,
        recordings,
        given_terms(terms),
        cutoff=cutoff,
        known=parse_known(known),
        actuators=read_drives(actuators, found_leg),
    )
    typer.echo(json.dumps({"findings": findings_to_json(found)}, indent=1) if as_json else _text(found))


def _text(findings: tuple[Finding, ...]) -> str:
    """Write a table, and below it what each finding means."""
    if not findings:
        return "nothing found"
    return to_text(findings_table(findings), "", *finding_lines(findings))
