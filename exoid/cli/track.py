"""``exoid track``: comparison of controllers on a leg."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import typer

from exoid import control, experiments, published
from exoid.catalog import load_leg
from exoid.control import ControlModel, LawReplay
from exoid.control.tracking import tracking_table
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.files import make_folder
from exoid.leg import Leg
from exoid.rig import Payload, Plant, Reference
from exoid.tables import DataTable, to_text

from .dry_run import DryRun
from .dry_run import dry_run as run_dry
from .inputs import AsJson, ColumnPairs, Degrees, LogOptions, Names, Report, is_readable, read_log, refuse
from .messages import note
from .numbers import joint_values
from .outputs import check_outputs
from .progress import progress_bar

HARMONICS = 6
"""Number of harmonics fitted to a reference from a log of a periodic motion."""

LARGEST_DEVIATION = np.deg2rad(1.0)
"""Largest deviation (RMS) of these harmonics from the log [rad]."""

SETTLE, SETTLED_SHARE = 1.0, 0.25
"""Time at the beginning of a log that the metrics leave out [s], and its largest share of the log."""

SCALE = 0.8
"""Factor of the gait's amplitudes on legs other than document 2's: within the limits of both built-in ones."""

DEPTH = 0.3
"""Distance of a payload below its joint [m]."""


class TrackOptions(NamedTuple):
    """Options for a leg that is not document 2's; None for the default of each."""

    kp: str | None
    kd: str | None
    rate: float | None
    period: float | None
    scale: float | None
    speed: str | None
    reference: str | None
    role: list[str] | None
    payload: float | None
    friction: float | None


