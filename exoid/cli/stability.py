"""``exoid stability``: where a leg comes to rest under PD control with friction compensation, and its gain margins."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from typer import Argument, Option

import exoid
from exoid.errors import BadArgumentError

from .messages import note
from .numbers import joint_values
from .options import AsJson, Number, Text
from .outputs import check_outputs, print_result, save_figure
from .progress import progress_bar
from .refusals import is_readable, refuse

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from exoid.control import Law
    from exoid.lab.stability.gain_margin import GainMargins
    from exoid.lab.stability.regulation import Regulations
    from exoid.rig import Plant


def stability(
    leg: Annotated[str, Argument(metavar="LEG", help="cuhk, or an estimate of exoid identify -o.")],
    kp: Annotated[str, Option(metavar="A,B", help="Kp of each joint [N·m/rad].")] = "22.1,55.6",
    kd: Annotated[Text, Option(metavar="A,B", help="Kd [N·m·s/rad]; 0.1 Kp by default.")] = None,
    target: Annotated[str, Option(metavar="A,B", help="Target angle of each joint [deg].")] = "10,40",
    away: Annotated[str, Option(metavar="A,B", help="Start minus target of each joint [deg].")] = "25,-30",
    rotor: Annotated[Number, Option(metavar="KGM2", help="Rotor inertia at cuhk's joints; default 0.8.")] = None,
    rate: Annotated[float, Option(metavar="HZ", help="Sampling rate of the controller.")] = 100.0,
    duration: Annotated[float, Option(metavar="S", help="Duration of each run.")] = 20.0,
    figure: Annotated[Text, Option(metavar="PNG", help="Draw errors and gain margins.")] = None,
    as_json: AsJson = False,
) -> None:
    """Regulate with partial and excessive friction compensation, and find the gain margins.

    Example: exoid stability cuhk --duration 5
    """
    # The default gains of CUHK-EXO reproduce document 2's tracking errors under PD control.
    import numpy as np  # noqa: PLC0415 - help needs no arrays

    from exoid.lab import stability as checks  # noqa: PLC0415

    check_outputs({"--figure": figure}, [leg])
    plant = _plant(leg, rotor)
    joints = plant.leg.joint_names
    stiffness = joint_values(kp, "--kp", joints)
    damping = 0.1 * stiffness if kd is None else joint_values(kd, "--kd", joints)
    aim, start = (np.deg2rad(joint_values(*each, joints)) for each in ((target, "--target"), (away, "--away")))
    with progress_bar("regulating") as progress:
        runs = checks.regulate(plant, stiffness, damping, aim, start, rate=rate, duration=duration, progress=progress)

    def law(scale: float, rate: float) -> Law:
        """Make the controller with scaled gains, at a rate [Hz]."""
        return exoid.control.gravity_friction_pd(plant, scale * stiffness, scale * damping, friction=None, rate=rate)

    margins = checks.gain_margins(plant, law, aim)
    if figure is not None:
        save_figure(figure, _draw(runs, margins))
    results: dict[str, Any] = {"regulation": runs, "gain_margins": margins}
    data = {name: each.to_json() for name, each in results.items()}
    print_result("\n\n".join(map(str, results.values())), as_json=as_json, data=data)


def _plant(name: str, rotor: float | None) -> Plant:
    """Make the plant of CUHK-EXO with rotors of 0.8 kg·m² (an assumption), or of an estimate, without end stops."""
    if name == "cuhk":
        leg = exoid.load_leg("cuhk")
        rotors = {f"Ia_{label}": 0.8 if rotor is None else rotor for label in leg.joint_labels}
        return exoid.rig.Plant.build(leg, {**exoid.published.cuhk_resistances(), **rotors}, end_stops=False)
    if not is_readable(name):
        raise BadArgumentError(f"no leg or estimate {name!r}", remedy="name cuhk, or an estimate of exoid identify -o")
    refuse({"--rotor": rotor}, "the estimate has rotors")
    estimate = exoid.Estimate.load(name)
    for parameter, value, std in zip(estimate.names, estimate.values, estimate.std, strict=True):
        if value >= 0.0 or not parameter.startswith(("c0_", "d_", "Ia_")):
            continue
        if value < -3.0 * std:  # significantly negative, not zero with noise
            raise BadArgumentError(
                f"{parameter} = {value:.3g} ± {std:.1g} is negative and would feed energy into the leg",
                where=name,
                remedy="check the sign of the torque, or identify without this term (--terms)",
                parameters=(parameter,),
            )
        note(f"{parameter} = {value:.2g} ± {std:.1g} is taken as zero")
    return exoid.control.ControlModel.of(estimate).plant(end_stops=False)


def _draw(runs: Regulations, margins: GainMargins) -> Figure:
    from matplotlib.figure import Figure  # noqa: PLC0415 - only a figure needs matplotlib

    from exoid.lab import stability as checks  # noqa: PLC0415

    with exoid.view.paper():
        drawing = Figure(figsize=(7.0, 2.5))
        axes = drawing.subplot_mosaic([["error", "margins"]])
        checks.plot_regulation_errors(axes["error"], runs.runs, 0, runs.runs[0].run.joint_names[0])
        checks.plot_gain_margins(axes["margins"], margins)
    return drawing
