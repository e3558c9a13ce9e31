"""``exoid export``: an estimate as a URDF, for MuJoCo, as C, or as a control law in C or for ROS 2."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from exoid import estimate as estimates
from exoid.codegen import CSource
from exoid.codegen.dialect import identifier
from exoid.codegen.laws import LawSource
from exoid.codegen.laws.safety import SafeTorque
from exoid.codegen.ros2 import Ros2Package, refuse_foreign
from exoid.errors import ExoidError
from exoid.estimate import Export, MjcfExport
from exoid.exported import sidecar_of
from exoid.lift import MASS_FACTOR, PULL

from .inputs import AsJson
from .law_options import LawOptions
from .outputs import check_outputs

if TYPE_CHECKING:
    from exoid.online.in_c import RecursiveSource


def export(
    estimate: Annotated[str, typer.Argument(metavar="EST.JSON", help="Estimate of exoid identify -o.")],
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="LEG.URDF", help="Write the URDF there.")
    ] = None,
    c: Annotated[
        str | None, typer.Option("--c", metavar="LEG.C", help="Write the torques of a planar leg as C99 there instead.")
    ] = None,
    mjcf: Annotated[
        str | None,
        typer.Option("--mjcf", metavar="LEG.XML", help="Write MuJoCo's model file there instead, with rotors."),
    ] = None,
    mass_factor: Annotated[
        float | None,
        typer.Option(
            help="Largest factor by which the mass of a link may change; beyond it nothing is written "
            f"(default: {MASS_FACTOR:g})."
        ),
    ] = None,
    pull: Annotated[
        float | None,
        typer.Option(
            help="Weight of the URDF's own links where the estimate is not that of possible links; 1 takes their "
            f"inertias as known to 50 % (default: {PULL:g})."
        ),
    ] = None,
    precision: Annotated[str | None, typer.Option(help="Precision of the C: double (default) or float.")] = None,
    law: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Write this control law for the leg into the file of --c, and a header beside it."
        ),
    ] = None,
    kp: Annotated[
        str | None,
        typer.Option(metavar="A,B", help="--law: stiffness of each joint [N·m/rad]; default as exoid track."),
    ] = None,
    kd: Annotated[str | None, typer.Option(metavar="A,B", help="--law: damping [N·m·s/rad]; default kp/10.")] = None,
    rate: Annotated[
        float | None,
        typer.Option(
            metavar="HZ",
            help="--law: sampling rate; default 100, or 500 for sensitivity_amplification and --recursive.",
        ),
    ] = None,
    period: Annotated[
        float | None, typer.Option(metavar="S", help="--law: period of the gait, for gains; default 10.")
    ] = None,
    role: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT=ROLE", help="--law: joint that is the hip, knee or ankle. Repeatable."),
    ] = None,
    limit: Annotated[
        str | None, typer.Option(metavar="A,B", help="--law: largest torque [N·m]; default that of the URDF.")
    ] = None,
    slew: Annotated[
        str | None, typer.Option(metavar="A,B", help="--law: largest change of the torque [N·m/s]; default none.")
    ] = None,
    safe: Annotated[SafeTorque | None, typer.Option(help="--law: safe torque; default damping.")] = None,
    patience: Annotated[
        float | None,
        typer.Option(metavar="S", help="--law: time after which an unchanged input is stale; default 0.05."),
    ] = None,
    share: Annotated[
        str | None, typer.Option(metavar="A,B", help="--law gravity_support: share of the weight, 0 to 1; default 1.")
    ] = None,
    amplification: Annotated[
        str | None,
        typer.Option(metavar="A,B", help="--law sensitivity_amplification: 1 or more; default 2."),
    ] = None,
    bandwidth: Annotated[
        float | None,
        typer.Option(
            metavar="HZ",
            help="--law sensitivity_amplification (default 20), observers (8); cut-off of --recursive (8).",
        ),
    ] = None,
    recursive: Annotated[
        bool,
        typer.Option(
            "--recursive",
            help="Write a recursive estimator of the same parameters into the file of --c, and a header beside it.",
        ),
    ] = False,
    ros2: Annotated[
        str | None,
        typer.Option(
            metavar="DIR",
            help="--law: write a package for ROS 2 there instead of --c: a controller of ros2_control and a node. "
            "A folder with other files is not touched.",
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write an identified leg as a URDF, with LEG.exoid.json for what a URDF cannot hold, for MuJoCo or in C.

    With --law, the C is a control law with this model: pd, pd_gravity_friction, pd_feedforward, computed_torque, lqr;
    for a leg with a wearer gravity_support, sensitivity_amplification or impedance; or momentum_observer or
    kalman_observer, which give the torque of the wearer. With --ros2, it is a package for ROS 2 around that C.

    With --recursive, the C is a recursive estimator of the parameters of this estimate, without forgetting.

    Example: exoid export est.json -o leg.urdf
    """
    if sum(each is not None for each in (output, c, mjcf, ros2)) != 1:
        raise ExoidError(
            "one file is written at a time",
            remedy="give one of -o LEG.URDF, --c LEG.C and --mjcf LEG.XML, or --law NAME --ros2 DIR",
        )
    if c is None and ros2 is None and precision is not None:
        raise ExoidError("--precision has no effect without --c", remedy="leave out --precision, or give --c LEG.C")
    if (c is not None or ros2 is not None) and (mass_factor is not None or pull is not None):
        raise ExoidError(
            "--mass-factor and --pull have no effect on C", remedy="leave them out, or write a URDF with -o LEG.URDF"
        )
    options = LawOptions(kp, kd, rate, period, role, limit, slew, safe, patience, share, amplification, bandwidth)
    if recursive:
        _refuse_beside_recursive(c, law, precision, options)
    elif law is None and options.given():
        raise ExoidError(f"{', '.join(options.given())}: only a control law has it", remedy="name the law with --law")
    _refuse_without_law(output or mjcf, law, ros2)
    sidecar = sidecar_of(Path(output)) if output is not None and Path(output).name else None
    check_outputs(
        {
            "--output": output,
            "the file beside --output": sidecar,
            "--c": c,
            "the header of --c": _header(c, law, recursive),
            "--mjcf": mjcf,
        },
        [estimate],
    )
    if ros2 is not None:
        refuse_foreign(ros2)
    found = estimates.Estimate.load(estimate)
    if law is not None:
        from .law_export import export_law  # noqa: PLC0415 - only a law needs the controllers

        written: CSource | LawSource | Ros2Package | RecursiveSource | Export | MjcfExport = export_law(
            found, law, c, options, precision or "double", ros2
        )
    elif recursive:
        from .recursive_export import export_recursive  # noqa: PLC0415 - only this needs the estimator

        written = export_recursive(found, str(c), rate, bandwidth)
    elif c is not None:
        written = found.to_c(c, precision=precision or "double")
    else:
        pull = PULL if pull is None else pull
        mass_factor = MASS_FACTOR if mass_factor is None else mass_factor
        write = found.to_urdf if mjcf is None else found.to_mjcf
        written = write(str(output or mjcf), pull=pull, mass_factor=mass_factor)
    typer.echo(json.dumps(written.to_json(), indent=1) if as_json else str(written))


def _refuse_without_law(output: str | None, law: str | None, ros2: str | None) -> None:
    """Refuse a law without a place, and a package without a law."""
    if law is not None and output is not None:
        raise ExoidError("--law has no effect on a URDF", remedy="give --c LAW.C")
    if law is None and ros2 is not None:
        raise ExoidError("--ros2 writes a control law", remedy="name the law with --law")


def _refuse_beside_recursive(c: str | None, law: str | None, precision: str | None, options: LawOptions) -> None:
    """Refuse options that a recursive estimator does not have."""
    if c is None or law is not None:
        raise ExoidError("--recursive writes C of its own", remedy="give --c ONLINE.C, without --law")
    if precision == "float":
        raise ExoidError("a recursive estimator in float", remedy="leave out --precision: it needs double")
    foreign = [option for option in options.given() if option not in ("--rate", "--bandwidth")]
    if foreign:
        raise ExoidError(f"{', '.join(foreign)}: only a control law has it", remedy="leave it out with --recursive")


def _header(c: str | None, law: str | None, recursive: bool) -> Path | None:
    """Header beside the source of a law or of a recursive estimator."""
    return None if c is None or (law is None and not recursive) else Path(c).with_name(f"{identifier(c)}.h")
