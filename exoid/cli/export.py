"""``exoid export``: an estimate as a URDF, for MuJoCo, as C, or as a control law in C or for ROS 2."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from exoid import estimate as estimates
from exoid.codegen import CSource
from exoid.codegen.dialect import identifier
from exoid.codegen.laws import LawSource
from exoid.codegen.ros2 import Ros2Package, refuse_foreign
from exoid.errors import ExoidError
from exoid.estimate import Export, MjcfExport
from exoid.leg.exported import sidecar_of
from exoid.leg.lift.lift import PULL
from exoid.leg.lift.masses import MASS_FACTOR

from .inputs import AsJson
from .law_options import USUAL_LAW, LawOptions
from .option_groups import expand_options
from .outputs import check_outputs


class LinkOptions(NamedTuple):
    """How far the links of a URDF may move."""

    mass_factor: Annotated[
        float | None,
        typer.Option(
            help="Largest factor by which the mass of a link may change; beyond it nothing is written "
            f"(default: {MASS_FACTOR:g})."
        ),
    ] = None
    pull: Annotated[
        float | None,
        typer.Option(
            help="Weight of the URDF's own links where the estimate is not that of possible links; 1 takes their "
            f"inertias as known to 50 % (default: {PULL:g})."
        ),
    ] = None


NEAR_THE_URDF = LinkOptions()
"""Links near those of the URDF."""


class Target(NamedTuple):
    """What is written, and where; None for what is not.

    Attributes:
        output: URDF.
        c: Source in C.
        mjcf: Model file of MuJoCo.
        ros2: Folder of a package for ROS 2.
        law: Name of the control law in C.
        precision: Precision of the C.
    """

    output: str | None
    c: str | None
    mjcf: str | None
    ros2: str | None
    law: str | None
    precision: str | None

    @property
    def files(self) -> dict[str, str | Path | None]:
        """Files by option."""
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


@expand_options()
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
    links: LinkOptions = NEAR_THE_URDF,
    precision: Annotated[str | None, typer.Option(help="Precision of the C: double (default) or float.")] = None,
    law: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Write this control law for the leg into the file of --c, and a header beside it."
        ),
    ] = None,
    options: LawOptions = USUAL_LAW,
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

    With --law, the C is a control law with this model: pd, pd_gravity_friction, pd_feedforward, computed_torque or lqr;
    for a leg with a wearer gravity_support, sensitivity_amplification or impedance; or momentum_observer or
    kalman_observer, which give the torque of the wearer. With --ros2, it is a package for ROS 2 around that C.

    Example: exoid export est.json -o leg.urdf
    """
    target = Target(output, c, mjcf, ros2, law, precision)
    _refuse_without_effect(target, links, options)
    check_outputs(target.files, [estimate])
    if ros2 is not None:
        refuse_foreign(ros2)
    found = estimates.Estimate.load(estimate)
    written = _in_c(found, target, options) if c is not None or ros2 is not None else _as_model(found, target, links)
    typer.echo(json.dumps(written.to_json(), indent=1) if as_json else str(written))


def _as_model(found: estimates.Estimate, target: Target, links: LinkOptions) -> Export | MjcfExport:
    """Write a URDF, or a model file of MuJoCo."""
    pull = PULL if links.pull is None else links.pull
    mass_factor = MASS_FACTOR if links.mass_factor is None else links.mass_factor
    if target.mjcf is not None:
        return found.to_mjcf(target.mjcf, pull=pull, mass_factor=mass_factor)
    return found.to_urdf(str(target.output), pull=pull, mass_factor=mass_factor)


def _in_c(found: estimates.Estimate, target: Target, options: LawOptions) -> CSource | LawSource | Ros2Package:
    """Write torques or a law in C, or a package for ROS 2."""
    precision = target.precision or "double"
    if target.law is not None:
        from .law_export import export_law  # noqa: PLC0415 - only a law needs the controllers

        return export_law(found, target.law, target.c, options, precision, target.ros2)
    return found.to_c(str(target.c), precision=precision)


def _refuse_without_effect(target: Target, links: LinkOptions, options: LawOptions) -> None:
    """Refuse options that have no effect on what is written."""
    output, c, mjcf, ros2, law, precision = target
    if sum(each is not None for each in (output, c, mjcf, ros2)) != 1:
        raise ExoidError(
            "one file is written at a time",
            remedy="give one of -o LEG.URDF, --c LEG.C and --mjcf LEG.XML, or --law NAME --ros2 DIR",
        )
    in_c = c is not None or ros2 is not None
    if not in_c and precision is not None:
        raise ExoidError("--precision has no effect without --c", remedy="leave out --precision, or give --c LEG.C")
    if in_c and (links.mass_factor is not None or links.pull is not None):
        raise ExoidError(
            "--mass-factor and --pull have no effect on C", remedy="leave them out, or write a URDF with -o LEG.URDF"
        )
    if law is None and options.given():
        raise ExoidError(f"{', '.join(options.given())}: only a control law has it", remedy="name the law with --law")
    if law is not None and not in_c:
        raise ExoidError("--law has no effect on a URDF", remedy="give --c LAW.C")
    if law is None and ros2 is not None:
        raise ExoidError("--ros2 writes a control law", remedy="name the law with --law")
