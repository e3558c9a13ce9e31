"""``exoid identify``: an estimate from a leg and logs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from typing import Annotated, NamedTuple

import typer

from exoid import estimate as estimates
from exoid import identification
from exoid.signals import Recording
from exoid.torques import TERMS

from .grouped import GroupedLogs, Settings, log_names
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
    Report,
    given_terms,
    read_drives,
    read_logs,
    split_names,
)
from .legs import refuse_unknown_leg
from .messages import note
from .numbers import parse_known, parse_prior
from .option_groups import expand_options
from .outputs import check_outputs
from .progress import status
from .refusals import refuse
from .remote_logs import all_at_once, each_log, is_folder_of_logs, logs_on_disk, with_progress


class FitOptions(NamedTuple):
    """Options of the fit; texts are parsed by :meth:`settings`."""

    terms: Annotated[str | None, typer.Option(metavar="A,B", help=f"{', '.join(TERMS.registered)}; none for none.")] = (
        None
    )
    estimator: Annotated[str, typer.Option(help="wls, huber, gls, ml or ols.")] = "wls"
    cutoff: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Cut-off of the zero-phase low-pass; by default 8, or lower for noisy angles."),
    ] = None
    preparation: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="finite-difference (document 1), moving-average (document 2) or smoothed."),
    ] = None
    noise: Annotated[str, typer.Option(help="correlated, or white (noise without autocorrelation).")] = "correlated"
    known: Annotated[
        list[str] | None, typer.Option(metavar="NAME=VALUE", help="Hold a parameter fixed. Repeatable.")
    ] = None
    prior: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE:STD", help="Prior and its standard deviation. Repeatable."),
    ] = None
    nonnegative: Annotated[
        bool, typer.Option("--nonnegative", help="Keep friction and rotor inertia at 0 or above.")
    ] = False
    delay: Annotated[
        str | None,
        typer.Option(metavar="auto", help="auto: estimate by how much torques are late, and shift them."),
    ] = None
    check: Annotated[bool, typer.Option("--check/--no-check", help="Look for faults of the logs.")] = True

    def settings(self) -> Settings:
        """Parse the options."""
        return Settings(
            terms=given_terms(self.terms),
            estimator=self.estimator,
            cutoff=self.cutoff,
            preparation=self.preparation,
            noise=self.noise,
            known=parse_known(self.known),
            prior=parse_prior(self.prior),
            nonnegative=self.nonnegative,
            delay=self.delay,
            check=self.check,
        )


USUAL_FIT = FitOptions()
"""The default fit."""


@expand_options()
def identify(
    leg: LegName,
    logs: LogNames,
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="EST.JSON", help="Write the estimate.")
    ] = None,
    choice: LegOptions = ANY_LEG,
    fit: FitOptions = USUAL_FIT,
    own: Annotated[
        str | None,
        typer.Option(metavar="A,B", help="Per-recording parameters (offset, c0_hip); all others are shared."),
    ] = None,
    test: Annotated[
        list[str] | None, typer.Option(metavar="LOG", help="Predict a log that is not fitted. Repeatable.")
    ] = None,
    report: Report = None,
    reading: LogOptions = READ_AS_IT_IS,
    moving_base: MovingBase = False,
    floating_base: FloatingBase = False,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Identify the parameters of LEG from the LOGs: columns time, q_<joint>, tau_<joint>, optionally v_ and a_.

    A LOG may also be a folder of logs.

    Example: exoid identify bleex bleex_swing:train -o est.json
    """
    refuse_unknown_leg(leg)
    tests = test or []
    files = {"--output": output if own is None else None, "--report": report}
    check_outputs(files, [leg, *logs, *tests, reading.segments, actuators])
    on_disk = own is None and any(map(is_folder_of_logs, logs))
    logs = each_log(logs)
    reading.refuse_other([*logs, *tests])
    grouped = None if own is None else _grouped(leg, logs, own, output, test, report)
    recordings = logs_on_disk(logs, reading) if on_disk else read_logs(logs, reading)
    held_out = read_logs(tests, reading)
    find = partial(choice.find, leg, moving_base=moving_base, floating_base=floating_base)
    if grouped is not None:
        read = partial(read_drives, actuators)
        typer.echo(grouped.identify(all_at_once(recordings), find, read, fit.settings(), as_json=as_json))
        return
    settings, found = fit.settings(), find(recordings[0].joint_names)
    with with_progress(recordings) as source:
        estimate = identification.identify(found, source, actuators=read_drives(actuators, found), **settings)
    predicted = [estimates.validate(estimate, recording) for recording in held_out]
    if output is not None:
        estimate.save(output)
    if report is not None:
        _report(estimate, all_at_once(recordings), held_out, report)
    typer.echo(_json(estimate, predicted) if as_json else "\n\n".join(map(str, [estimate, *predicted])))


def _grouped(
    leg: str,
    logs: list[str],
    own: str,
    output: str | None,
    test: list[str] | None,
    report: str | None,
) -> GroupedLogs:
    """Prepare the identification of logs with per-recording parameters."""
    refuse({"--test": test, "--report": report}, "with --own each log has an estimate")
    grouped = GroupedLogs.of(log_names(logs), split_names(own) or (), output)
    check_outputs({f"--output of {name}": path for name, path in grouped.paths.items()}, [leg, *logs])
    return grouped


def _json(estimate: estimates.Estimate, predicted: Sequence[estimates.Validation]) -> str:
    """Write an estimate without its URDF, and the predictions of the logs of ``--test``."""
    data = estimate.to_json()
    del data["leg"]["urdf"]
    if predicted:
        data["tests"] = [each.to_json() for each in predicted]
    return json.dumps(data, indent=1)


def _report(
    estimate: estimates.Estimate, recordings: Sequence[Recording], held_out: Sequence[Recording], path: str
) -> None:
    """Write the report."""
    from exoid.view.report import identification_report  # noqa: PLC0415 - only a report needs matplotlib

    with status("writing the report"):
        identification_report(estimate, recordings, held_out).save(path)
    note(f"wrote {path}")
