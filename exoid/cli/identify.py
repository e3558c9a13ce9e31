"""``exoid identify``: an estimate from a leg and logs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from typing import Annotated

import typer

from exoid import estimate as estimates
from exoid import identification
from exoid.signals import Recording
from exoid.torques import TERMS

from .grouped import GroupedLogs, Settings, log_names
from .inputs import (
    AsJson,
    BasePosition,
    ColumnPairs,
    Degrees,
    DriveFile,
    FloatingBase,
    Format,
    LogOptions,
    Mask,
    MovingBase,
    Names,
    Passive,
    Received,
    Report,
    Segments,
    Start,
    Stop,
    Topic,
    Unmeasured,
    WrenchFrames,
    find_leg,
    given_terms,
    read_drives,
    read_logs,
    refuse,
    refuse_other_segments,
    refuse_unknown_leg,
    split_names,
)
from .messages import note
from .numbers import parse_known, parse_prior
from .outputs import check_outputs
from .payloads import PayloadOptions, refuse_other_payloads
from .progress import status
from .remote_logs import all_at_once, at_hand, each_log, is_folder_of_logs, logs_on_disk


def identify(
    leg: Annotated[
        str, typer.Argument(metavar="LEG", help="bleex, cuhk, a dataset, a URDF file, or a robot such as panda.")
    ],
    logs: Annotated[
        list[str],
        typer.Argument(metavar="LOG...", help="Logs of any kind, folders of them, or a dataset's name:train."),
    ],
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="EST.JSON", help="Write the estimate.")
    ] = None,
    side: Annotated[str | None, typer.Option(help="left, right or both; by default the side in the log.")] = None,
    inertias: Annotated[str | None, typer.Option(help="Inertia set of a built-in leg.")] = None,
    joints: Annotated[str | None, typer.Option(metavar="A,B", help="Moving joints of a URDF; default: logged.")] = None,
    terms: Annotated[
        str | None, typer.Option(metavar="A,B", help=f"{', '.join(TERMS.registered)}; none for none.")
    ] = None,
    estimator: Annotated[str, typer.Option(help="wls, huber, gls, ml or ols.")] = "wls",
    cutoff: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Cut-off of the zero-phase low-pass; by default 8, or lower for noisy angles."),
    ] = None,
    preparation: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="finite-difference (document 1), moving-average (document 2) or smoothed."),
    ] = None,
    noise: Annotated[str, typer.Option(help="correlated, or white (noise without autocorrelation).")] = "correlated",
    own: Annotated[
        str | None,
        typer.Option(metavar="A,B", help="Per-recording parameters (offset, c0_hip); all others are shared."),
    ] = None,
    known: Annotated[
        list[str] | None, typer.Option(metavar="NAME=VALUE", help="Hold a parameter fixed. Repeatable.")
    ] = None,
    prior: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE:STD", help="Prior and its standard deviation. Repeatable."),
    ] = None,
    nonnegative: Annotated[
        bool, typer.Option("--nonnegative", help="Keep friction and rotor inertia at 0 or above.")
    ] = False,
    delay: Annotated[
        str | None,
        typer.Option(metavar="auto", help="auto: estimate by how much torques are late, and shift them."),
    ] = None,
    check: Annotated[bool, typer.Option("--check/--no-check", help="Look for faults of the logs.")] = True,
    test: Annotated[
        list[str] | None, typer.Option(metavar="LOG", help="Predict a log that is not fitted. Repeatable.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="TCP://HOST:PORT", help="Let a Dask cluster read the logs from a shared disk."),
    ] = None,
    report: Report = None,
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
    moving_base: MovingBase = False,
    floating_base: FloatingBase = False,
    actuators: DriveFile = None,
    as_json: AsJson = False,
) -> None:
    """Identify the parameters of LEG from the LOGs: columns time, q_<joint>, tau_<joint>, optionally v_ and a_."""
    refuse_unknown_leg(leg)
    files = {"--output": output if own is None else None, "--report": report}
    check_outputs(files, [leg, *logs, *(test or []), *(each for each in (segments, actuators) if each)])
    options = LogOptions(
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
    )
    remote = scheduler is not None or (own is None and any(map(is_folder_of_logs, logs)))
    logs = each_log(logs)
    refuse_other_segments(segments, [*logs, *(test or [])])
    refuse_other_payloads(payload, [*logs, *(test or [])])
    grouped = None if own is None else _grouped(leg, logs, own, output, test, report, scheduler)
    recordings = logs_on_disk(logs, options) if remote else read_logs(logs, options)
    held_out = read_logs(test or [], options)
    find = partial(
        find_leg, leg, side, inertias, split_names(joints), moving_base=moving_base, floating_base=floating_base
    )
    settings = Settings(
        terms=given_terms(terms),
        estimator=estimator,
        cutoff=cutoff,
        preparation=preparation,
        noise=noise,
        known=parse_known(known),
        prior=parse_prior(prior),
        nonnegative=nonnegative,
        delay=delay,
        check=check,
    )
    if grouped is not None:
        read = partial(read_drives, actuators)
        typer.echo(grouped.identify(all_at_once(recordings), find, read, settings, as_json=as_json))
        return
    found = find(recordings[0].joint_names)
    with at_hand(recordings, scheduler) as source:
        estimate = identification.identify(found, source, actuators=read_drives(actuators, found), **settings)
    predicted = [estimates.validate(estimate, recording) for recording in held_out]
    if output is not None:
        estimate.save(output)
    if report is not None:
        _report(estimate, all_at_once(recordings), held_out, report)
    if as_json:
        data = estimate.to_json()
        del data["leg"]["urdf"]
        if predicted:
            data["tests"] = [each.to_json() for each in predicted]
        typer.echo(json.dumps(data, indent=1))
    else:
        typer.echo("\n\n".join(map(str, [estimate, *predicted])))


def _grouped(
    leg: str,
    logs: list[str],
    own: str,
    output: str | None,
    test: list[str] | None,
    report: str | None,
    scheduler: str | None,
) -> GroupedLogs:
    """Prepare the identification of logs with per-recording parameters."""
    refuse({"--test": test, "--report": report}, "with --own each log has an estimate")
    refuse({"--scheduler": scheduler}, "with --own this process reads the logs")
    grouped = GroupedLogs.of(log_names(logs), split_names(own) or (), output)
    check_outputs({f"--output of {name}": path for name, path in grouped.paths.items()}, [leg, *logs])
    return grouped


def _report(
    estimate: estimates.Estimate, recordings: Sequence[Recording], held_out: Sequence[Recording], path: str
) -> None:
    """Write the report."""
    from exoid.view.report import identification_report  # noqa: PLC0415 - only a report needs matplotlib

    with status("writing the report"):
        identification_report(estimate, recordings, held_out).save(path)
    note(f"wrote {path}")
