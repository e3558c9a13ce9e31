"""``exoid check``: the mistakes that logs have, before or beside an identification."""

from __future__ import annotations

import exoid

from .inputs import given_terms, read_drives, read_logs
from .legs import find_leg, refuse_unknown_leg, refuse_without_base
from .numbers import parse_known
from .option_groups import expand_options
from .options import ANY_LEG, READ_AS_IT_IS, AsJson, Cutoff, Known, LegName, LegOptions, LogNames, LogOptions, TermNames
from .outputs import check_outputs, print_result


@expand_options()
def check(
    leg: LegName,
    logs: LogNames,
    choice: LegOptions = ANY_LEG,
    terms: TermNames = None,
    cutoff: Cutoff = None,
    known: Known = None,
    reading: LogOptions = READ_AS_IT_IS,
    as_json: AsJson = False,
) -> None:
    """Check the LOGs of LEG for late, frozen, clipped or swapped channels, wrong units and zeros, and straps.

    Example: exoid check bleex bleex_swing:train
    """
    refuse_unknown_leg(leg)
    check_outputs({}, logs)
    from exoid.estimate.finding import findings_table  # noqa: PLC0415 - help needs no NumPy
    from exoid.tools.json_values import json_value  # noqa: PLC0415
    from exoid.tools.tables import to_text  # noqa: PLC0415

    recordings = read_logs(logs, reading)
    found_leg = find_leg(leg, choice, recordings[0].joint_names)
    refuse_without_base(choice, recordings)
    drives, values = read_drives(reading, found_leg), parse_known(known)
    found = exoid.check(found_leg, recordings, given_terms(terms), cutoff=cutoff, known=values, actuators=drives)
    text = to_text(findings_table(found), "", *map(str, found)) if found else "nothing found"
    print_result(text, as_json=as_json, data={"findings": json_value(found)})
