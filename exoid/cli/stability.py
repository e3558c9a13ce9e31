"""``exoid stability``: test of document 2's stability proof on a leg."""

from __future__ import annotations

import json
from io import BytesIO
from typing import Annotated, NamedTuple

import numpy as np
import typer

from exoid import view
from exoid._typing import FloatArray
from exoid.control import ControlModel, Law, gravity_friction_pd
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.lab import stability as checks
from exoid.lab.stability import GainMargins, Regulations
from exoid.leg import published
from exoid.leg.catalog import load_leg
from exoid.rig import Plant
from exoid.tools.files import write_bytes

from .inputs import AsJson
from .messages import note
from .numbers import joint_values
from .outputs import check_outputs
from .progress import progress_bar
from .refusals import is_readable, refuse

KP, TARGET_DEG, AWAY_DEG = "22.1,55.6", "10,40", "25,-30"
"""Gains of CUHK-EXO that reproduce document 2's tracking errors under PD control, and a regulation task."""

RATIO = 0.1
"""Ratio of Kd to Kp [s]."""

ROTOR = 0.8
"""Reflected inertia of CUHK-EXO's motors, an assumption [kg·m²]."""

CERTAIN = 3.0
"""Number of standard deviations below zero at which a parameter counts as negative."""


class _Task(NamedTuple):
    """Gains [N·m/rad, N·m·s/rad], target and start minus target [rad], (n,) each."""

    kp: FloatArray
    kd: FloatArray
    target: FloatArray
    away: FloatArray


def stability(
    leg: Annotated[str, typer.Argument(metavar="LEG", help="cuhk, or an estimate of exoid identify -o.")],
    kp: Annotated[str, typer.Option(metavar="A,B", help="Kp of each joint [N·m/rad].")] = KP,
    kd: Annotated[str | None, typer.Option(metavar="A,B", help="Kd [N·m·s/rad]; 0.1 Kp by default.")] = None,
    target: Annotated[str, typer.Option(metavar="A,B", help="Target angle of each joint [deg].")] = TARGET_DEG,
    away: Annotated[str, typer.Option(metavar="A,B", help="Start minus target of each joint [deg].")] = AWAY_DEG,
    rotor: Annotated[
        float | None,
        typer.Option(metavar="I", help="Rotor inertia at cuhk's joints [kg·m²]; 0.8 by default."),
    ] = None,
    rate: Annotated[float, typer.Option(metavar="HZ", help="Sampling rate of the controller.")] = 100.0,
    duration: Annotated[float, typer.Option(metavar="S", help="Duration of each run.")] = 20.0,
    figure: Annotated[str | None, typer.Option(metavar="FILE.PNG", help="Draw V and the gain margins.")] = None,
    as_json: AsJson = False,
) -> None:
    """Check Properties 1 to 3, regulate with partial and excessive friction compensation, and find the gain margins.

    Example: exoid stability cuhk --duration 5
    """
    check_outputs({"--figure": figure}, [leg])
    plant = _plant(leg, rotor)
    task = _task(plant, kp, kd, target, away)
    properties = checks.check_properties(plant)
    with progress_bar("regulating") as progress:
        runs = checks.regulate(plant, *task, rate=rate, duration=duration, progress=progress)

    def law(scale: float, rate: float) -> Law:
        """Make the controller with scaled gains, at a rate [Hz]."""
        return gravity_friction_pd(plant, scale * task.kp, scale * task.kd, friction=None, rate=rate)

    margins = checks.gain_margins(plant, law, task.target)
    if figure is not None:
        _draw(figure, runs, margins)
        note(f"wrote {figure}")
    if as_json:
        data = {"regulation": runs.to_json(), "gain_margins": margins.to_json()}
        typer.echo(json.dumps({"properties": properties.to_json(), **data}, indent=1))
    else:
        typer.echo("\n\n".join(map(str, (properties, runs, margins))))


def _plant(name: str, rotor: float | None) -> Plant:
    """Make the plant of CUHK-EXO with the assumed rotors, or of an estimate, without end stops."""
    if name == "cuhk":
        leg = load_leg("cuhk")
        rotors = {f"Ia_{label}": ROTOR if rotor is None else rotor for label in leg.joint_labels}
        return Plant.build(leg, {**published.cuhk_resistances(), **rotors}, end_stops=False)
    if not is_readable(name):
        raise ExoidError(f"no leg or estimate {name!r}", remedy="name cuhk, or an estimate of exoid identify -o")
    refuse({"--rotor": rotor}, "the estimate has rotors")
    estimate = Estimate.load(name)
    for parameter, value, std in zip(estimate.names, estimate.values, estimate.std, strict=True):
        if value < 0.0 and parameter.startswith(("c0_", "d_", "Ia_")):
            _take_as_zero(parameter, float(value), float(std), name)
    return ControlModel.of(estimate).plant(end_stops=False)


def _take_as_zero(parameter: str, value: float, std: float, file: str) -> None:
    """Report that a slightly negative parameter is taken as zero; refuse one that is significantly negative."""
    if value < -CERTAIN * std:
        raise ExoidError(
            f"{parameter} = {value:.3g} ± {std:.1g} is negative and would feed energy into the leg",
            where=file,
            remedy="check the sign of the torque, or identify without this term (--terms)",
        )
    note(f"{parameter} = {value:.2g} ± {std:.1g} is taken as zero")


def _task(plant: Plant, kp: str, kd: str | None, target: str, away: str) -> _Task:
    joints = plant.leg.joint_names
    stiffness = joint_values(kp, "--kp", joints)
    return _Task(
        stiffness,
        RATIO * stiffness if kd is None else joint_values(kd, "--kd", joints),
        np.deg2rad(joint_values(target, "--target", joints)),
        np.deg2rad(joint_values(away, "--away", joints)),
    )


def _draw(path: str, runs: Regulations, margins: GainMargins) -> None:
    from matplotlib.figure import Figure  # noqa: PLC0415 - only a figure needs matplotlib

    with view.paper():
        drawing = Figure(figsize=(7.0, 5.0))
        axes = drawing.subplot_mosaic([["error", "error"], ["energy", "margins"]])
        checks.plot_regulation_errors(axes["error"], runs.runs, 0, runs.runs[0].run.joint_names[0])
        checks.plot_lyapunov(axes["energy"], [run.lyapunov for run in runs.runs], [run.name for run in runs.runs])
        checks.plot_gain_margins(axes["margins"], margins)
        image = BytesIO()
        drawing.savefig(image, format="png")
    write_bytes(path, [image.getvalue()])
