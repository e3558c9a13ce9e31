"""``exoid view``: the leg in three dimensions, in a browser."""

from __future__ import annotations

import json
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer import Argument, Option

import exoid

from .column_map import with_remembered
from .inputs import read_drives, read_logs
from .legs import BUILT_IN, find_leg, refuse_unknown_leg
from .messages import note, status
from .numbers import values_by_name
from .option_groups import expand_options
from .options import ANY_LEG, FIXED_BASE, READ_AS_IT_IS, AsJson, LegOptions, LogOptions, Text, Texts, given
from .outputs import check_outputs
from .refusals import refuse

if TYPE_CHECKING:
    from exoid.leg.leg import Leg
    from exoid.signals import Recording
    from exoid.view import Scene


@expand_options(without=FIXED_BASE)
def view(
    leg: Annotated[str, Argument(metavar="LEG", help="bleex, cuhk, a dataset, a URDF, or EST.JSON.")],
    log: Annotated[Text, Option(metavar="LOG", help="Replay it: a CSV file, or name:test.")] = None,
    html: Annotated[Text, Option(metavar="FILE", help="Write one self-contained page instead.")] = None,
    choice: LegOptions = ANY_LEG,
    pose_deg: Annotated[
        Texts, Option("--pose", metavar="JOINT=DEG", help="Angle, or mm of a slide. Repeatable.")
    ] = None,
    meshes: Annotated[Text, Option(metavar="DIR", help="Folder of the URDF's meshes.")] = None,
    port: Annotated[int | None, Option(metavar="N", help="Port to listen on; 0 for any free one.")] = None,
    browser: Annotated[bool, Option("--open/--no-browser", help="Open a browser.")] = True,
    reading: LogOptions = READ_AS_IT_IS,
    as_json: AsJson = False,
) -> None:
    """Show LEG in a browser until Ctrl-C, on 127.0.0.1 only; or write it as a page that needs no network.

    Example: exoid view bleex --log bleex_swing:test --html leg.html
    """
    from exoid.torques.position_units import position_units  # noqa: PLC0415 - help needs no arrays

    if html is not None:
        refuse({"--port": port}, "--html serves nothing")
    if log is None:
        refuse(given(reading), "only the log of --log is read")
    check_outputs({"--html": html}, [leg, log])
    if not leg.endswith(".json"):
        refuse_unknown_leg(leg)
    elif log is not None:
        reading = with_remembered(reading, exoid.Estimate.load(leg), leg, [log])
    recording = None if log is None else read_logs([log], reading)[0]
    shown, identified = _shown(leg, choice, () if recording is None else recording.joint_names)
    pose = values_by_name(pose_deg, "--pose", float, "JOINT=DEGREES, e.g. --pose left_knee=-40")
    legs = [each.model.leg if isinstance(each, exoid.Estimate) else each for each in shown]
    sizes = {name: unit.size for leg in legs for name, unit in zip(leg.joint_names, position_units(leg), strict=True)}
    with status("drawing"):
        drawn = exoid.view.scene(
            *shown,
            pose={joint: x * sizes.get(joint, 1.0) for joint, x in pose.items()},
            recording=None if recording is None else _with_torque(recording, shown[0], reading),
            identified=identified,
            meshes=Path(leg).parent if meshes is None else meshes,
        )
    for each in drawn.notes:
        note(f"note: {each}")
    if html is None:
        _serve(drawn, port, browser, as_json)
        return
    drawn.save(html)
    size = Path(html).stat().st_size
    typer.echo(json.dumps({"html": html, "bytes": size}) if as_json else f"wrote {html} ({size / 1e6:.2f} MB)")


def _shown(
    name: str, choice: LegOptions, logged: Sequence[str]
) -> tuple[Sequence[Leg | exoid.Estimate], Sequence[Leg]]:
    """Load the legs to draw, and legs whose inertias are drawn beside theirs."""
    if name.endswith(".json"):
        refuse(given(choice), "an estimate contains its leg")
        return [exoid.Estimate.load(name)], []
    if name in BUILT_IN:
        sides = ("left", "right") if choice.side == "both" else (choice.side,)
        each = [choice._replace(side=side) for side in sides]
        legs = [find_leg(name, one._replace(inertias=None), logged) for one in each]
        return legs, [] if choice.inertias is None else [find_leg(name, one, logged) for one in each]
    return [find_leg(name, choice, logged or None)], []


def _with_torque(log: Recording, shown: Leg | exoid.Estimate, reading: LogOptions) -> Recording:
    """Compute the torque of a log of currents, with the drives that were given or those of the estimate."""
    from exoid.actuators.constants import unknown_constants  # noqa: PLC0415 - help needs no drives

    drives = read_drives(reading, shown.model.leg if isinstance(shown, exoid.Estimate) else shown)
    drives = drives or getattr(shown, "actuators", None)
    return log if drives is None or unknown_constants(drives) else drives.torque(log)


def _serve(drawn: Scene, port: int | None, browser: bool, as_json: bool) -> None:
    """Serve until Ctrl-C."""
    with drawn.serve(port) as server:
        if as_json:
            typer.echo(json.dumps({"url": server.url, "port": server.port}))
        else:
            typer.echo(f"{drawn.title}: {server.url} (this machine only; Ctrl-C ends it)")
        if browser:
            webbrowser.open(server.url)
        server.wait()
    note("ended")