def track(
    what: Annotated[
        str, typer.Argument(metavar="EST.JSON|cuhk|bleex", help="An estimate, document 2's comparison, or BLEEX.")
    ],
    seed: Annotated[int, typer.Option(min=0, help="Seed of sensor noise; for cuhk of the whole experiment.")] = 0,
    rotor: Annotated[float | None, typer.Option(metavar="KGM2", help="cuhk: rotor inertia at each joint.")] = None,
    wrong: Annotated[bool, typer.Option("--wrong", help="cuhk: also controllers with a wrong model.")] = False,
    kp: Annotated[str | None, typer.Option(metavar="A,B", help="Stiffness of each joint [N·m/rad].")] = None,
    kd: Annotated[str | None, typer.Option(metavar="A,B", help="Damping [N·m·s/rad]; default kp/10.")] = None,
    rate: Annotated[float | None, typer.Option(metavar="HZ", help="Rate of all controllers; default 100.")] = None,
    period: Annotated[
        float | None,
        typer.Option(metavar="S", help="Period of the gait; default 10. With --reference: that of a periodic log."),
    ] = None,
    scale: Annotated[float | None, typer.Option(help="Factor of the gait's amplitudes; default 0.8.")] = None,
    speed: Annotated[str | None, typer.Option(help="Norm of VerySlow, Slow, Free or Fast gait.")] = None,
    reference: Annotated[
        str | None, typer.Option(metavar="LOG", help="Follow the angles of a log from its beginning to its end.")
    ] = None,
    column: ColumnPairs = None,
    degrees: Degrees = False,
    names: Names = None,
    role: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT=ROLE", help="Joint that is the hip, knee or ankle of the gait. Repeatable."),
    ] = None,
    payload: Annotated[float | None, typer.Option(metavar="KG", help="Unknown payload on the rig's shank.")] = None,
    friction: Annotated[float | None, typer.Option(metavar="X", help="Factor of the rig's friction.")] = None,
    dry_run: Annotated[
        str | None,
        typer.Option(
            "--dry-run",
            metavar="LOG",
            help="No rig: print the torque that one controller would have commanded in a log.",
        ),
    ] = None,
    law: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Controller of --dry-run: gravity_support (default), transparent, pd, pd_gravity_friction, "
            "pd_feedforward, computed_torque, lqr, adaptive, self_tuning.",
        ),
    ] = None,
    limit: Annotated[str | None, typer.Option(metavar="A,B", help="--dry-run: largest torques [N·m].")] = None,
    slew: Annotated[
        str | None, typer.Option(metavar="A,B", help="--dry-run: largest rates of change of the torques [N·m/s].")
    ] = None,
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="CSV", help="--dry-run: write commanded and recorded torques."),
    ] = None,
    figures: Annotated[str | None, typer.Option(metavar="DIR", help="Write figures into this folder.")] = None,
    form: Annotated[Literal["png", "pdf"], typer.Option("--format", help="Format of the figures.")] = "png",
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Run controllers on a rig and compare tracking error, torque, energy and chatter.

    cuhk replays document 2's comparison of controllers, on a leg identified from noisy data. With an estimate, rig and
    controllers have the same model; --payload and --friction change the rig. With --dry-run nothing moves: a controller
    reads a log.
    """
    from exoid import reproduce  # noqa: PLC0415 - matplotlib would slow down the help
    from exoid.view.figure_files import write_figures  # noqa: PLC0415

    options = TrackOptions(kp, kd, rate, period, scale, speed, reference, role, payload, friction)
    if figures is not None:
        make_folder(figures)
    read = {"--column": column, "--degrees": degrees or None, "--names": names}
    reading = LogOptions(column, degrees, names=names)
    if reference is None and dry_run is None:
        refuse(read, "only the log of --reference or --dry-run is read")
    check_outputs({"--report": report, "--output": output}, [what, reference, dry_run])
    if dry_run is not None:
        only = options._replace(kp=None, kd=None, rate=None)
        given = {f"--{name}": value for name, value in only._asdict().items()}
        refuse({**given, "--report": report, "--wrong": wrong or None, "--rotor": rotor}, "--dry-run has no rig")
        dry = run_dry(_source(what), DryRun(dry_run, law, kp, kd, rate, limit, slew), reading)
        _show_dry_run(dry, output, figures, form, as_json=as_json)
        return
    refuse({"--law": law, "--limit": limit, "--slew": slew, "--output": output}, "there is no --dry-run")
    if what == "cuhk":
        given = {f"--{name}": value for name, value in options._asdict().items()}
        refuse(given, "cuhk is document 2's comparison; name an estimate")
    else:
        refuse({"--rotor": rotor, "--wrong": wrong or None}, "it is an option of cuhk")
    with progress_bar(f"tracking {what}") as progress:
        if what == "cuhk":
            inertia = {} if rotor is None else {"rotor": rotor}
            replay = reproduce.reproduce_cuhk_tracking(seed, wrong=wrong, progress=progress, **inertia)
            table, notes = reproduce.cuhk_tracking_table(replay), reproduce.cuhk_tracking_notes(replay)
            runs, text, data = replay.laws, reproduce.cuhk_tracking_text(replay), reproduce.cuhk_tracking_json(replay)
        else:
            runs, table, data = _track_leg(what, options, reading, seed, progress)
            drives = Estimate.load(what).actuators if is_readable(what) else None
            commands = () if drives is None else (control.command_table(runs.values(), drives),)
            text, notes = to_text(table, *commands), ()
    if figures is not None:
        for path in write_figures(figures, reproduce.tracking_figures(runs, of_document=what == "cuhk"), form):
            note(f"wrote {path}")
    if report is not None:
        reproduce.tracking_page(f"Controllers on {what}", table, notes, runs, of_document=what == "cuhk").save(report)
    typer.echo(json.dumps(data, indent=1) if as_json else text)


def _show_dry_run(replay: LawReplay, output: str | None, figures: str | None, form: str, *, as_json: bool) -> None:
    """Write and print a dry run."""
    from exoid.reproduce.tracking_report import law_replay_figure  # noqa: PLC0415 - see above
    from exoid.view.figure_files import write_figures  # noqa: PLC0415

    if output is not None:
        replay.to_csv(output)
        note(f"wrote {output}")
    if figures is not None:
        for path in write_figures(figures, {"dry_run": law_replay_figure(replay)}, form):
            note(f"wrote {path}")
    typer.echo(json.dumps(replay.to_json(), indent=1) if as_json else str(replay))


def _track_leg(
    what: str, options: TrackOptions, reading: LogOptions, seed: int, progress: Callable[[float], None]
) -> tuple[Mapping[str, Any], DataTable, dict[str, Any]]:
    """Run every controller on a leg; return the runs, also as a table and as JSON."""
    from exoid import reproduce  # noqa: PLC0415 - see above

    source = _source(what)
    model = ControlModel.of(source)
    reference, period, settle = _reference(model.leg, options, reading)
    labels = model.leg.joint_labels
    kp, kd = control.default_gains(model, control.mean_pose(reference, period))
    if options.kp is not None:
        kp = joint_values(options.kp, "--kp", labels, one_for_all=True)
        kd = 0.1 * kp
    if options.kd is not None:
        kd = joint_values(options.kd, "--kd", labels, one_for_all=True)
    roles = experiments.joint_roles(model.leg, roles_of(options.role))
    joint = labels[roles.index("knee")] if "knee" in roles else labels[-1]
    payloads = [] if options.payload is None else [Payload(joint, options.payload, _below(model.leg, joint))]
    runs = control.track(
        source,
        kp,
        kd,
        reference,
        period,
        periods=2 if settle is None else 1,
        settle=settle,
        rate=100.0 if options.rate is None else options.rate,
        friction=1.0 if options.friction is None else options.friction,
        payloads=payloads,
        seed=seed,
        progress=progress,
    )
    gains = ", ".join(f"{name} {p:.3g} / {d:.3g}" for name, p, d in zip(labels, kp, kd, strict=True))
    title = f"{model.leg.description.name}: reference of {period:g} s; Kp [N·m/rad] / Kd [N·m·s/rad]: {gains}"
    return runs, tracking_table(title, runs.values()), reproduce.laws_json(runs, kp, kd, seed)


def _source(what: str) -> Estimate | Plant:
    if what == "bleex":
        return Plant.build(load_leg("bleex", inertias="identified"), published.bleex_resistances("left"))
    if not is_readable(what):
        raise ExoidError(f"no estimate {what!r}", remedy="name an estimate of exoid identify -o, cuhk or bleex")
    return Estimate.load(what)


class _Course(NamedTuple):
    """Reference, its period or duration [s], and the time that the metrics leave out [s]; None for one period."""

    reference: Reference
    period: float
    settle: float | None = None


def _reference(leg: Leg, options: TrackOptions, reading: LogOptions) -> _Course:
    """Make the reference of one leg."""
    if options.reference is not None:
        refuse({"--scale": options.scale, "--speed": options.speed}, "the reference is that of a log")
        return _logged(leg, options.reference, options.period, reading)
    period = 10.0 if options.period is None else options.period
    if not 0.0 < period < np.inf:
        raise ExoidError(f"--period {period:g}", remedy="give seconds")
    scale = SCALE if options.scale is None else options.scale
    roles = roles_of(options.role)
    if options.speed is None:
        return _Course(experiments.gait_for_leg(leg, experiments.healthy_gait(scale, period), roles), period)
    return _Course(experiments.gait_for_leg(leg, experiments.norm_gait(options.speed, scale, period), roles), period)


def _logged(leg: Leg, name: str, period: float | None, reading: LogOptions) -> _Course:
    """Follow a log; one of a periodic motion, again and again."""
    log = read_log(name, reading, leg.joint_names)
    if period is None:
        followed = experiments.follow_log(log)
        return _Course(followed, followed.duration, min(SETTLE, SETTLED_SHARE * followed.duration))
    time = log.time - log.time[0]
    periodic = experiments.fit_harmonics(time, log.q, period, HARMONICS)
    deviation = log.q - np.array([periodic.at(float(t)).q[:, 0] for t in time])
    worst = float(np.sqrt(np.mean(deviation**2, axis=0)).max())
    if worst > LARGEST_DEVIATION:
        raise ExoidError(
            f"{HARMONICS} harmonics of a period of {period:g} s deviate from the log by {np.rad2deg(worst):.1f}° (RMS)",
            where=name,
            remedy="leave out --period to follow the log itself",
        )
    return _Course(periodic, period)


def roles_of(pairs: list[str] | None) -> dict[str, str]:
    """Turn "HFE=hip" into a role by joint.

    Args:
        pairs: Values of --role; None for none.

    Returns:
        Role by joint.

    Raises:
        ExoidError: One is not JOINT=ROLE.
    """
    roles = {}
    for pair in pairs or ():
        joint, _, role = pair.partition("=")
        if not joint or not role:
            raise ExoidError(f"--role {pair}", remedy="write JOINT=ROLE, e.g. --role HFE=hip --role KFE=knee")
        roles[joint.strip()] = role.strip()
    return roles


def _below(leg: Leg, joint: str) -> tuple[float, float, float]:
    """Place a payload straight below a joint of the hanging leg, in the joint's frame [m]."""
    if not leg.limbs:
        raise ExoidError("--payload has no place", where=leg.description.name, remedy="it needs a planar leg")
    rotations = np.vstack([limb.chain.rotations for limb in leg.limbs])
    x, y, z = (-DEPTH * rotations[leg.joint_labels.index(joint)].T @ leg.plane.up).tolist()
    return x, y, z
