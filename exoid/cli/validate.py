"""``exoid validate``: prediction of logs that an estimate was not fitted to."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from typer import Exit, Option

import exoid

from .column_map import with_remembered
from .inputs import read_drives, read_logs
from .option_groups import expand_options
from .options import READ_AS_IT_IS, AsJson, EstimateName, Figures, LogNames, LogOptions, Report, TorqueCutoff
from .outputs import check_outputs, print_result, save_page


@expand_options()
def validate(
    estimate: EstimateName,
    logs: LogNames,
    cutoff: TorqueCutoff = None,
    report: Report = None,
    figures: Figures = None,
    strict: Annotated[bool, Option("--strict", help='Exit status 1 for "predicts poorly" too.')] = False,
    reading: LogOptions = READ_AS_IT_IS,
    as_json: AsJson = False,
) -> None:
    """Predict the torque of the LOGs from their motion and compare it with the measured one.

    The exit status is 1 if the estimate does not predict them, and 2 for bad input.

    Example: exoid validate est.json bleex_swing:test
    """
    check_outputs({"--report": report}, [estimate, *logs, reading.actuators], figures)
    loaded = exoid.Estimate.load(estimate)
    reading = with_remembered(reading, loaded, estimate, logs)
    drives = read_drives(reading, loaded.model.leg)
    recordings = read_logs(logs, reading)
    result = exoid.validate(loaded, recordings, cutoff=cutoff, actuators=drives)
    loaded = loaded if drives is None else replace(loaded, actuators=drives)
    save_page(lambda: exoid.view.report.identification_report(loaded, (), recordings, cutoff=cutoff), figures, report)
    print_result(result, as_json=as_json)
    if result.verdict in ("does not predict", *(["predicts poorly"] if strict else [])):
        raise Exit(1)  # exit status where the estimate does not predict the logs
