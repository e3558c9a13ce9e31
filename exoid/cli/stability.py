"""``exoid stability``: what document 2 proves about its law, put to the test on a leg."""

from __future__ import annotations

import json
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress

from exoid import published, view
from exoid._typing import FloatArray
from exoid.catalog import load_leg
from exoid.control import ControlModel, Law, gravity_friction_pd
from exoid.control import stability as checks
from exoid.control.stability import GainMargins, Regulations
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.files import write_bytes
from exoid.rig import Plant

from .inputs import AsJson

KP, TARGET_DEG, AWAY_DEG = "22.1,55.6", "10,40", "25,-30"
"""For CUHK-EXO: the gains that reproduce document 2's tracking errors under PD control, and a regulation task."""

RATIO = 0.1
"""Of Kd to Kp [s]."""

ROTOR = 0.8
"""Reflected inertia of CUHK-EXO's motors, an assumption [kg·m²]."""

CERTAIN = 3.0
"""Standard deviations by which something is negative for certain."""


class _Task(NamedTuple):
    """Gains [N·m/rad, N·m·s/rad], target and start less target [rad], (n,) each."""

    kp: FloatArray
    kd: FloatArray
    target: FloatArray
    away: FloatArray


def stability(
    leg: Annotated[str, typer.Argument(metavar="LEG", help="cuhk, or what exoid identify -o wrote.")],
    kp: Annotated[str, typer.Option(metavar="A,B", help="Kp of each joint [N·m/rad].")] = KP,
    kd: Annotated[str | None, typer.Option(metavar="A,B", help="Kd [N·m·s/rad]; 0.1 Kp by default.")] = None,
    target: Annotated[str, typer.Option(metavar="A,B", help="Where to hold each joint [deg].")] = TARGET_DEG,
    away: Annotated[str, typer.Option(metavar="A,B", help="How far off each starts [deg].")] = AWAY_DEG,
    rotor: Annotated[
        float | None,
        typer.Option(metavar="I", help="Rotor inertia at cuhk's joints [kg·m²]; 0.8 by default."),
    ] = None,
    rate: Annotated[float, typer.Option(metavar="HZ", help="Of the law.")] = 100.0,
    duration: Annotated[float, typer.Option(metavar="S", help="Of each run.")] = 20.0,
    figure: Annotated[str | None, typer.Option(metavar="FILE.PNG", help="Draw V and the gain margins there.")] = None,
    as_json: AsJson = False,
) -> None:
    """Check Properties 1 to 3, regulate with friction compensated in part or too much, and find the gain margins."""
    plant = _plant(leg, rotor)
    task = _task(plant, kp, kd, target, away)
    if figure is not None and not Path(figure).parent.is_dir():  # before the seconds that the runs take
        raise ExoidError("no such folder", where=figure, remedy="write into an existing folder")
    properties = checks.check_properties(plant)
    with Progress(console=Console(stderr=True), transient=True) as bar:
        told = partial(_tell, bar, bar.add_task("regulating", total=1.0))
        runs = checks.regulate(plant, *task, rate=rate, duration=duration, progress=told)

    def law(scale: float, rate: float) -> Law:
        return gravity_friction_pd(plant, scale * task.kp, scale * task.kd, friction=None, rate=rate)

    margins = checks.gain_margins(plant, law, task.target)
    if figure is not None:
        _draw(figure, runs, margins)
        typer.echo(f"wrote {figure}", err=True)
    if as_json:
        data = {"regulation": runs.to_json(), "gain_margins": margins.to_json()}
        typer.echo(json.dumps({"properties": properties.to_json(), **data}, indent=1))
    else:
        typer.echo("\n\n".join(map(str, (properties, runs, margins))))


def _plant(name: str, rotor: float | None) -> Plant:
    """CUHK-EXO as assumed, or the leg that an estimate describes; neither has end stops."""
    if name == "cuhk":
        leg = load_leg("cuhk")
        rotors = {f"Ia_{label}": ROTOR if rotor is None else rotor for label in leg.joint_labels}
        return Plant.build(leg, {**published.cuhk_resistances(), **rotors}, end_stops=False)
    if not Path(name).is_file():
        raise ExoidError(f"no leg or estimate {name!r}", remedy="name cuhk, or a file that exoid identify -o wrote")
    if rotor is not None:
        raise ExoidError("--rotor has no effect on an estimate", remedy="leave out --rotor: rotors are identified")
    estimate = Estimate.load(name)
    for parameter, value, std in zip(estimate.names, estimate.values, estimate.std, strict=True):
        if value < 0.0 and parameter.startswith(("c0_", "d_", "Ia_")):
            _excuse(parameter, float(value), float(std), name)
    return ControlModel.of(estimate).plant(end_stops=False)


def _excuse(parameter: str, value: float, std: float, file: str) -> None:
    """Take what is negative by chance for zero, and say so; refuse what is negative for certain."""
    if value < -CERTAIN * std:
        raise ExoidError(
            f"{parameter} = {value:.3g} ± {std:.1g} is negative and would feed energy into the leg",
            where=file,
            remedy="check the sign of the torque, or identify without this term (--terms)",
        )
    typer.echo(f"{parameter} = {value:.2g} ± {std:.1g} is taken as zero", err=True)


def _task(plant: Plant, kp: str, kd: str | None, target: str, away: str) -> _Task:
    stiffness = _numbers("--kp", kp, plant)
    return _Task(
        stiffness,
        RATIO * stiffness if kd is None else _numbers("--kd", kd, plant),
        np.deg2rad(_numbers("--target", target, plant)),
        np.deg2rad(_numbers("--away", away, plant)),
    )


def _numbers(option: str, text: str, plant: Plant) -> FloatArray:
    try:
        values = np.array([float(part) for part in text.split(",")])
    except ValueError:
        values = np.array([])
    joints = plant.leg.joint_names
    if len(values) != len(joints) or not np.isfinite(values).all():
        raise ExoidError(f"{option} {text}", remedy=f"give one number for each of {', '.join(joints)}: A,B,…")
    return values


def _draw(path: str, runs: Regulations, margins: GainMargins) -> None:
    from matplotlib.figure import Figure  # noqa: PLC0415 - only a figure needs matplotlib

    with view.paper():
        drawing = Figure(figsize=(7.0, 5.0))
        axes = drawing.subplot_mosaic([["error", "error"], ["energy", "margins"]])
        view.plot_regulation_errors(axes["error"], runs.runs, 0, runs.runs[0].run.joint_names[0])
        view.plot_lyapunov(axes["energy"], [run.lyapunov for run in runs.runs], [run.name for run in runs.runs])
        view.plot_gain_margins(axes["margins"], margins)
        image = BytesIO()
        drawing.savefig(image, format="png")
    write_bytes(path, [image.getvalue()])


def _tell(bar: Progress, task: object, share: float) -> None:
    bar.update(task, completed=share)  # type: ignore[arg-type]
