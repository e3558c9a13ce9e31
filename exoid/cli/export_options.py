"""Options of ``exoid export``: what is written where, and the law."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, NamedTuple

from typer import Option

from .options import Number, Roles, Text


class Target(NamedTuple):
    """What is written, and where."""

    output: Annotated[Text, Option("--output", "-o", metavar="LEG.URDF", help="Write the URDF there.")] = None
    c: Annotated[Text, Option("--c", metavar="LEG.C", help="Write the torques of a planar leg as C99 there.")] = None
    mjcf: Annotated[Text, Option(metavar="LEG.XML", help="Write MuJoCo's model file there, with rotors.")] = None
    ros2: Annotated[Text, Option(metavar="DIR", help="--law: write a ROS 2 package there, in its own folder.")] = None
    precision: Annotated[Text, Option(help="Precision of the C: double (default) or float.")] = None
    law: Annotated[Text, Option(metavar="NAME", help="Write this law into the file of --c, with a header.")] = None

    @property
    def files(self) -> dict[str, str | Path | None]:
        """Files by option."""
        from exoid.codegen.dialect import identifier  # noqa: PLC0415 - help needs no C

        header = None
        if self.c is not None and self.law is not None:
            header = Path(self.c).with_name(f"{identifier(self.c)}.h")
        return {"--output": self.output, "--c": self.c, "the header of --c": header, "--mjcf": self.mjcf}


class LinkOptions(NamedTuple):
    """How far the links of a URDF may move."""

    mass_factor: Annotated[float, Option(help="Largest factor of a link's mass; beyond it nothing is written.")] = 5.0
    pull: Annotated[float, Option(help="Weight of the URDF's links where none fit; 1: known to 50 %.")] = 1.0


class LawOptions(NamedTuple):
    """Options of a law; None for the default of each."""

    kp: Annotated[Text, Option(metavar="A,B", help="--law: stiffness [N·m/rad]; default as exoid track.")] = None
    kd: Annotated[Text, Option(metavar="A,B", help="--law: damping [N·m·s/rad]; default kp/10.")] = None
    rate: Annotated[Number, Option(metavar="HZ", help="--law: rate; 100, or 500 for sensitivity_amplification.")] = None
    role: Roles = None
    limit: Annotated[Text, Option(metavar="A,B", help="--law: largest torque [N·m]; default the URDF's.")] = None
    slew: Annotated[Text, Option(metavar="A,B", help="--law: largest change of it [N·m/s]; default none.")] = None
    safe: Annotated[Literal["zero", "damping", "gravity"] | None, Option(help="--law: safe torque; damping.")] = None
    patience: Annotated[Number, Option(metavar="S", help="--law: age of a stale input; default 0.05.")] = None
    share: Annotated[Text, Option(metavar="A,B", help="--law gravity_support: share, 0 to 1; default 1.")] = None
    amplification: Annotated[Text, Option(metavar="A,B", help="--law sensitivity_amplification: default 2.")] = None
    bandwidth: Annotated[Number, Option(metavar="HZ", help="--law sensitivity_amplification: 20; observers: 8.")] = None
