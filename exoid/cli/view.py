"""``exoid view``: the leg in three dimensions, in a browser."""

from __future__ import annotations

import json
import math
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from exoid import estimate as estimates
from exoid import view as views
from exoid.errors import ExoidError
from exoid.leg.catalog import SEGMENTS
from exoid.leg.leg import Leg
from exoid.signals import Recording
from exoid.view import Scene

from .inputs import ANY_LEG, READ_AS_IT_IS, AsJson, LegOptions, LogOptions, read_logs
from .legs import refuse_unknown_leg
from .messages import note
from .option_groups import expand_options
from .outputs import check_outputs
from .progress import status
from .refusals import is_readable, refuse
from .robots import folder_of_robot, is_robot


@expand_options()
def view(
    leg: Annotated[
        str, typer.Argument(metavar="LEG", help="bleex, cuhk, a dataset, a URDF, a robot such as panda, or EST.JSON.")
    ],
    log: Annotated[str | None, typer.Option(metavar="LOG", help="Replay it: a CSV file, or name:test.")] = None,
    reference: Annotated[str | None, typer.Option(metavar="LOG", help="Log of a second, translucent leg.")] = None,
    horizon: Annotated[
        float, typer.Option(metavar="S", help="Horizon over which EST.JSON predicts the motion of LOG, repeatedly.")
    ] = 0.5,
    html: Annotated[str | None, typer.Option(metavar="FILE", help="Write one self-contained page instead.")] = None,
    choice: LegOptions = ANY_LEG,
    pose_deg: Annotated[
        list[str] | None, typer.Option("--pose", metavar="JOINT=DEG", help="Angle of a joint. Repeatable.")
    ] = None,
    meshes: Annotated[str | None, typer.Option(metavar="DIR", help="Folder of the URDF's meshes.")] = None,
    port: Annotated[int | None, typer.Option(metavar="N", help="Port to listen on; 0 for any free one.")] = None,
    browser: Annotated[bool, typer.Option("--open/--no-browser", help="Open a browser.")] = True,
    reading: LogOptions = READ_AS_IT_IS,
    as_json: AsJson = False,
) -> None:
    """Show LEG in a browser until Ctrl-C, on 127.0.0.1 only; or write it as a page that needs no network.

    Example: exoid view bleex --log bleex_swing:test --html leg.html
    """
    if html is not None and port is not None:
        raise ExoidError("--port has no effect: --html serves nothing", remedy="leave out one of the two")
    if reference is not None and log is None:
        raise ExoidError("--reference without --log", remedy="name the log to replay beside it with --log")
    if log is None:
        refuse(reading.given(), "only the logs of --log and --reference are read")
    check_outputs({"--html": html}, [leg, log, reference])
    if not leg.endswith(".json"):
        refuse_unknown_leg(leg)
    reading.refuse_other([each for each in (log, reference) if each is not None])
    recording = None if log is None else read_logs([log], reading)[0]
    ghost = None if reference is None else read_logs([reference], reading)[0]
    shown = _shown(leg, choice, () if recording is None else recording.joint_names)
    with status("drawing"):
        label = "reference"
        if ghost is None and recording is not None:
            ghost, label = _predicted(shown, recording, horizon), "predicted"
        drawn = views.scene(
            *shown.legs,
            pose=_pose(pose_deg or []),
            recording=recording,
            ghost=ghost,
            ghost_label=label,
            identified=shown.identified,
            meshes=_folder_of(leg) if meshes is None else meshes,
        )
    for each in drawn.notes:
        note(f"note: {each}")
    if html is not None:
        drawn.save(html)
        size = Path(html).stat().st_size
        typer.echo(json.dumps({"html": html, "bytes": size}) if as_json else f"wrote {html} ({size / 1e6:.2f} MB)")
    else:
        _serve(drawn, port, browser, as_json)


class _Shown(NamedTuple):
    """Legs to draw, and legs whose inertias are drawn beside theirs."""

    legs: Sequence[Leg | estimates.Estimate]
    identified: Sequence[Leg] = ()


def _shown(name: str, choice: LegOptions, logged: Sequence[str]) -> _Shown:
    """Load the legs to draw."""
    if name.endswith(".json"):
        refuse({f"--{option}": value for option, value in choice._asdict().items()}, "an estimate contains its leg")
        return _Shown([estimates.Estimate.load(name)])
    if name in SEGMENTS:
        sides = ("left", "right") if choice.side == "both" else (choice.side,)
        each = [choice._replace(side=side) for side in sides]
        legs = [one._replace(inertias=None).find(name, logged) for one in each]
        return _Shown(legs, [] if choice.inertias is None else [one.find(name, logged) for one in each])
    return _Shown([choice.find(name, logged or None)])


def _folder_of(leg: str) -> Path:
    """Folder of the meshes, unless the caller names one: that of the file, or of a robot known by name."""
    return folder_of_robot(leg) if not is_readable(leg) and is_robot(leg) else Path(leg).parent


def _predicted(shown: _Shown, recording: Recording, horizon: float) -> Recording | None:
    """Motion that an estimate predicts; None for a leg without one, or where other forces act."""
    estimate = shown.legs[0]
    free = recording.measured.all() and not recording.loaded_links
    return None if isinstance(estimate, Leg) or not free else estimates.predict_motion(estimate, recording, horizon)


def _pose(pairs: Sequence[str]) -> dict[str, float]:
    pose = {}
    for pair in pairs:
        name, _, angle = pair.partition("=")
        try:
            pose[name.strip()] = math.radians(float(angle))
        except ValueError:
            raise ExoidError(f"--pose {pair}", remedy="write JOINT=DEGREES, e.g. --pose left_knee=-40") from None
    return pose


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
