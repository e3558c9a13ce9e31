"""``exoid check``: the mistakes that logs have, before or beside an identification."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from typer import Option

import exoid

from .inputs import given_terms, read_drives, read_logs
from .legs import find_leg, refuse_unknown_leg, refuse_without_base
from .numbers import parse_known
from .option_groups import expand_options
from .options import (
    ANY_LEG,
    READ_AS_IT_IS,
    AsJson,
    DriveFile,
    Known,
    LegName,
    LegOptions,
    LogNames,
    LogOptions,
    Number,
    TermNames,
)
from .outputs import print_result

if TYPE_CHECKING:
    from exoid.estimate.finding import Finding


@expand_options()
def check(
    leg: LegName,
    logs: LogNames,
    choice: LegOptions = ANY_LEG,
    terms: TermNames = None,
    cutoff: Annotated[
        Number, Option(metavar="HZ", help="Of the zero-phase low-pass; by default chosen from the logs.")
    ] = None,
    known: Known = None,
    reading: LogOptions = READ_AS_IT_IS,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Check the LOGs of LEG for late, frozen, clipped or swapped channels, wrong units and zeros, and straps.

    Example: exoid check bleex bleex_swing:train
    """
    from exoid.tools.json_values import json_value  # noqa: PLC0415 - help needs no NumPy

    refuse_unknown_leg(leg)
    recordings = read_logs(logs, reading)
    found_leg = find_leg(leg, choice, recordings[0].joint_names)
    refuse_without_base(choice, recordings)
    drives, values = read_drives(actuators, found_leg), parse_known(known)
    found = exoid.check(found_leg, recordings, given_terms(terms), cutoff=cutoff, known=values, actuators=drives)
    print_result(_text(found), as_json=as_json, data={"findings": json_value(found)})


def _text(findings: tuple[Finding, ...]) -> str:
    """Write a table, and below it what each finding means."""
    from exoid.estimate.finding import findings_table  # noqa: PLC0415
    from exoid.tools.tables import to_text  # noqa: PLC0415

    return to_text(findings_table(findings), "", *map(str, findings)) if findings else "nothing found"
