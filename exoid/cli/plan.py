"""``exoid plan``: the motion to record, or the precision that a recording allows."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import typer

from exoid import view
from exoid.errors import ExoidError
from exoid.experiments import excitation
from exoid.experiments.excitation import Assessment, GroundLimits, MotionLimits, Plan, StancePlan
from exoid.experiments.excitation.clearance import Clearance
from exoid.experiments.excitation.plan_files import plan_files, write_plan
from exoid.experiments.excitation.stance.files import stance_files, write_stance_plan
from exoid.experiments.excitation.text import precision_to_json
from exoid.leg.leg import Leg
from exoid.rig.ground import Sole
from exoid.signals import Recording
from exoid.tools.files import write_bytes
from exoid.torques import Term

from .inputs import (
    ANY_LEG,
    READ_AS_IT_IS,
    AsJson,
    LegName,
    LegOptions,
    LogOptions,
    parse_numbers,
    parse_terms,
    read_logs,
    split_names,
)
from .legs import refuse_unknown_leg
from .messages import note
from .option_groups import expand_options
from .outputs import check_outputs
from .progress import progress_bar
from .refusals import refuse

FIGURE_INCHES = (7.2, 4.6)

Result = Assessment | Plan | StancePlan
"""Results of the verb."""


class SearchOptions(NamedTuple):
    """Length of a plan, noise and the search."""

    duration: Annotated[float, typer.Option(metavar="S", help="Duration of all motions together.")] = 60.0
    rate: Annotated[float, typer.Option(metavar="HZ", help="Rate of controller and log.")] = 100.0
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="N·M", help="Torque noise, one number or one for each joint; default: 2 % of typical torques."
        ),
    ] = None
    noise_bandwidth: Annotated[float, typer.Option(metavar="HZ", help="Bandwidth of the noise; default: white.")] = (
        math.inf
    )
    highest: Annotated[float, typer.Option(metavar="HZ", help="Highest frequency of the motion.")] = 1.0
    criterion: Annotated[Literal["worst", "a", "d"], typer.Option(help="Criterion to minimise.")] = "worst"
    starts: Annotated[
        int | None, typer.Option(min=1, help="Number of starts of the search; default: 16, with --stance 2.")
    ] = None
    seed: Annotated[int, typer.Option(min=0, help="Seed of the search.")] = 0

    def arguments(self, starts: int) -> dict[str, Any]:
        """Turn the options into arguments of a search."""
        noise = parse_numbers(self.noise, "--noise")
        return self._asdict() | {"noise": noise, "starts": self.starts or starts}


class LimitOptions(NamedTuple):
    """Limits of a motion."""

    angles: Annotated[
        list[str] | None, typer.Option(metavar="JOINT=LOW:HIGH", help="Narrower range [deg]. Repeatable.")
    ] = None
    margin: Annotated[float, typer.Option(metavar="DEG", help="Distance to the URDF's joint limits.")] = 3.0
    velocity: Annotated[str | None, typer.Option(metavar="RAD/S", help="Velocity limits below the URDF's.")] = None
    acceleration: Annotated[str | None, typer.Option(metavar="RAD/S²", help="Acceleration limits.")] = None
    torque: Annotated[str | None, typer.Option(metavar="N·M", help="Torque limits below the URDF's.")] = None
    ground: Annotated[
        float | None, typer.Option(metavar="M", help="Depth of the ground below the first joint; needs --foot.")
    ] = None
    foot: Annotated[
        list[str] | None,
        typer.Option(metavar="X,Z", help="Point of the foot, forward and up of the last joint [m]. Repeatable."),
    ] = None
    clearance: Annotated[float, typer.Option(metavar="M", help="Least distance of --foot from the ground.")] = 0.05

    def of(self, leg: Leg) -> MotionLimits:
        """Parse the limits."""
        return excitation.MotionLimits.of(
            leg,
            margin=math.radians(self.margin),
            angles_deg=_ranges(self.angles),
            velocity=parse_numbers(self.velocity, "--velocity"),
            acceleration=parse_numbers(self.acceleration, "--acceleration"),
            torque=parse_numbers(self.torque, "--torque"),
            clearance=_clearance(self.foot, self.ground, self.clearance),
        )


class TorsoOptions(NamedTuple):
    """Torso tilts and poses of a leg whose torso is held."""

    tilts: Annotated[str, typer.Option(metavar="DEG,DEG", help="Torso tilts of the motions.")] = "0"
    poses: Annotated[int, typer.Option(min=0, help="Number of additional static poses at each tilt.")] = 0

    @property
    def pitches(self) -> list[float]:
        """Tilts [rad]."""
        return [math.radians(tilt) for tilt in parse_numbers(self.tilts, "--tilts") or ()]


class StanceOptions(NamedTuple):
    """Options of motions on the ground."""

    stance: Annotated[
        str | None,
        typer.Option(metavar="both,left", help="Plan motions on these feet instead: squats, shifts, leg swings."),
    ] = None
    sole: Annotated[
        list[str] | None,
        typer.Option(metavar="FOOT=HEEL,TOE,HEIGHT", help="Sole in the axes of its link [m]; default: BLEEX's."),
    ] = None
    friction: Annotated[
        float | None, typer.Option(metavar="MU", help="Friction of the ground that --stance may use; default 0.4.")
    ] = None
    doubt: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Doubt about expected parameters in --stance; default 0.05.")
    ] = None

    @property
    def supports(self) -> tuple[str, ...] | None:
        """Feet to stand on; None for a leg whose torso is held."""
        return split_names(self.stance)

    def refuse_without_effect(self, assess: list[str] | None, limits: LimitOptions, torso: TorsoOptions) -> None:
        """Refuse options that motions on the ground do not have, or that only they have."""
        if self.stance is None:
            refuse({"--sole": self.sole, "--friction": self.friction, "--doubt": self.doubt}, "they are for --stance")
            return
        of_torso = {"--poses": torso.poses or None, "--tilts": None if torso.tilts == "0" else torso.tilts}
        swinging = {"--assess": assess, "--foot": limits.foot, "--ground": limits.ground, **of_torso}
        refuse(swinging, "--stance plans motions on the ground")


@expand_options()
def plan(
    leg: LegName,
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="PLAN.CSV", help="Write the motion (and poses).")
    ] = None,
    assess: Annotated[
        list[str] | None,
        typer.Option("--assess", metavar="LOG", help="Instead, assess this log. Repeatable."),
    ] = None,
    choice: LegOptions = ANY_LEG,
    terms: Annotated[
        str | None, typer.Option(metavar="A,B", help="armature, coulomb, offset, stiffness, viscous; none for none.")
    ] = None,
    search: SearchOptions = SearchOptions(),  # noqa: B008 - a tuple does not change
    limits: LimitOptions = LimitOptions(),  # noqa: B008
    torso: TorsoOptions = TorsoOptions(),  # noqa: B008
    stance: StanceOptions = StanceOptions(),  # noqa: B008
    figure: Annotated[str | None, typer.Option(metavar="PNG", help="Draw motion and precision.")] = None,
    reading: LogOptions = READ_AS_IT_IS,
    as_json: AsJson = False,
) -> None:
    """Find the motion that identifies LEG best, and predict the precision of its parameters; or --assess a log.

    Example: exoid plan cuhk -o plan.csv --duration 10 --starts 1
    """
    refuse_unknown_leg(leg)
    stance.refuse_without_effect(assess, limits, torso)
    files = (
        {} if output is None or assess else {f"--output ({file.name})": file for file in _files(output, torso, stance)}
    )
    check_outputs({**files, "--figure": figure}, [leg, *(assess or [])])
    recordings = _recordings(assess, output, reading)
    logged = recordings[0].joint_names if recordings else None
    found = choice.find(leg, logged, floating_base=stance.stance is not None)
    allowed = limits.of(found)
    if recordings:
        result: Result = excitation.assess(
            found,
            recordings,
            parse_terms(terms),
            noise=parse_numbers(search.noise, "--noise"),
            noise_bandwidth=search.noise_bandwidth,
            limits=allowed,
        )
    elif stance.supports is not None:
        result = _plan_stance(found, parse_terms(terms), search, allowed, stance)
    else:
        result = _plan_swing(found, parse_terms(terms), search, allowed, torso)
    _write(result, output, figure)
    typer.echo(json.dumps(_to_json(result), indent=1, ensure_ascii=False) if as_json else str(result))


def _files(output: str, torso: TorsoOptions, stance: StanceOptions) -> Sequence[Path]:
    """Files of a plan."""
    if stance.supports is not None:
        return stance_files(output, stance.supports)
    return plan_files(output, torso.pitches, poses=torso.poses > 0)


def _recordings(assess: list[str] | None, output: str | None, reading: LogOptions) -> list[Recording]:
    """Read the logs to assess, if any."""
    if not assess:
        refuse(reading.given(), "only the log of --assess is read")
        return []
    if output is not None:
        raise ExoidError("-o has no effect with --assess", remedy="leave it out: nothing is planned")
    reading.refuse_other(assess)
    return read_logs(assess, reading)


def _plan_stance(
    leg: Leg, terms: Sequence[Term], search: SearchOptions, limits: MotionLimits, stance: StanceOptions
) -> StancePlan:
    """Plan motions on the ground."""
    given = {"friction": stance.friction, "doubt": stance.doubt}
    ground = GroundLimits(**{name: value for name, value in given.items() if value is not None})
    feet, soles, arguments = stance.supports or (), _soles(stance.sole), search.arguments(starts=2)
    with progress_bar("searching") as progress:
        return excitation.plan_stance(
            leg, terms, feet=feet, soles=soles, ground=ground, limits=limits, progress=progress, **arguments
        )


def _plan_swing(
    leg: Leg, terms: Sequence[Term], search: SearchOptions, limits: MotionLimits, torso: TorsoOptions
) -> Plan:
    """Plan motions of a leg whose torso is held."""
    tilts, arguments = parse_numbers(torso.tilts, "--tilts") or (), search.arguments(starts=16)
    with progress_bar("searching") as progress:
        return excitation.plan_excitation(
            leg, terms, limits=limits, tilts_deg=tilts, poses=torso.poses, progress=progress, **arguments
        )


def _write(result: Result, output: str | None, figure: str | None) -> None:
    """Write the requested files."""
    if output is not None and isinstance(result, Plan):
        for path in write_plan(output, result):
            note(f"wrote {path}")
    if output is not None and isinstance(result, StancePlan):
        for path in write_stance_plan(output, result):
            note(f"wrote {path}")
    if figure is not None:
        _draw(result, figure)
        note(f"wrote {figure}")


def _draw(result: Result, path: str) -> None:
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
    data = precision_to_json(result.precision) | {"noise": list(result.noise.std)}
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
