"""``exoid track``: control laws on a leg, side by side."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress, TaskID

from exoid import control, experiments, published
from exoid._typing import FloatArray
from exoid.catalog import load_leg
from exoid.control import ControlModel
from exoid.control.tracking import tracking_table
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.files import refuse_unwritable
from exoid.leg import Leg
from exoid.rig import Payload, Plant, Reference
from exoid.signals import Recording
from exoid.tables import DataTable, to_text

from .inputs import AsJson, Report

HARMONICS = 6
"""Fitted to a reference from a log."""

SCALE = 0.8
"""Of the gait on other legs than document 2's: within the limits of both built-in ones."""

HANGS = 0.3
"""How far below its joint a payload hangs [m]."""


class Plan(NamedTuple):
    """What to run on a leg that is not document 2's; None for the default of each."""

    kp: str | None
    kd: str | None
    rate: float | None
    period: float | None
    scale: float | None
    speed: str | None
    reference: str | None
    payload: float | None
    friction: float | None


def track(
    what: Annotated[
        str, typer.Argument(metavar="EST.JSON|cuhk|bleex", help="An estimate, document 2's comparison, or BLEEX.")
    ],
    seed: Annotated[int, typer.Option(min=0, help="Of sensor noise; for cuhk of the whole experiment.")] = 0,
    rotor: Annotated[float | None, typer.Option(metavar="KGM2", help="cuhk: rotor inertia at each joint.")] = None,
    wrong: Annotated[bool, typer.Option("--wrong", help="cuhk: also laws that know the leg wrongly.")] = False,
    kp: Annotated[str | None, typer.Option(metavar="A,B", help="Stiffness of each joint [N·m/rad].")] = None,
    kd: Annotated[str | None, typer.Option(metavar="A,B", help="Damping [N·m·s/rad]; default kp/10.")] = None,
    rate: Annotated[float | None, typer.Option(metavar="HZ", help="Of all laws; default 100.")] = None,
    period: Annotated[float | None, typer.Option(metavar="S", help="Of the reference; default 10.")] = None,
    scale: Annotated[float | None, typer.Option(help="Of the gait's amplitudes; default 0.8.")] = None,
    speed: Annotated[str | None, typer.Option(help="Norm of VerySlow, Slow, Free or Fast gait.")] = None,
    reference: Annotated[str | None, typer.Option(metavar="LOG.CSV", help="Follow the angles of a log.")] = None,
    payload: Annotated[float | None, typer.Option(metavar="KG", help="On the rig's shank; no law knows.")] = None,
    friction: Annotated[float | None, typer.Option(metavar="X", help="Of the rig, over what laws know.")] = None,
    figures: Annotated[str | None, typer.Option(metavar="DIR", help="Write figures there.")] = None,
    form: Annotated[Literal["png", "pdf"], typer.Option("--format", help="Of the figures.")] = "png",
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Run control laws on a rig and compare: tracking error, torque, energy, chatter.

    cuhk replays document 2's comparison of controllers, on a leg identified from noisy data. For an estimate the rig is
    made of it, and the laws know it; --payload and --friction make the rig differ.
    """
    from exoid import reproduce  # noqa: PLC0415 - matplotlib would slow down the help
    from exoid.view.figure_files import make_folder, write_figures  # noqa: PLC0415

    plan = Plan(kp, kd, rate, period, scale, speed, reference, payload, friction)
    if figures is not None:
        make_folder(figures)
    if report is not None:
        refuse_unwritable(report)
    if what == "cuhk":
        _refuse(plan._asdict(), "it is document 2's comparison; name an estimate")
    else:
        _refuse({"rotor": rotor, "wrong": wrong or None}, "it belongs to cuhk")
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        told = partial(_tell, bar, bar.add_task(f"tracking {what}", total=1.0))
        if what == "cuhk":
            inertia = {} if rotor is None else {"rotor": rotor}
            replay = reproduce.reproduce_cuhk_tracking(seed, wrong=wrong, progress=told, **inertia)
            table, notes = reproduce.cuhk_tracking_table(replay), reproduce.cuhk_tracking_notes(replay)
            runs, text, data = replay.laws, reproduce.cuhk_tracking_text(replay), reproduce.cuhk_tracking_json(replay)
        else:
            runs, table, data = _track_leg(what, plan, seed, told)
            text, notes = to_text(table), ()
    if figures is not None:
        for path in write_figures(reproduce.tracking_figures(runs), figures, form):
            typer.echo(f"wrote {path}", err=True)
    if report is not None:
        reproduce.tracking_page(f"Control laws on {what}", table, notes, runs).write(report)
    typer.echo(json.dumps(data, indent=1) if as_json else text)


def _track_leg(
    what: str, plan: Plan, seed: int, told: Callable[[float], None]
) -> tuple[Mapping[str, Any], DataTable, dict[str, Any]]:
    """Run every law on a leg; return what they did, as a table and as JSON."""
    from exoid import reproduce  # noqa: PLC0415 - see above

    model = _model(what)
    reference, period = _reference(model.leg, plan)
    own_kp, own_kd = control.default_gains(model, control.mean_pose(reference, period))
    kp = own_kp if plan.kp is None else _numbers("--kp", plan.kp, model.n)
    kd = (own_kd if plan.kp is None else 0.1 * kp) if plan.kd is None else _numbers("--kd", plan.kd, model.n)
    joint = "knee" if "knee" in model.leg.joint_labels else model.leg.joint_labels[-1]
    loads = [] if plan.payload is None else [Payload(joint, plan.payload, _below(model.leg, joint))]
    runs = control.track(
        model,
        kp,
        kd,
        reference,
        period,
        rate=100.0 if plan.rate is None else plan.rate,
        friction=1.0 if plan.friction is None else plan.friction,
        payloads=loads,
        seed=seed,
        progress=told,
    )
    gains = ", ".join(f"{name} {p:.3g} / {d:.3g}" for name, p, d in zip(model.leg.joint_labels, kp, kd, strict=True))
    title = f"{model.leg.description.name}: reference of {period:g} s; Kp [N·m/rad] / Kd [N·m·s/rad]: {gains}"
    return runs, tracking_table(title, runs.values()), reproduce.laws_json(runs, kp, kd, seed)


def _model(what: str) -> ControlModel:
    if what == "bleex":
        return ControlModel.of(
            Plant.build(load_leg("bleex", inertias="identified"), published.bleex_resistances("left"))
        )
    if not Path(what).is_file():
        raise ExoidError(f"no estimate {what!r}", remedy="name a file of exoid identify -o, cuhk or bleex")
    return ControlModel.of(Estimate.load(what))


def _reference(leg: Leg, plan: Plan) -> tuple[Reference, float]:
    """Reference of one leg and its period [s]."""
    if plan.reference is not None:
        _refuse({"scale": plan.scale, "speed": plan.speed}, "the reference is that of a log")
        log = Recording.from_csv(plan.reference, leg.joint_names)
        period = log.duration + 1.0 / log.sample_rate if plan.period is None else plan.period
        return experiments.fit_harmonics(log.time - log.time[0], log.q, period, HARMONICS), period
    period = 10.0 if plan.period is None else plan.period
    if not 0.0 < period < np.inf:
        raise ExoidError(f"--period {period:g}", remedy="give seconds")
    scale = SCALE if plan.scale is None else plan.scale
    if plan.speed is None:
        return experiments.gait_for_leg(leg, experiments.healthy_gait(scale, period)), period
    return experiments.gait_for_leg(leg, experiments.norm_gait(plan.speed, scale, period)), period


def _below(leg: Leg, joint: str) -> tuple[float, float, float]:
    """Place a payload straight below a joint of the hanging leg, in the joint's frame [m]."""
    if leg.chain is None:
        raise ExoidError("--payload has no place", where=leg.description.name, remedy="it needs a planar leg")
    x, y, z = (-HANGS * leg.chain.rotations[leg.joint_labels.index(joint)].T @ leg.chain.plane.up).tolist()
    return x, y, z


def _numbers(option: str, text: str, count: int) -> FloatArray:
    try:
        numbers = np.array([float(part) for part in text.split(",")])
    except ValueError:
        numbers = np.zeros(0)
    if len(numbers) not in (1, count):
        raise ExoidError(f"{option} {text}", remedy=f"give {count} numbers with commas between them, or one")
    return np.broadcast_to(numbers, (count,)).copy()


def _refuse(options: Mapping[str, object], why: str) -> None:
    for option, value in options.items():
        if value is not None:
            raise ExoidError(f"--{option} has no effect: {why}", remedy=f"leave out --{option}")


def _tell(bar: Progress, task: TaskID, share: float) -> None:
    bar.update(task, completed=share)
