"""``exoid stability``: how far the gains of PD control may be raised, by rate and delay."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

import exoid
from exoid.errors import BadArgumentError

from .messages import note
from .numbers import joint_values
from .options import AsJson, Number, Text
from .outputs import check_outputs, print_result, save_figure
from .refusals import is_readable, refuse

if TYPE_CHECKING:
    from exoid.control import Law
    from exoid.rig import Plant


def stability(
    leg: Annotated[str, Argument(metavar="LEG", help="cuhk, or an estimate of exoid identify -o.")],
    kp: Annotated[str, Option(metavar="A,B", help="Kp of each joint [N·m/rad].")] = "22.1,55.6",
    kd: Annotated[Text, Option(metavar="A,B", help="Kd [N·m·s/rad]; 0.1 Kp by default.")] = None,
    target: Annotated[str, Option(metavar="A,B", help="Target angle of each joint [deg].")] = "10,40",
    rotor: Annotated[Number, Option(metavar="KGM2", help="Rotor inertia at cuhk's joints; default 0.8.")] = None,
    figure: Annotated[Text, Option(metavar="PNG", help="Draw the gain margins.")] = None,
    as_json: AsJson = False,
) -> None:
    """Find how far the gains of PD control with gravity compensation may be raised, by rate and delay.

    Example: exoid stability cuhk
    """
    # The default gains of CUHK-EXO reproduce document 2's tracking errors under PD control.
    import numpy as np  # noqa: PLC0415 - help needs no arrays

    from exoid.lab.stability import gain_margins, plot_gain_margins  # noqa: PLC0415

    check_outputs({"--figure": figure}, [leg])
    plant = _plant(leg, rotor)
    joints = plant.leg.joint_names
    stiffness = joint_values(kp, "--kp", joints)
    damping = 0.1 * stiffness if kd is None else joint_values(kd, "--kd", joints)

    def law(scale: float, rate: float) -> Law:
        """Make the controller with scaled gains, at a rate [Hz]."""
        return exoid.control.gravity_friction_pd(plant, scale * stiffness, scale * damping, friction=None, rate=rate)

    margins = gain_margins(plant, law, np.deg2rad(joint_values(target, "--target", joints)))
    if figure is not None:
        from matplotlib.figure import Figure  # noqa: PLC0415 - only a figure needs matplotlib

        with exoid.view.paper():
            drawing = Figure(figsize=(3.5, 2.5))
            plot_gain_margins(drawing.subplots(), margins)
        save_figure(figure, drawing)
    print_result(margins, as_json=as_json, data={"gain_margins": margins.to_json()})


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
