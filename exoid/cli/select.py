"""``exoid select``: friction of each joint that predicts best."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from typer import Option

import exoid

from .column_map import columns_of
from .inputs import read_drives, read_logs
from .legs import find_leg, refuse_unknown_leg
from .messages import progress_bar
from .numbers import parse_known
from .option_groups import expand_options
from .options import (
    ANY_LEG,
    FIXED_BASE,
    READ_AS_IT_IS,
    AsJson,
    EstimateOutput,
    Known,
    LegName,
    LegOptions,
    LogNames,
    LogOptions,
    Number,
)
from .outputs import check_outputs, print_result


@expand_options(without=FIXED_BASE)
def select(
    leg: LegName,
    logs: LogNames,
    output: EstimateOutput = None,
    folds: Annotated[int, Option(min=3, help="Blocks of each log, each predicted from the others.")] = 5,
    cutoff: Annotated[Number, Option(metavar="HZ", help="Low-pass of both torques; 8, or less by noise.")] = None,
    known: Known = None,
    choice: LegOptions = ANY_LEG,
    reading: LogOptions = READ_AS_IT_IS,
    as_json: AsJson = False,
) -> None:
    """Select the friction of each joint of LEG by blocked cross-validation inside the LOGs.

    Example: exoid select bleex bleex_swing:train -o est.json
    """
    refuse_unknown_leg(leg)
    check_outputs({"--output": output}, [leg, *logs])
    recordings = read_logs(logs, reading)
    found = find_leg(leg, choice, recordings[0].joint_names)
    drives, values = read_drives(reading, found), parse_known(known)
    if drives is not None:
        recordings = [drives.torque(each) for each in recordings]
    with progress_bar("selecting friction") as progress:
        select_terms = exoid.identification.select_terms
        selection = select_terms(found, recordings, folds=folds, cutoff=cutoff, known=values, progress=progress)
    if output is not None:
        replace(selection.estimate, columns=columns_of(reading)).save(output)
    print_result(f"{selection}\n\n{selection.estimate}", as_json=as_json, data=selection.to_json())
