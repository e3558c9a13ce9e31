"""``exoid interaction``: torque between wearer and exoskeleton."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Annotated

import typer

from exoid import estimate as estimates
from exoid.control import wearer
from exoid.errors import ExoidError
from exoid.signals import Recording

from .inputs import READ_AS_IT_IS, AsJson, DriveFile, LogNames, LogOptions, Report, read_drives, read_logs
from .messages import note
from .option_groups import expand_options
from .outputs import check_outputs
from .progress import status


@expand_options()
def interaction(
    estimate: Annotated[str, typer.Argument(metavar="EST.JSON", help="Estimate of the leg without a wearer.")],
    logs: LogNames,
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="CSV", help="Write torque and band over time, of one LOG.")
    ] = None,
    report: Report = None,
    strides: Annotated[
        str | None,
        typer.Option(metavar="T,T", help="Times at which strides begin [s]; default: touch-downs, or the period."),
    ] = None,
    cutoff: Annotated[
        float | None, typer.Option(metavar="HZ", help="Cut-off of both torques; default that of the estimate.")
    ] = None,
    reading: LogOptions = READ_AS_IT_IS,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Compute the torque between wearer and exoskeleton in the LOGs, and test whether anything acts.

    It is what the joints need and the actuators do not give. The exit status is 2 for bad input.

    Example: exoid interaction est.json bleex_swing:test
    """
    check_outputs({"--output": output, "--report": report}, [estimate, *logs, reading.segments, actuators])
    if output is not None and len(logs) > 1:
        raise ExoidError(f"--output of {len(logs)} logs", remedy="give one LOG, as times of several overlap")
    loaded = estimates.Estimate.load(estimate)
    reading.refuse_other(logs)
    recordings = read_logs(logs, reading)
    drives = read_drives(actuators, loaded.model.leg)
    result = wearer.interaction(loaded, recordings, strides=_times(strides), cutoff=cutoff, actuators=drives)
    if output is not None:
        result.to_csv(output)
        note(f"wrote {output}")
    if report is not None:
        _report(loaded, result, recordings, report)
    typer.echo(json.dumps(result.to_json(), indent=1) if as_json else str(result))


def _times(text: str | None) -> list[float] | None:
    """Read times from the command line."""
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise ExoidError(f"--strides {text}", remedy="write times in s, such as --strides 1.02,2.11,3.2") from None


def _report(
    estimate: estimates.Estimate, found: wearer.Interaction, recordings: Sequence[Recording], path: str
) -> None:
    """Write the report."""
    from exoid.view.report import interaction_report  # noqa: PLC0415 - only a report needs matplotlib

    with status("writing the report"):
        interaction_report(estimate, found, recordings).save(path)
    note(f"wrote {path}")
