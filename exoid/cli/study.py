"""``exoid study``: thousands of virtual identifications, to compare estimators and protocols."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from typer import Option

import exoid
from exoid.errors import BadArgumentError
from exoid.tools.files import make_folder

from .inputs import given_terms
from .legs import find_leg
from .numbers import parse_numbers, split_names
from .option_groups import expand_options
from .options import ANY_LEG, FIXED_BASE, AsJson, LegName, LegOptions, TermNames, Text
from .options import TorqueNoise as NoiseLevel
from .outputs import print_result
from .progress import progress_bar

if TYPE_CHECKING:
    from exoid.experiments.excitation import Plan
    from exoid.lab.study import Protocol
    from exoid.leg.leg import Leg
    from exoid.torques import Term

COLOURS = {"white": 0.0, "correlated": 1.0, "mixed": 0.8}
"""Correlated share of the variance."""


@expand_options(without={"choice": (*FIXED_BASE["choice"], "loops")})
def study(
    leg: LegName,
    folder: Annotated[Text, Option("--folder", "-o", metavar="DIR", help="Keep finished chunks, and resume.")] = None,
    choice: LegOptions = ANY_LEG,
    terms: TermNames = None,
    protocols: Annotated[str, Option(metavar="A,B", help="Motions: planned, document.")] = "planned",
    colours: Annotated[str, Option(metavar="A,B", help="Noise: white, correlated, mixed.")] = "mixed",
    estimators: Annotated[str, Option(metavar="A,B", help="wls, huber, ols.")] = "wls",
    noise: NoiseLevel = None,
    memory: Annotated[float, Option(metavar="S", help="Correlation time of correlated noise.")] = 0.05,
    replicates: Annotated[int, Option(min=2, help="Identifications of each combination.")] = 100,
    duration: Annotated[float, Option(metavar="S", help="Duration of each protocol.")] = 60.0,
    rate: Annotated[float, Option(metavar="HZ", help="Rate of the log.")] = 100.0,
    cutoff: Annotated[float, Option(metavar="HZ", help="Cut-off of the zero-phase low-pass.")] = 8.0,
    followed: Annotated[Literal["exactly", "rig"], Option(help="How motions are followed.")] = "exactly",
    seed: Annotated[int, Option(min=0, help="Seed of all random numbers.")] = 0,
    workers: Annotated[int, Option(min=1, help="Processes on this machine.")] = 1,
    parameters: Annotated[bool, Option("--parameters", help="Print a line for each parameter, too.")] = False,
    as_json: AsJson = False,
) -> None:
    """Identify many virtual legs: bias, standard deviation, coverage of intervals, and efficiency.

    Example: exoid study cuhk --replicates 10 --protocols document --duration 10
    """
    from exoid.experiments.excitation.scales import Scales, TorqueNoise  # noqa: PLC0415 - help needs no plans

    if folder is not None:
        make_folder(folder)  # before the minute that planning takes
    found, chosen = find_leg(leg, choice, None), given_terms(terms)
    chosen = exoid.torques.DEFAULT_TERMS if chosen is None else chosen
    model = exoid.torques.TorqueModel(found, chosen)
    scales = Scales.of(model, exoid.experiments.excitation.MotionLimits.of(found))
    std = TorqueNoise.of(parse_numbers(noise, "--noise"), scales.typical_torque).std
    truth = exoid.study.plausible_truth(model, scales.typical_torque)
    noises = tuple(exoid.study.Noise(name, std, _share(name), memory) for name in split_names(colours) or ())
    planning = {"noise": std, "duration": duration, "rate": rate}
    design = exoid.study.Study(
        leg=exoid.study.LegText.of(found),
        terms=chosen,
        truth=truth,
        protocols=tuple(_protocol(name, found, chosen, planning) for name in split_names(protocols) or ()),
        noises=noises,
        estimators=split_names(estimators) or (),
        replicates=replicates,
        seed=seed,
        rate=rate,
        cutoff=cutoff,
        followed="exactly" if followed == "exactly" else "by a rig",
    )
    with progress_bar("identifying") as progress:
        result = exoid.study.run_study(design, folder, None if workers == 1 else workers, progress)
    details = [str(combination) for combination in result.combinations] if parameters else []
    print_result("\n\n".join([str(result), *details]), as_json=as_json, data=result.to_json())


def _protocol(name: str, leg: Leg, terms: tuple[Term, ...], planning: Mapping[str, Any]) -> Protocol:
    """Make a protocol by its name."""
    if name == "planned":
        return exoid.study.planned(_plan(leg, terms, planning))
    if name == "document":
        return exoid.study.document(leg, planning["duration"])
    raise BadArgumentError(f"--protocols {name}", remedy="use some of planned, document")


def _plan(leg: Leg, terms: tuple[Term, ...], planning: Mapping[str, Any]) -> Plan:
    """Plan with few starts, because a good motion is enough."""
    from threadpoolctl import threadpool_limits  # noqa: PLC0415 - help needs no plans

    with threadpool_limits(limits=1):  # the same bits on any number of processors
        return exoid.experiments.excitation.plan_excitation(leg, terms, criterion="d", starts=2, **planning)


def _share(colour: str) -> float:
    """Find the correlated share of the variance by the name of the noise."""
    if colour not in COLOURS:
        raise BadArgumentError(f"--colours {colour}", remedy=f"use some of {', '.join(COLOURS)}")
    return COLOURS[colour]
