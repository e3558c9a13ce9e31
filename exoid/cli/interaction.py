"""``exoid interaction``: torque between wearer and exoskeleton."""

from __future__ import annotations

from typing import Annotated

from typer import Option

import exoid

from .column_map import with_remembered
from .inputs import read_drives, read_logs
from .messages import note
from .numbers import parse_numbers
from .option_groups import expand_options
from .options import READ_AS_IT_IS, AsJson, EstimateName, Figures, LogName, LogOptions, Report, Text, TorqueCutoff
from .outputs import check_outputs, print_result, save_page


@expand_options()
def interaction(
    estimate: EstimateName,
    log: LogName,
    output: Annotated[Text, Option("--output", "-o", metavar="CSV", help="Write torque and band over time.")] = None,
    report: Report = None,
    figures: Figures = None,
    strides: Annotated[
        Text, Option(metavar="T,T", help="Times at which strides begin [s]; default: touch-downs, or the period.")
    ] = None,
    cutoff: TorqueCutoff = None,
    reading: LogOptions = READ_AS_IT_IS,
    as_json: AsJson = False,
) -> None:
    """Compute the torque between wearer and exoskeleton in the LOG, and test whether anything acts.

    It is what the joints need and the actuators do not give. The exit status is 2 for bad input.

    Example: exoid interaction est.json bleex_swing:test
    """
    check_outputs({"--output": output, "--report": report}, [estimate, log, reading.actuators], figures)
    loaded = exoid.Estimate.load(estimate)
    reading = with_remembered(reading, loaded, estimate, [log])
    (recording,), drives = read_logs([log], reading), read_drives(reading, loaded.model.leg)
    times = parse_numbers(strides, "--strides")
    result = exoid.interaction(loaded, recording, strides=times, cutoff=cutoff, actuators=drives)
    if output is not None:
        result.to_csv(output)
        note(f"wrote {output}")
    save_page(lambda: exoid.view.report.interaction_report(loaded, result), figures, report)
    print_result(result, as_json=as_json)
