"""``exoid plan``: the motion to record, or the precision that a recording allows."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import typer

from exoid import view
from exoid.errors import ExoidError
from exoid.experiments import excitation
from exoid.experiments.excitation import Assessment, Clearance, GroundLimits, Plan, StancePlan
from exoid.files import write_bytes
from exoid.rig.ground import Sole

from .inputs import (
    AsJson,
    ColumnPairs,
    Degrees,
    LogOptions,
    Names,
    Passive,
    Start,
    Stop,
    Unmeasured,
    find_leg,
    parse_numbers,
    parse_terms,
    read_logs,
    refuse,
    refuse_unknown_leg,
    split_names,
)
from .messages import note
from .outputs import check_outputs
from .progress import progress_bar

FIGURE_INCHES = (7.2, 4.6)


def plan(
    leg: Annotated[
        str, typer.Argument(metavar="LEG", help="bleex, cuhk, a dataset, a URDF file, or a robot such as panda.")
    ],
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="PLAN.CSV", help="Write the motion (and poses).")
    ] = None,
    assess: Annotated[
        list[str] | None,
        typer.Option("--assess", metavar="LOG", help="Instead, assess this log. Repeatable."),
    ] = None,
    side: Annotated[str | None, typer.Option(help="left or right, of a built-in leg.")] = None,
    inertias: Annotated[str | None, typer.Option(help="Inertia set of a built-in leg.")] = None,
    joints: Annotated[str | None, typer.Option(metavar="A,B", help="Moving joints of a URDF; default: all.")] = None,
    terms: Annotated[
        str | None, typer.Option(metavar="A,B", help="armature, coulomb, offset, stiffness, viscous; none for none.")
    ] = None,
    duration: Annotated[float, typer.Option(metavar="S", help="Duration of all motions together.")] = 60.0,
    rate: Annotated[float, typer.Option(metavar="HZ", help="Rate of controller and log.")] = 100.0,
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="N·M", help="Torque noise, one number or one for each joint; default: 2 % of typical torques."
        ),
    ] = None,
    noise_bandwidth: Annotated[
        float, typer.Option(metavar="HZ", help="Bandwidth of the noise; default: white.")
    ] = float("inf"),
    highest: Annotated[float, typer.Option(metavar="HZ", help="Highest frequency of the motion.")] = 1.0,
    angles: Annotated[
        list[str] | None, typer.Option(metavar="JOINT=LOW:HIGH", help="Narrower range [deg]. Repeatable.")
    ] = None,
    margin: Annotated[float, typer.Option(metavar="DEG", help="Distance to the URDF's joint limits.")] = 3.0,
    velocity: Annotated[str | None, typer.Option(metavar="RAD/S", help="Velocity limits below the URDF's.")] = None,
    acceleration: Annotated[str | None, typer.Option(metavar="RAD/S²", help="Acceleration limits.")] = None,
    torque: Annotated[str | None, typer.Option(metavar="N·M", help="Torque limits below the URDF's.")] = None,
    ground: Annotated[
        float | None, typer.Option(metavar="M", help="Depth of the ground below the first joint; needs --foot.")
    ] = None,
    foot: Annotated[
        list[str] | None,
        typer.Option(metavar="X,Z", help="Point of the foot, forward and up of the last joint [m]. Repeatable."),
    ] = None,
    clearance: Annotated[float, typer.Option(metavar="M", help="Least distance of --foot from the ground.")] = 0.05,
    tilts: Annotated[str, typer.Option(metavar="DEG,DEG", help="Torso tilts of the motions.")] = "0",
    poses: Annotated[int, typer.Option(min=0, help="Number of additional static poses at each tilt.")] = 0,
    criterion: Annotated[Literal["worst", "a", "d"], typer.Option(help="Criterion to minimise.")] = "worst",
    starts: Annotated[
        int | None, typer.Option(min=1, help="Number of starts of the search; default: 16, with --stance 2.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the search.")] = 0,
    stance: Annotated[
        str | None,
        typer.Option(metavar="both,left", help="Plan motions on these feet instead: squats, shifts, leg swings."),
    ] = None,
    sole: Annotated[
        list[str] | None,
        typer.Option(metavar="FOOT=HEEL,TOE,HEIGHT", help="Sole in the axes of its link [m]; default: BLEEX's."),
    ] = None,
    friction: Annotated[
        float | None, typer.Option(metavar="MU", help="Friction of the ground that --stance may use; default 0.4.")
    ] = None,
    doubt: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Doubt about expected parameters in --stance; default 0.05.")
    ] = None,
    figure: Annotated[str | None, typer.Option(metavar="PNG", help="Draw motion and precision.")] = None,
    column: ColumnPairs = None,
    degrees: Degrees = False,
    start: Start = None,
    stop: Stop = None,
    names: Names = None,
    passive: Passive = None,
    unmeasured: Unmeasured = None,
    as_json: AsJson = False,
) -> None:
    """Find the motion that identifies LEG best, and predict the precision of its parameters; or --assess a log."""
    refuse_unknown_leg(leg)
    supports = split_names(stance)
    if supports is None:
        refuse({"--sole": sole, "--friction": friction, "--doubt": doubt}, "they are for --stance")
    else:
        swinging = {"--assess": assess, "--foot": foot, "--ground": ground, "--poses": poses or None}
        refuse(swinging | {"--tilts": None if tilts == "0" else tilts}, "--stance plans motions on the ground")
    pitches = [math.radians(tilt) for tilt in parse_numbers(tilts, "--tilts") or ()]
    files: tuple[Path, ...] = ()
    if output is not None and supports is not None:
        files = excitation.stance_files(output, supports)
    elif output is not None and not assess:
        files = excitation.plan_files(output, pitches, poses=poses > 0)
    check_outputs({**{f"--output ({file.name})": file for file in files}, "--figure": figure}, [leg, *(assess or [])])
    recordings = (
        read_logs(assess, LogOptions(column, degrees, start, stop, names=names, passive=passive, unmeasured=unmeasured))
        if assess
        else None
    )
    logged = recordings[0].joint_names if recordings else None
    found = find_leg(leg, side, inertias, split_names(joints), logged, floating_base=supports is not None)
    limits = excitation.MotionLimits.of(
        found,
        margin=math.radians(margin),
        angles_deg=_ranges(angles),
        velocity=parse_numbers(velocity, "--velocity"),
        acceleration=parse_numbers(acceleration, "--acceleration"),
        torque=parse_numbers(torque, "--torque"),
        clearance=_clearance(foot, ground, clearance),
    )
    stds = parse_numbers(noise, "--noise")
    if recordings is not None:
        if output is not None:
            raise ExoidError("-o has no effect with --assess", remedy="leave it out: nothing is planned")
        result: Assessment | Plan | StancePlan = excitation.assess(
            found, recordings, parse_terms(terms), noise=stds, noise_bandwidth=noise_bandwidth, limits=limits
        )
    elif supports is not None:
        given = {"friction": friction, "doubt": doubt}
        with progress_bar("searching") as progress:
            result = excitation.plan_stance(
                found,
                parse_terms(terms),
                feet=supports,
                soles=_soles(sole),
                ground=GroundLimits(**{name: value for name, value in given.items() if value is not None}),
                duration=duration,
                rate=rate,
                limits=limits,
                noise=stds,
                noise_bandwidth=noise_bandwidth,
                highest=highest,
                criterion=criterion,
                starts=starts or 2,
                seed=seed,
                progress=progress,
            )
    else:
        with progress_bar("searching") as progress:
            result = excitation.plan_excitation(
                found,
                parse_terms(terms),
                duration=duration,
                rate=rate,
                limits=limits,
                noise=stds,
                noise_bandwidth=noise_bandwidth,
                tilts_deg=parse_numbers(tilts, "--tilts") or (),
                poses=poses,
                highest=highest,
                criterion=criterion,
                starts=starts or 16,
                seed=seed,
                progress=progress,
            )
    _write(result, output, figure)
    typer.echo(json.dumps(_to_json(result), indent=1, ensure_ascii=False) if as_json else str(result))


def _write(result: Assessment | Plan | StancePlan, output: str | None, figure: str | None) -> None:
    """Write the requested files."""
    if output is not None and isinstance(result, Plan):
        for path in excitation.write_plan(output, result):
            note(f"wrote {path}")
    if output is not None and isinstance(result, StancePlan):
        for path in excitation.write_stance_plan(output, result):
            note(f"wrote {path}")
    if figure is not None:
        _draw(result, figure)
        note(f"wrote {figure}")


def _draw(result: Assessment | Plan | StancePlan, path: str) -> None:
    from matplotlib.figure import Figure  # noqa: PLC0415 - only a figure needs matplotlib

    with view.paper():
        sheet = Figure(figsize=FIGURE_INCHES)
        if isinstance(result, Plan):
            left, right = sheet.subfigures(1, 2, squeeze=False, width_ratios=(1.25, 1.0))[0]
            view.plot_planned_motion(left.subplots(3, 1, sharex=True), result)
            view.plot_precision(right.subplots(), result.precision)
        else:
            view.plot_precision(sheet.subplots(), result.precision)
        content = io.BytesIO()
        sheet.savefig(content, format=Path(path).suffix.lstrip(".") or "png")
    write_bytes(path, [content.getvalue()])


def _to_json(result: Assessment | Plan | StancePlan) -> dict[str, Any]:
    data = excitation.precision_to_json(result.precision) | {"noise": list(result.noise.std)}
    if isinstance(result, Assessment):
        return data | {"advice": [advice._asdict() for advice in result.advice]}
    if isinstance(result, StancePlan):
        margins = {one.name: margins for one, margins in zip(result.supports, result.margins, strict=True)}
        about = {"criterion": result.criterion, "seed": result.seed, "costs": list(result.costs)}
        return data | {"margins": margins, "missing": list(result.missing)} | about
    peaks = {name: values.tolist() for name, values in result.peaks._asdict().items()}
    return data | {"peaks": peaks, "criterion": result.criterion, "seed": result.seed, "costs": list(result.costs)}


def _ranges(texts: Sequence[str] | None) -> dict[str, tuple[float, float]]:
    """Turn "knee=-90:-5" into a range of degrees by joint."""
    ranges = {}
    for text in texts or ():
        joint, _, bounds = text.partition("=")
        low, _, high = bounds.partition(":")
        try:
            ranges[joint.strip()] = float(low), float(high)
        except ValueError:
            raise ExoidError(f"--angles {text}", remedy="write JOINT=LOW:HIGH in degrees, e.g. knee=-90:-5") from None
    return ranges


def _soles(texts: Sequence[str] | None) -> dict[str, Sole] | None:
    """Turn "left_foot=-0.07,0.13,-0.1" into a sole by link."""
    if not texts:
        return None
    soles = {}
    for text in texts:
        link, _, numbers = text.partition("=")
        sizes = parse_numbers(numbers, "--sole") or ()
        if len(sizes) != 3:
            raise ExoidError(f"--sole {text}", remedy="write FOOT=HEEL,TOE,HEIGHT in metres")
        soles[link.strip()] = Sole.flat(*sizes)
    return soles


def _clearance(foot: Sequence[str] | None, ground: float | None, distance: float) -> Clearance | None:
    if not foot:
        if ground is not None:
            raise ExoidError("--ground has no effect without --foot", remedy="name points, e.g. --foot 0.18,-0.09")
        return None
    points = [parse_numbers(point, "--foot") or () for point in foot]
    if any(len(point) != 2 for point in points):
        raise ExoidError(f"--foot {', '.join(foot)}", remedy="write X,Z in metres, e.g. --foot 0.18,-0.09")
    return Clearance(np.array(points), -math.inf if ground is None else -abs(ground), distance)
