"""``exoid study``: thousands of virtual identifications, and what they say of estimators and protocols."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any, Literal

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress, TaskID
from threadpoolctl import threadpool_limits

from exoid import study as studies
from exoid.control import ControlModel
from exoid.errors import ExoidError
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.experiments.excitation import MotionLimits, Plan, Scales, TorqueNoise, plan_excitation
from exoid.leg import Leg
from exoid.study import Protocol, TrackingTask
from exoid.torques import Term, TorqueModel

from .inputs import AsJson, find_leg, parse_numbers, parse_terms, refuse, split_names

PROTOCOLS = ("planned", "document")

SCALE, PERIOD = 0.8, 10.0
"""Of the gait that laws follow: factor of the amplitudes and seconds, as in ``exoid track``."""

OTHER = 1
"""Seed of a planned course; that of a planned protocol is 0."""

COLOURS = {"white": 0.0, "correlated": 1.0, "mixed": 0.8}
"""Share of the variance that has a memory."""


def study(
    leg: Annotated[str, typer.Argument(metavar="LEG", help="bleex, cuhk, a dataset's name, or a URDF file.")],
    folder: Annotated[
        str | None,
        typer.Option("--folder", "-o", metavar="DIR", help="Keep finished chunks there, and go on from them."),
    ] = None,
    side: Annotated[str | None, typer.Option(help="left or right, of a built-in leg.")] = None,
    inertias: Annotated[str | None, typer.Option(help="Inertia set of a built-in leg.")] = None,
    joints: Annotated[str | None, typer.Option(metavar="A,B", help="Moving joints of a URDF; default: all.")] = None,
    terms: Annotated[
        str | None, typer.Option(metavar="A,B", help="armature, coulomb, offset, stiffness, viscous; none for none.")
    ] = None,
    protocols: Annotated[str, typer.Option(metavar="A,B", help="planned, document.")] = "planned",
    colours: Annotated[str, typer.Option(metavar="A,B", help="Of the noise: white, correlated, mixed.")] = "mixed",
    estimators: Annotated[str, typer.Option(metavar="A,B", help="wls, huber, gls, ols.")] = "wls",
    noise: Annotated[
        str | None,
        typer.Option(metavar="N·M", help="Torque noise, one number or one a joint; default: 2 % of typical torques."),
    ] = None,
    memory: Annotated[float, typer.Option(metavar="S", help="Of noise that is not white.")] = 0.05,
    replicates: Annotated[int, typer.Option(min=2, help="Identifications of each combination.")] = 100,
    duration: Annotated[float, typer.Option(metavar="S", help="Of each protocol.")] = 60.0,
    rate: Annotated[float, typer.Option(metavar="HZ", help="Of the log.")] = 100.0,
    cutoff: Annotated[float, typer.Option(metavar="HZ", help="Of the zero-phase low-pass.")] = 8.0,
    followed: Annotated[Literal["exactly", "rig"], typer.Option(help="How motions are followed.")] = "exactly",
    laws: Annotated[
        str | None,
        typer.Option(
            metavar="A,B",
            help="Then drive the leg with them: pd, pd_gravity_friction, pd_feedforward, computed_torque, lqr.",
        ),
    ] = None,
    course: Annotated[
        Literal["gait", "planned"] | None, typer.Option(help="What laws follow: a stride of 10 s (default), or a plan.")
    ] = None,
    kp: Annotated[str | None, typer.Option(metavar="A,B", help="Of laws [N·m/rad]; default: as exoid track.")] = None,
    kd: Annotated[str | None, typer.Option(metavar="A,B", help="Of laws [N·m·s/rad]; default kp/10.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of everything.")] = 0,
    workers: Annotated[int, typer.Option(min=1, help="Processes on this machine.")] = 1,
    scheduler: Annotated[
        str | None, typer.Option(metavar="tcp://HOST:PORT", help="Of an existing Dask cluster, instead.")
    ] = None,
    parameters: Annotated[bool, typer.Option("--parameters", help="Print a line for each parameter, too.")] = False,
    as_json: AsJson = False,
) -> None:
    """Identify virtual legs again and again: bias, scatter, coverage of intervals, and efficiency.

    With --laws, also how well laws that know the estimates control the same leg.
    """
    found, chosen = find_leg(leg, side, inertias, split_names(joints), None), parse_terms(terms)
    model = TorqueModel(found, chosen)
    scales = Scales.of(model, MotionLimits.of(found))
    std = TorqueNoise.of(parse_numbers(noise, "--noise"), scales.typical_torque).std
    if laws is None:
        refuse({"--course": course, "--kp": kp, "--kd": kd}, "no --laws are tried")
    truth = studies.plausible_truth(model, scales.typical_torque)
    who = studies.run_serially if workers == 1 else studies.processes(workers)
    who = who if scheduler is None else studies.dask_cluster(scheduler)
    noises = tuple(studies.Noise(name, std, _share(name), memory) for name in split_names(colours) or ())
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        planning = {"noise": std, "duration": duration, "rate": rate}
        follow = None if laws is None else _course(laws, course or "gait", model, truth, (kp, kd), planning)
        what = studies.Study(
            leg=studies.LegText.of(found),
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
            course=follow,
        )
        told = partial(_tell, bar, bar.add_task("identifying", total=1.0))
        result = studies.run_study(what, folder, who, told)
    details = [str(combination) for combination in result.combinations] if parameters else []
    typer.echo(json.dumps(result.to_json(), indent=1) if as_json else "\n\n".join([str(result), *details]))


def _protocol(name: str, leg: Leg, terms: tuple[Term, ...], planning: Mapping[str, Any]) -> Protocol:
    """Make a protocol by its name."""
    if name == "planned":
        return studies.planned(_plan(leg, terms, planning))
    if name == "document":
        return studies.document(leg, planning["duration"])
    raise ExoidError(f"--protocols {name}", remedy=f"use some of {', '.join(PROTOCOLS)}")


def _course(
    laws: str,
    motion: str,
    model: TorqueModel,
    truth: tuple[float, ...],
    gains: tuple[str | None, str | None],
    planning: Mapping[str, Any],
) -> TrackingTask:
    """Make what laws follow, by its name: a gait as in ``exoid track``, or a plan that is not the protocol's."""
    kp, kd = (parse_numbers(text, option) for text, option in zip(gains, ("--kp", "--kd"), strict=True))
    names, known = split_names(laws) or (), ControlModel.of_parameters(model, np.array(truth))
    if motion == "gait":
        try:
            gait = gait_for_leg(model.leg, healthy_gait(SCALE, PERIOD))
        except ExoidError as error:
            raise ExoidError(error.what, where=error.where, remedy=f"{error.remedy}, or --course planned") from None
        return TrackingTask.of(names, gait, PERIOD, known, kp, kd)
    plan = _plan(model.leg, model.terms, {**planning, "duration": PERIOD, "seed": OTHER}).motions[0]
    return TrackingTask.of(names, plan.reference, plan.period, known, kp, kd)


def _plan(leg: Leg, terms: tuple[Term, ...], planning: Mapping[str, Any]) -> Plan:
    """Plan quickly, as a good motion is enough."""
    with threadpool_limits(limits=1):  # the same bits on any number of processors
        return plan_excitation(leg, terms, criterion="d", starts=2, **planning)


def _share(colour: str) -> float:
    """Share of the variance that is correlated, by the name of the noise."""
    if colour not in COLOURS:
        raise ExoidError(f"--colours {colour}", remedy=f"use some of {', '.join(COLOURS)}")
    return COLOURS[colour]


def _tell(bar: Progress, task: TaskID, share: float) -> None:
    bar.update(task, completed=share)
