"""Options that several verbs have, each declared once; they import nothing of exoid, so that help is quick."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple

from typer import Argument, Option

Text = str | None
Texts = list[str] | None
Number = float | None

LegName = Annotated[str, Argument(metavar="LEG", help="bleex, cuhk, a dataset, a URDF file, or a robot such as panda.")]
LogNames = Annotated[
    list[str], Argument(metavar="LOG...", help="Logs of any kind, or a dataset's name:train or name:test.")
]
EstimateName = Annotated[str, Argument(metavar="EST.JSON", help="Estimate of exoid identify -o.")]
EstimateOutput = Annotated[Text, Option("--output", "-o", metavar="EST.JSON", help="Write the estimate.")]
TermNames = Annotated[
    Text,
    Option(
        metavar="A,B", help="Terms, such as armature, coulomb, offset, stiffness, stribeck, viscous; none for none."
    ),
]
Known = Annotated[Texts, Option(metavar="NAME=VALUE", help="Hold a parameter fixed. Repeatable.")]
TorqueNoise = Annotated[
    Text, Option(metavar="N·M", help="Torque noise, one number or one for each joint; default: 2 % of typical torques.")
]
DriveFile = Annotated[
    Text,
    Option(
        "--actuators",
        metavar="DRIVES.TOML",
        help="Drives of the joints, for logs of currents (i_), forces (f_), motor torques (tm_) or motor angles (qm_); "
        "bleex: its assumed cylinders.",
    ),
]
Roles = Annotated[
    Texts, Option(metavar="JOINT=ROLE", help="Joint that is the hip, knee or ankle of the gait. Repeatable.")
]
Figures = Annotated[Text, Option(metavar="DIR", help="Write figures into this folder.")]
Report = Annotated[Text, Option(metavar="FILE.HTML", help="Write a report: one self-contained HTML page.")]
AsJson = Annotated[bool, Option("--json", help="Print JSON instead of a table.")]


class LogOptions(NamedTuple):
    """Reading logs."""

    columns: Annotated[
        Text,
        Option(
            metavar="LAB.TOML",
            help="Columns and options of these logs in a file, or EST.JSON that remembers them; none: as they stand.",
        ),
    ] = None
    column: Annotated[
        Texts,
        Option(
            metavar="NAME=HEADER",
            help="The file's header for a column, e.g. q_hip=pos1; with :SCALE, :SCALE:ZERO and :UNIT where needed, "
            "e.g. tau_hip=current:0.118, q_hip=enc:deg, time=stamp:ms. Repeatable.",
        ),
    ] = None
    degrees: Annotated[bool, Option("--degrees", help="Angles in the logs are degrees.")] = False
    with_: Annotated[
        Texts,
        Option(
            "--with",
            metavar="FILE",
            help="File of the same clock with more columns, such as torques by inverse dynamics. Repeatable.",
        ),
    ] = None
    forces: Annotated[
        Text, Option(metavar="GRF.MOT", help="Ground reaction forces of the same clock, in a file of OpenSim.")
    ] = None
    plate: Annotated[
        Texts, Option(metavar="PLATE=LINK", help="Link that stands on a plate of --forces. Repeatable.")
    ] = None
    start: Annotated[Number, Option(metavar="S", help="Use each log from this time stamp on [s].")] = None
    stop: Annotated[Number, Option(metavar="S", help="Use each log up to before this time stamp [s].")] = None
    gaps: Annotated[
        Literal["refuse", "split"], Option(help="Refuse gaps and repeated time stamps, or split logs there.")
    ] = "refuse"
    topic: Annotated[Text, Option(metavar="NAME", help="Topic of joint states in a ROS bag.")] = None
    received: Annotated[
        bool, Option("--received", help="Use the times of arrival in a bag, not those in the headers.")
    ] = False
    segments: Annotated[
        Text,
        Option(
            metavar="FILE.CSV",
            help="Use only these segments: columns start, stop [s]; log (file name) for several logs.",
        ),
    ] = None
    mask: Annotated[Text, Option(metavar="HEADER", help="Use only samples with 1 in this column of 0 and 1.")] = None
    names: Annotated[
        Text, Option(metavar="A,B", help="Columns of logs without a header line: time,q_hip,tau_hip; empty: not read.")
    ] = None
    format: Annotated[
        Text,
        Option(
            metavar="NAME:JOINT", help="Log of one actuator: dephy, moteus or openexo, and its joint, e.g. moteus:knee."
        ),
    ] = None
    passive: Annotated[Text, Option(metavar="A,B", help="Joints without an actuator: their torque is zero.")] = None
    unmeasured: Annotated[Text, Option(metavar="A,B", help="Joints whose torque column is not read.")] = None
    payload: Annotated[
        Texts,
        Option(
            metavar="[LOG=]SEGMENT:KG@X,Y,Z",
            help="Weighed body on a segment (joint or link), at X,Y,Z [m] in its frame, e.g. "
            "heavy.csv=shank:3.0@0,0,-0.3; without LOG= in all logs. Repeatable.",
        ),
    ] = None
    base_position: Annotated[
        Text,
        Option(
            metavar="X,Y,Z", help="Position of the IMU of base_gyro_x and base_acc_x in the axes of the root link [m]."
        ),
    ] = None
    wrench: Annotated[
        Texts,
        Option(
            metavar="LINK:AXES[@X,Y,Z]",
            help="Axes (link or world) of the wrench on a link, and the point its moment is about [m], e.g. "
            "left_foot:link@0,0,-0.08. Repeatable.",
        ),
    ] = None


READ_AS_IT_IS = LogOptions()
"""Logs without any option."""


class LegOptions(NamedTuple):
    """Which leg is meant."""

    side: Annotated[Text, Option(help="left, right or both, of a built-in leg; default: that of the logs.")] = None
    inertias: Annotated[Text, Option(help="Inertia set of a built-in leg.")] = None
    joints: Annotated[
        Text, Option(metavar="A,B", help="Moving joints of a URDF; default: those in the logs, or all.")
    ] = None
    moving_base: Annotated[
        bool,
        Option("--moving-base", help="Parameters of a leg whose base moves in space; for legs that are not planar."),
    ] = False
    floating_base: Annotated[
        bool, Option("--floating-base", help="Rows of force and moment on the torso; for legs that stand or walk.")
    ] = False


ANY_LEG = LegOptions()
"""The default leg of a name."""

FIXED_BASE = {"choice": ("moving_base", "floating_base")}
"""Options of the base, for verbs that have none."""


class GainOptions(NamedTuple):
    """Gains and rate of the controllers; None for the default of each."""

    kp: Annotated[Text, Option(metavar="A,B", help="Stiffness of each joint [N·m/rad].")] = None
    kd: Annotated[Text, Option(metavar="A,B", help="Damping [N·m·s/rad]; default kp/10.")] = None
    rate: Annotated[Number, Option(metavar="HZ", help="Rate of all controllers; default 100.")] = None


class DryRunOptions(NamedTuple):
    """Options of a run without a rig."""

    dry_run: Annotated[
        Text, Option(metavar="LOG", help="No rig: print the torque that one controller would have commanded in a log.")
    ] = None
    law: Annotated[
        Text,
        Option(
            metavar="NAME",
            help="Controller of --dry-run: gravity_support (default), transparent, pd, gravity_friction_pd, "
            "feedforward_pd, computed_torque, lqr, adaptive, self_tuning.",
        ),
    ] = None
    limit: Annotated[Text, Option(metavar="A,B", help="--dry-run: largest torques [N·m].")] = None
    slew: Annotated[Text, Option(metavar="A,B", help="--dry-run: largest rates of change of the torques [N·m/s].")] = (
        None
    )
    output: Annotated[
        Text, Option("--output", "-o", metavar="CSV", help="--dry-run: write commanded and recorded torques.")
    ] = None


def given(*groups: Any) -> dict[str, object]:  # noqa: ANN401 - any named tuples
    """Value of each option by its name on the command line; None for those at their default."""
    return {
        f"--{name.rstrip('_').replace('_', '-')}": None if value == group._field_defaults[name] else value
        for group in groups
        for name, value in group._asdict().items()
    }
