"""Options that several verbs have, each declared once; they import nothing of exoid, so that help is quick."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple

from typer import Argument, Option

Text = str | None
Texts = list[str] | None
Number = float | None

LegName = Annotated[str, Argument(metavar="LEG", help="bleex, cuhk, a dataset, or a URDF file.")]
LogName = Annotated[str, Argument(metavar="LOG", help="A log, or a dataset's name:train or name:test.")]
LogNames = Annotated[list[str], Argument(metavar="LOG...", help="Logs, or a dataset's name:train or name:test.")]
EstimateName = Annotated[str, Argument(metavar="EST.JSON", help="Estimate of exoid identify -o.")]
EstimateOutput = Annotated[Text, Option("--output", "-o", metavar="EST.JSON", help="Write the estimate.")]
TermNames = Annotated[Text, Option(metavar="A,B", help="Terms, e.g. coulomb,viscous,armature,offset; none for none.")]
Known = Annotated[Texts, Option(metavar="NAME=VALUE", help="Hold a parameter fixed. Repeatable.")]
Cutoff = Annotated[Number, Option(metavar="HZ", help="Zero-phase low-pass; 8, or less for noisy angles.")]
TorqueCutoff = Annotated[Number, Option("--cutoff", metavar="HZ", help="Low-pass of both torques; default EST.JSON's.")]
TorqueNoise = Annotated[Text, Option(metavar="N·M", help="Torque noise (of each joint); default: 2 % of its torque.")]
Roles = Annotated[Texts, Option(metavar="JOINT=ROLE", help="Joint that is hip, knee or ankle of the gait. Repeatable.")]
Figures = Annotated[Text, Option(metavar="DIR", help="Write figures for a paper: PDF and SVG.")]
Report = Annotated[Text, Option(metavar="FILE.HTML", help="Write a report: one self-contained HTML page.")]
AsJson = Annotated[bool, Option("--json", help="Print JSON instead of a table.")]


class LogOptions(NamedTuple):
    """Reading logs."""

    columns: Annotated[
        Text, Option(metavar="LAB.TOML", help="Columns and options in a file, or EST.JSON's; none: as they stand.")
    ] = None
    column: Annotated[
        Texts,
        Option(
            metavar="NAME=HEADER",
            help="Header of a column, e.g. q_hip=pos1, tau_hip=current:0.118 (:SCALE, :SCALE:ZERO), q_hip=enc:deg, "
            "time=stamp:ms. Repeatable.",
        ),
    ] = None
    actuators: Annotated[
        Text, Option(metavar="DRIVES.TOML", help="Drives, for logs with columns i_, f_, tm_ or qm_; or bleex.")
    ] = None
    late: Annotated[
        Texts, Option(metavar="JOINT=S", help="Time by which a joint's torque or current is late [s]. Repeatable.")
    ] = None
    degrees: Annotated[
        bool | None, Option("--degrees/--radians", help="Angles in the logs are degrees; or radians, however far.")
    ] = None
    with_: Annotated[Texts, Option("--with", metavar="FILE", help="More columns on the same clock. Repeatable.")] = None
    forces: Annotated[Text, Option(metavar="GRF.MOT", help="Ground reaction forces of OpenSim, same clock.")] = None
    plate: Annotated[Texts, Option(metavar="PLATE=LINK", help="Link on a plate of --forces. Repeatable.")] = None
    start: Annotated[Number, Option(metavar="S", help="Use each log from this time stamp on [s].")] = None
    stop: Annotated[Number, Option(metavar="S", help="Use each log up to before this time stamp [s].")] = None
    gaps: Annotated[Literal["refuse", "split"], Option(help="Refuse gaps and repeated stamps, or split.")] = "refuse"
    topic: Annotated[Text, Option(metavar="NAME", help="Topic of joint states in a ROS bag.")] = None
    received: Annotated[bool, Option("--received", help="Times of arrival in a bag, not of the headers.")] = False
    mask: Annotated[Text, Option(metavar="HEADER", help="Use only samples with 1 in this column of 0 and 1.")] = None
    passive: Annotated[Text, Option(metavar="A,B", help="Joints without an actuator: their torque is zero.")] = None
    unmeasured: Annotated[Text, Option(metavar="A,B", help="Joints whose torque column is not read.")] = None
    payload: Annotated[
        Texts,
        Option(
            metavar="[LOG=]SEGMENT:KG@X,Y,Z",
            help="Body on a joint or link, at X,Y,Z [m] in its frame, e.g. shank:3.0@0,0,-0.3. Repeatable.",
        ),
    ] = None
    base_position: Annotated[Text, Option(metavar="X,Y,Z", help="IMU of base_gyro_x in the root link [m].")] = None
    wrench: Annotated[
        Texts,
        Option(
            metavar="LINK:AXES[@X,Y,Z]",
            help="Axes (link or world) of a wrench, and its point [m], e.g. foot:link@0,0,-0.08. Repeatable.",
        ),
    ] = None


READ_AS_IT_IS = LogOptions()
"""Logs without any option."""


class LegOptions(NamedTuple):
    """Which leg is meant."""

    side: Annotated[Text, Option(help="left, right or both, of a built-in leg; default: that of the logs.")] = None
    inertias: Annotated[Text, Option(help="Inertia set of a built-in leg.")] = None
    joints: Annotated[Text, Option(metavar="A,B", help="Moving joints; default: those in the logs, or all.")] = None
    moving_base: Annotated[bool, Option("--moving-base", help="For a leg that is not planar, on a moving base.")] = (
        False
    )
    floating_base: Annotated[bool, Option("--floating-base", help="Rows of the torso too, to stand or walk.")] = False
    contact: Annotated[
        Texts,
        Option(
            metavar="LINK=KIND",
            help="How a foot rests: point, edge, flat, or on a ball of RADIUS [m]; or FOOT_heel=X,Y,Z. Repeatable.",
            rich_help_panel="log",  # few legs need it: shown with the options of logs
        ),
    ] = None
    loops: Annotated[Text, Option(metavar="LOOPS.TOML", help="Closed loops of the URDF.", rich_help_panel="log")] = None


ANY_LEG = LegOptions()
"""The default leg of a name."""

FIXED_BASE = {"choice": ("moving_base", "floating_base", "contact")}
"""Options of the base, for verbs that have none."""


class GainOptions(NamedTuple):
    """Gains and rate of the controllers; None for the default of each."""

    kp: Annotated[Text, Option(metavar="A,B", help="Stiffness of each joint [N·m/rad].")] = None
    kd: Annotated[Text, Option(metavar="A,B", help="Damping [N·m·s/rad]; default kp/10.")] = None
    rate: Annotated[Number, Option(metavar="HZ", help="Rate of all controllers; default 100.")] = None


class DryRunOptions(NamedTuple):
    """Options of a run without a rig."""

    dry_run: Annotated[Text, Option(metavar="LOG", help="No rig: print what one law would have commanded.")] = None
    law: Annotated[Text, Option(metavar="NAME", help="--dry-run: gravity_support (default), pd, lqr or another")] = None
    limit: Annotated[Text, Option(metavar="A,B", help="--dry-run: largest torques [N·m].")] = None
    slew: Annotated[Text, Option(metavar="A,B", help="--dry-run: largest changes of torques [N·m/s].")] = None
    output: Annotated[Text, Option("--output", "-o", metavar="CSV", help="--dry-run: write both torques.")] = None


def given(*groups: Any) -> dict[str, object]:  # noqa: ANN401 - any named tuples
    """Value of each option by its name on the command line; None for those at their default."""
    return {
        f"--{name.rstrip('_').replace('_', '-')}": None if value == group._field_defaults[name] else value
        for group in groups
        for name, value in group._asdict().items()
    }
