"""``exoid check``: the mistakes that logs have, before or beside an identification."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from exoid import identification
from exoid.estimate.finding import Finding, finding_lines, findings_table, findings_to_json
from exoid.tools.tables import to_text
from exoid.torques import TERMS

from .inputs import (
    ANY_LEG,
    READ_AS_IT_IS,
    AsJson,
    DriveFile,
    FloatingBase,
    LegName,
    LegOptions,
    LogNames,
    LogOptions,
    MovingBase,
    given_terms,
    read_drives,
    read_logs,
)
from .legs import refuse_unknown_leg
from .numbers import parse_known
from .option_groups import expand_options


@expand_options()
def check(
    leg: LegName,
    logs: LogNames,
    choice: LegOptions = ANY_LEG,
    terms: Annotated[str | None, typer.Option(metavar="A,B", help=f"{', '.join(TERMS)}; none for none.")] = None,
    cutoff: Annotated[
        float | None, typer.Option(metavar="HZ", help="Of the zero-phase low-pass; by default chosen from the logs.")
    ] = None,
    known: Annotated[
        list[str] | None, typer.Option(metavar="NAME=VALUE", help="Hold a parameter fixed. Repeatable.")
    ] = None,
    reading: LogOptions = READ_AS_IT_IS,
    moving_base: MovingBase = False,
    floating_base: FloatingBase = False,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Check the LOGs of LEG for late, frozen, clipped or swapped channels, wrong units and zeros, and straps.

    Example: exoid check bleex bleex_swing:train
    """
    refuse_unknown_leg(leg)
    reading.refuse_other(logs)
    recordings = read_logs(logs, reading)
    logged = recordings[0].joint_names
    found_leg = choice.find(leg, logged, moving_base=moving_base, floating_base=floating_base)
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
