"""Options of a control law that is written as C."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import typer

from exoid.codegen.laws.safety import SafeTorque


class LawOptions(NamedTuple):
    """Options of a law; None for the default of each."""

    kp: Annotated[
        str | None,
        typer.Option(metavar="A,B", help="--law: stiffness of each joint [N·m/rad]; default as exoid track."),
    ] = None
    kd: Annotated[str | None, typer.Option(metavar="A,B", help="--law: damping [N·m·s/rad]; default kp/10.")] = None
    rate: Annotated[
        float | None,
        typer.Option(
            metavar="HZ",
            help="--law: sampling rate; default 100, or 500 for sensitivity_amplification.",
        ),
    ] = None
    period: Annotated[
        float | None, typer.Option(metavar="S", help="--law: period of the gait, for gains; default 10.")
    ] = None
    role: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT=ROLE", help="--law: joint that is the hip, knee or ankle. Repeatable."),
    ] = None
    limit: Annotated[
        str | None, typer.Option(metavar="A,B", help="--law: largest torque [N·m]; default that of the URDF.")
    ] = None
    slew: Annotated[
        str | None, typer.Option(metavar="A,B", help="--law: largest change of the torque [N·m/s]; default none.")
    ] = None
    safe: Annotated[SafeTorque | None, typer.Option(help="--law: safe torque; default damping.")] = None
    patience: Annotated[
        float | None,
        typer.Option(metavar="S", help="--law: time after which an unchanged input is stale; default 0.05."),
    ] = None
    share: Annotated[
        str | None, typer.Option(metavar="A,B", help="--law gravity_support: share of the weight, 0 to 1; default 1.")
    ] = None
    amplification: Annotated[
        str | None,
        typer.Option(metavar="A,B", help="--law sensitivity_amplification: 1 or more; default 2."),
    ] = None
    bandwidth: Annotated[
        float | None,
        typer.Option(
            metavar="HZ",
            help="--law sensitivity_amplification (default 20), observers (8).",
        ),
    ] = None

    def given(self) -> list[str]:
        """List the options that were given."""
        return [f"--{name}" for name, value in self._asdict().items() if value is not None]


USUAL_LAW = LawOptions()
"""The defaults of each law."""
