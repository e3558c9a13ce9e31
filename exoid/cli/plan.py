"""``exoid plan``: the motion to record, or the precision that a recording allows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

from typer import Option

import exoid
from exoid.errors import BadArgumentError

from .inputs import given_terms, read_logs
from .legs import find_leg, refuse_unknown_leg
from .messages import note, progress_bar
from .numbers import parse_numbers, split_names, values_by_name
from .option_groups import expand_options
from .options import (
    ANY_LEG,
    READ_AS_IT_IS,
    AsJson,
    Figures,
    LegName,
    LegOptions,
    LogOptions,
    TermNames,
    Text,
    Texts,
    TorqueNoise,
    given,
)
from .outputs import check_outputs, print_result, save_figures
from .refusals import refuse

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from exoid.experiments.excitation import Assessment, MotionLimits, Plan, StancePlan
    from exoid.leg.leg import Leg
    from exoid.rig.ground import Sole


class SearchOptions(NamedTuple):
    """Length of a plan, noise and the search."""

    duration: Annotated[float, Option(metavar="S", help="Duration of all motions together.")] = 60.0
    rate: Annotated[float, Option(metavar="HZ", help="Rate of controller and log.")] = 100.0
    noise: TorqueNoise = None
    noise_bandwidth: Annotated[
        float, Option(metavar="HZ", help="Bandwidth of the torque noise; default: white.", rich_help_panel="log")
    ] = math.inf
    highest: Annotated[float, Option(metavar="HZ", help="Highest frequency of the motion.")] = 1.0
    criterion: Annotated[Literal["worst", "d"], Option(help="Criterion to minimise.")] = "worst"
    starts: Annotated[int, Option(min=1, help="Starts of the search.")] = 16
    seed: Annotated[int, Option(min=0, help="Seed of the search.")] = 0

    def arguments(self) -> dict[str, Any]:
        """Turn the options into arguments of a search."""
        return self._asdict() | {"noise": parse_numbers(self.noise, "--noise")}


SEARCHED = ("--highest", "--criterion", "--starts", "--seed")
"""Options of the search, which a plan on the ground does not have."""


class LimitOptions(NamedTuple):
    """Limiting the motion."""

    angles: Annotated[
        Texts, Option(metavar="JOINT=LOW:HIGH", help="Narrower range [deg; mm of a slide]. Repeatable.")
    ] = None
    margin: Annotated[float, Option(metavar="DEG", help="Distance to the URDF's joint limits.")] = 3.0
    velocity: Annotated[Text, Option(metavar="RAD/S", help="Velocity limits below the URDF's.")] = None
    acceleration: Annotated[Text, Option(metavar="RAD/S²", help="Acceleration limits.")] = None
    torque: Annotated[Text, Option(metavar="N·M", help="Torque limits below the URDF's.")] = None

    def of(self, leg: Leg) -> MotionLimits:
        """Parse the limits."""
        example = "JOINT=LOW:HIGH in degrees, e.g. knee=-90:-5"
        return exoid.experiments.excitation.MotionLimits.of(
            leg,
            margin=math.radians(self.margin),
            angles_deg=values_by_name(self.angles, "--angles", _range, example),
            velocity=parse_numbers(self.velocity, "--velocity"),
            acceleration=parse_numbers(self.acceleration, "--acceleration"),
            torque=parse_numbers(self.torque, "--torque"),
        )


class StanceOptions(NamedTuple):
    """Options of motions on the ground."""

    stance: Annotated[Text, Option(metavar="both,left", help="Plan squats, shifts and swings on these feet.")] = None
    supports: Annotated[Text, Option(metavar="A+B,C,air", help="Say what can be known on these links.")] = None
    sole: Annotated[Texts, Option(metavar="FOOT=HEEL,TOE,HEIGHT", help="Sole in its link [m].")] = None
    friction: Annotated[float, Option(metavar="MU", help="--stance: friction of the ground that is used.")] = 0.4


@expand_options(without={"choice": ("moving_base",)})
def plan(
    leg: LegName,
    output: Annotated[Text, Option("--output", "-o", metavar="PLAN.CSV", help="Write the motion.")] = None,
    assess: Annotated[Texts, Option(metavar="LOG", help="Instead, assess this log. Repeatable.")] = None,
    choice: LegOptions = ANY_LEG,
    terms: TermNames = None,
    search: SearchOptions = SearchOptions(),  # noqa: B008 - a tuple does not change
    limits: LimitOptions = LimitOptions(),  # noqa: B008
    tilts: Annotated[Text, Option(metavar="DEG,DEG", help="Torso tilts of the motions; default: upright.")] = None,
    stance: StanceOptions = StanceOptions(),  # noqa: B008
    figures: Figures = None,
    reading: LogOptions = READ_AS_IT_IS,
    as_json: AsJson = False,
) -> None:
    """Find the motion that identifies LEG best, and predict the precision of its parameters; or --assess a log.

    Example: exoid plan cuhk -o plan.csv --duration 10 --starts 1
    """
    from exoid.experiments import excitation  # noqa: PLC0415 - help needs no arrays

    refuse_unknown_leg(leg)
    if stance.supports is not None:
        others = {"-o": output, "--assess": assess, "--tilts": tilts, "--figures": figures}
        refuse({**others, **given(stance._replace(supports=None))}, "--supports plans nothing")
        sets = [[] if each == "air" else each.split("+") for each in split_names(stance.supports) or ()]
        seen = excitation.determined_on(find_leg(leg, choice, None), sets, given_terms(terms) or ())
        print_result(seen, as_json=as_json)
        return
    if stance.stance is None:
        refuse(given(stance), "they are for --stance")
        floats = None if assess else choice.floating_base or None
        refuse({"--floating-base": floats}, "motions on the ground are planned with --stance")
    else:
        choice = choice._replace(floating_base=True)
        searched = {name: value for name, value in given(search).items() if name in SEARCHED}
        refuse({"--assess": assess, "--tilts": tilts, **searched}, "--stance plans fixed motions on the ground")
    if assess:
        refuse({"-o": output}, "--assess plans nothing")
    else:
        refuse(given(reading), "only the log of --assess is read")
    torso_tilts = parse_numbers(tilts, "--tilts") or (0.0,)
    labels = split_names(stance.stance) or [f"tilt{tilt:+g}" for tilt in torso_tilts]
    files = {f"--output ({file.name})": file for file in (_files(output, labels) if output else ())}
    check_outputs(files, [leg, *(assess or [])], figures)
    recordings = read_logs(assess or (), reading)
    logged = recordings[0].joint_names if recordings else None
    found = find_leg(leg, choice, logged)
    allowed, chosen = limits.of(found), given_terms(terms)
    result: Assessment | Plan | StancePlan
    if recordings:
        noise, width = parse_numbers(search.noise, "--noise"), search.noise_bandwidth
        result = excitation.assess(found, recordings, chosen, noise=noise, noise_bandwidth=width, limits=allowed)
    elif stance.stance is not None:
        result = excitation.plan_stance(found, chosen, limits=allowed, **_stance_arguments(stance, search))
    else:
        with progress_bar("searching") as progress:
            how = {"tilts_deg": torso_tilts, **search.arguments()}
            result = excitation.plan_excitation(found, chosen, limits=allowed, progress=progress, **how)
    if output is not None and not isinstance(result, excitation.Assessment):
        for path, recording in zip(files.values(), result.recordings, strict=True):
            recording.to_csv(path)
            note(f"wrote {path}")
    if figures is not None:
        save_figures(figures, _draw(result))
    print_result(result, as_json=as_json, data=_to_json(result))


def _files(output: str, labels: Sequence[str]) -> list[Path]:
    """Name the file of each motion."""
    path = Path(output)
    if path.suffix != ".csv":
        raise BadArgumentError("a plan in no table", file=output, remedy="name the file .csv")
    if len(set(labels)) < len(labels):
        raise BadArgumentError(f"motions {', '.join(labels)}, of which two are one", remedy="give each once")
    return [path.with_name(f"{path.stem}_{label}.csv") if len(labels) > 1 else path for label in labels]


def _stance_arguments(stance: StanceOptions, search: SearchOptions) -> dict[str, Any]:
    """Arguments of a plan on the ground."""
    soles = values_by_name(stance.sole, "--sole", _sole, "FOOT=HEEL,TOE,HEIGHT in metres")
    arguments = {name: value for name, value in search.arguments().items() if f"--{name}" not in SEARCHED}
    return arguments | {"feet": split_names(stance.stance), "soles": soles or None, "friction": stance.friction}


def _sole(text: str) -> Sole:
    """Turn "-0.07,0.13,-0.1" into a sole."""
    heel, toe, height = map(float, text.split(","))
    return exoid.rig.ground.Sole.flat(heel, toe, height)


def _range(text: str) -> tuple[float, float]:
    """Turn "-90:-5" into a range [deg]."""
    low, _, high = text.partition(":")
    return float(low), float(high)


def _draw(result: Assessment | Plan | StancePlan) -> dict[str, Figure]:
    """Draw the predicted precision, and the motion of a plan."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - only a figure needs matplotlib

    from exoid.experiments.excitation import Plan  # noqa: PLC0415
    from exoid.view.plans import plot_planned_motion, plot_precision  # noqa: PLC0415

    with exoid.view.paper():
        drawn = {"precision": Figure(figsize=(3.5, max(4.6, 0.6 + 0.14 * len(result.precision.names))))}
        plot_precision(drawn["precision"].subplots(), result.precision)
        if isinstance(result, Plan):
            drawn["motion"] = Figure(figsize=(3.5, 4.6))
            plot_planned_motion(drawn["motion"].subplots(3, 1, sharex=True), result)
    return drawn


def _to_json(result: Assessment | Plan | StancePlan) -> dict[str, Any]:
    from exoid.experiments.excitation import Assessment, StancePlan  # noqa: PLC0415
    from exoid.experiments.excitation.text import precision_to_json  # noqa: PLC0415
    from exoid.tools.json_values import attributes, json_value  # noqa: PLC0415

    data = precision_to_json(result.precision) | {"noise": list(result.noise.std)}
    if isinstance(result, Assessment):
        return data | {"advice": [advice._asdict() for advice in result.advice]}
    if isinstance(result, StancePlan):
        margins = {label: motion.margins for label, motion in zip(result.labels, result.motions, strict=True)}
        return data | {"margins": margins}
    return data | {"peaks": json_value(result.peaks)} | attributes(result, "criterion", "seed")
