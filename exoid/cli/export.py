"""``exoid export``: an estimate as a URDF, for MuJoCo, as C, or as a control law in C or for ROS 2."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, NamedTuple

from typer import Option

import exoid
from exoid.errors import BadArgumentError

from .option_groups import expand_options
from .options import AsJson, EstimateName, Number, Roles, Text, given
from .outputs import check_outputs, print_result
from .refusals import refuse


class Target(NamedTuple):
    """What is written, and where."""

    output: Annotated[Text, Option("--output", "-o", metavar="LEG.URDF", help="Write the URDF there.")] = None
    c: Annotated[
        Text, Option("--c", metavar="LEG.C", help="Write the torques of a planar leg as C99 there instead.")
    ] = None
    mjcf: Annotated[Text, Option(metavar="LEG.XML", help="Write MuJoCo's model file there instead, with rotors.")] = (
        None
    )
    ros2: Annotated[
        Text,
        Option(
            metavar="DIR",
            help="--law: write a package for ROS 2 there instead of --c: a controller of ros2_control and a node. "
            "A folder with other files is not touched.",
        ),
    ] = None
    precision: Annotated[Text, Option(help="Precision of the C: double (default) or float.")] = None
    law: Annotated[
        Text,
        Option(metavar="NAME", help="Write this control law for the leg into the file of --c, and a header beside it."),
    ] = None

    @property
    def files(self) -> dict[str, str | Path | None]:
        """Files by option."""
        from exoid.codegen.dialect import identifier  # noqa: PLC0415 - help needs no C
        from exoid.leg.exported import sidecar_of  # noqa: PLC0415

        sidecar = sidecar_of(Path(self.output)) if self.output is not None and Path(self.output).name else None
        header = None
        if self.c is not None and self.law is not None:
            header = Path(self.c).with_name(f"{identifier(self.c)}.h")
        return {
            "--output": self.output,
            "the file beside --output": sidecar,
            "--c": self.c,
            "the header of --c": header,
            "--mjcf": self.mjcf,
        }


class LinkOptions(NamedTuple):
    """How far the links of a URDF may move."""

    mass_factor: Annotated[
        float, Option(help="Largest factor by which the mass of a link may change; beyond it nothing is written.")
    ] = 5.0
    pull: Annotated[
        float,
        Option(
            help="Weight of the URDF's own links where the estimate is not that of possible links; 1 takes their "
            "inertias as known to 50 %."
        ),
    ] = 1.0


class LawOptions(NamedTuple):
    """Options of a law; None for the default of each."""

    kp: Annotated[
        Text, Option(metavar="A,B", help="--law: stiffness of each joint [N·m/rad]; default as exoid track.")
    ] = None
    kd: Annotated[Text, Option(metavar="A,B", help="--law: damping [N·m·s/rad]; default kp/10.")] = None
    rate: Annotated[
        Number,
        Option(
            metavar="HZ",
            help="--law: sampling rate; default 100, or 500 for sensitivity_amplification.",
        ),
    ] = None
    period: Annotated[Number, Option(metavar="S", help="--law: period of the gait, for gains; default 10.")] = None
    role: Roles = None
    limit: Annotated[Text, Option(metavar="A,B", help="--law: largest torque [N·m]; default that of the URDF.")] = None
    slew: Annotated[Text, Option(metavar="A,B", help="--law: largest change of the torque [N·m/s]; default none.")] = (
        None
    )
    safe: Annotated[
        Literal["zero", "damping", "gravity"] | None, Option(help="--law: safe torque; default damping.")
    ] = None
    patience: Annotated[
        Number, Option(metavar="S", help="--law: time after which an unchanged input is stale; default 0.05.")
    ] = None
    share: Annotated[
        Text, Option(metavar="A,B", help="--law gravity_support: share of the weight, 0 to 1; default 1.")
    ] = None
    amplification: Annotated[
        Text, Option(metavar="A,B", help="--law sensitivity_amplification: 1 or more; default 2.")
    ] = None
    bandwidth: Annotated[
        Number,
        Option(
            metavar="HZ",
            help="--law sensitivity_amplification (default 20)and observers (8).",
        ),
    ] = None


@expand_options()
def export(
    estimate: EstimateName,
    target: Target = Target(),  # noqa: B008 - a tuple does not change
    links: LinkOptions = LinkOptions(),  # noqa: B008
    options: LawOptions = LawOptions(),  # noqa: B008
    as_json: AsJson = False,
) -> None:
    """Write an identified leg as a URDF, with LEG.exoid.json for what a URDF cannot hold, for MuJoCo or in C.

    With --law, the C is a control law with this model: pd, pd_gravity_friction, pd_feedforward, computed_torque, lqr,
    adaptive (in double); for a leg with a wearer gravity_support, sensitivity_amplification or impedance; or
    momentum_observer or kalman_observer, which give the torque of the wearer. With --ros2, it is a package for ROS 2
    around that C.


    Example: exoid export est.json -o leg.urdf
    """
    _refuse_without_effect(target, links, options)
    check_outputs(target.files, [estimate])
    if target.ros2 is not None:
        from exoid.codegen.ros2 import refuse_foreign  # noqa: PLC0415

        refuse_foreign(target.ros2)
    found = exoid.Estimate.load(estimate)
    if target.law is not None:
        from .law_export import export_law  # noqa: PLC0415 - only a law needs the controllers

        print_result(export_law(found, target, options), as_json=as_json)
    elif target.c is not None:
        print_result(found.to_c(target.c, precision=target.precision or "double"), as_json=as_json)
    elif target.mjcf is not None:
        print_result(found.to_mjcf(target.mjcf, **links._asdict()), as_json=as_json)
    else:
        print_result(found.to_urdf(str(target.output), **links._asdict()), as_json=as_json)


def _refuse_without_effect(target: Target, links: LinkOptions, options: LawOptions) -> None:
    """Refuse options that have no effect on what is written."""
    output, c, mjcf, ros2, precision, law = target
    in_c = c is not None or ros2 is not None
    of_law = [name for name, value in given(options).items() if value is not None]
    refuse({"--precision": None if in_c else precision}, "nothing is written as C; give --c LEG.C")
    rules = (
        (
            sum(each is not None for each in (output, c, mjcf, ros2)) != 1,
            "one file is written at a time",
            "give one of -o LEG.URDF, --c LEG.C and --mjcf LEG.XML, or --law NAME --ros2 DIR",
        ),
        (
            in_c and links != LinkOptions(),
            "--mass-factor and --pull have no effect on C",
            "leave them out, or write a URDF with -o LEG.URDF",
        ),
        (law is None and bool(of_law), f"{', '.join(of_law)}: only a control law has it", "name the law with --law"),
        (law is not None and not in_c, "--law has no effect on a URDF", "give --c LAW.C"),
        (law is None and ros2 is not None, "--ros2 writes a control law", "name the law with --law"),
    )
    for applies, what, remedy in rules:
        if applies:
            raise BadArgumentError(what, remedy=remedy)
