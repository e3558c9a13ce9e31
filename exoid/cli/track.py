"""``exoid track``: comparison of controllers on a leg."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import typer

from exoid import control
from exoid._typing import FloatArray
from exoid.control import ControlModel, LawReplay, Tracking
from exoid.control.tracking import tracking_table
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.experiments.gait import joint_roles
from exoid.leg import published
from exoid.leg.catalog import load_leg
from exoid.leg.leg import Leg
from exoid.rig import Payload, Plant
from exoid.tools.files import make_folder
from exoid.tools.tables import DataTable, to_text

from .courses import SCALE, MotionOptions, gait, logged, roles_of
from .dry_run import DryRun
from .dry_run import dry_run as run_dry
from .inputs import READ_AS_IT_IS, AsJson, LogOptions, Report
from .messages import note
from .numbers import joint_values
from .option_groups import expand_options
from .outputs import check_outputs
from .progress import progress_bar
from .refusals import is_readable, refuse

__all__ = ["SCALE", "roles_of", "track"]

DEPTH = 0.3
"""Distance of a payload below its joint [m]."""


class DocumentOptions(NamedTuple):
    """Options of document 2's comparison."""

    rotor: Annotated[float | None, typer.Option(metavar="KGM2", help="cuhk: rotor inertia at each joint.")] = None
    wrong: Annotated[bool, typer.Option("--wrong", help="cuhk: also controllers with a wrong model.")] = False


class GainOptions(NamedTuple):
    """Gains and rate of the controllers; None for the default of each."""

    kp: Annotated[str | None, typer.Option(metavar="A,B", help="Stiffness of each joint [N·m/rad].")] = None
    kd: Annotated[str | None, typer.Option(metavar="A,B", help="Damping [N·m·s/rad]; default kp/10.")] = None
    rate: Annotated[float | None, typer.Option(metavar="HZ", help="Rate of all controllers; default 100.")] = None

    def of(self, labels: Sequence[str], default: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
        """Parse the gains."""
        kp, kd = default
        if self.kp is not None:
            kp = joint_values(self.kp, "--kp", labels, one_for_all=True)
            kd = 0.1 * kp
        if self.kd is not None:
            kd = joint_values(self.kd, "--kd", labels, one_for_all=True)
        return kp, kd


class RigOptions(NamedTuple):
    """How the rig differs from the model."""

    payload: Annotated[float | None, typer.Option(metavar="KG", help="Unknown payload on the rig's shank.")] = None
    friction: Annotated[float | None, typer.Option(metavar="X", help="Factor of the rig's friction.")] = None


class DryRunOptions(NamedTuple):
    """Options of a run without a rig."""

    dry_run: Annotated[
        str | None,
        typer.Option(
            "--dry-run",
            metavar="LOG",
            help="No rig: print the torque that one controller would have commanded in a log.",
        ),
    ] = None
    law: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Controller of --dry-run: gravity_support (default), transparent, pd, pd_gravity_friction, "
            "pd_feedforward, computed_torque, lqr, adaptive, self_tuning.",
        ),
    ] = None
    limit: Annotated[str | None, typer.Option(metavar="A,B", help="--dry-run: largest torques [N·m].")] = None
    slew: Annotated[
        str | None, typer.Option(metavar="A,B", help="--dry-run: largest rates of change of the torques [N·m/s].")
    ] = None
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="CSV", help="--dry-run: write commanded and recorded torques."),
    ] = None


class Comparison(NamedTuple):
    """Controllers side by side.

    Attributes:
        runs: Runs by name of the controller.
        table: Table of all.
        notes: Notes on the table.
        text: What is printed.
        data: The same as JSON types.
    """

    runs: Mapping[str, Tracking]
    table: DataTable
    notes: Sequence[str]
    text: str
    data: dict[str, Any]


@expand_options(without={"reading": ("payload", "base_position", "wrench")})
def track(
    what: Annotated[
        str, typer.Argument(metavar="EST.JSON|cuhk|bleex", help="An estimate, document 2's comparison, or BLEEX.")
    ],
    seed: Annotated[int, typer.Option(min=0, help="Seed of sensor noise; for cuhk of the whole experiment.")] = 0,
    document: DocumentOptions = DocumentOptions(),  # noqa: B008 - a tuple does not change
    gains: GainOptions = GainOptions(),  # noqa: B008
    motion: MotionOptions = MotionOptions(),  # noqa: B008
    reading: LogOptions = READ_AS_IT_IS,
    rig: RigOptions = RigOptions(),  # noqa: B008
    dry: DryRunOptions = DryRunOptions(),  # noqa: B008
    figures: Annotated[str | None, typer.Option(metavar="DIR", help="Write figures into this folder.")] = None,
    figure_format: Annotated[Literal["png", "pdf"], typer.Option(help="Format of the figures.")] = "png",
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Run controllers on a rig and compare tracking error, torque, energy and chatter.

    cuhk replays document 2's comparison of controllers, on a leg identified from noisy data. With an estimate, rig and
    controllers have the same model; --payload and --friction change the rig. With --dry-run nothing moves: a controller
    reads a log.

    Example: exoid track est.json --rate 50
    """
    from exoid.lab import reproduce  # noqa: PLC0415 - matplotlib would slow down the help
    from exoid.view.figure_files import write_figures  # noqa: PLC0415

    if figures is not None:
        make_folder(figures)
    if motion.reference is None and dry.dry_run is None:
        refuse(reading.given(), "only the log of --reference or --dry-run is read")
    check_outputs({"--report": report, "--output": dry.output}, [what, motion.reference, dry.dry_run])
    if dry.dry_run is not None:
        refuse({**_flags(motion, rig, document), "--report": report}, "--dry-run has no rig")
        replay = run_dry(_source(what), DryRun(dry.dry_run, dry.law, *gains, dry.limit, dry.slew), reading)
        _show_dry_run(replay, dry.output, figures, figure_format, as_json=as_json)
        return
    refuse(_flags(dry), "there is no --dry-run")
    of_document = what == "cuhk"
    with progress_bar(f"tracking {what}") as progress:
        if of_document:
            refuse(_flags(gains, motion, rig), "cuhk is document 2's comparison; name an estimate")
            found = _of_document(document, seed, progress)
        else:
            refuse(_flags(document), "it is an option of cuhk")
            found = _of_leg(what, gains, motion, rig, reading, seed, progress)
    if figures is not None:
        drawn = reproduce.tracking_figures(found.runs, of_document=of_document)
        for path in write_figures(figures, drawn, figure_format):
            note(f"wrote {path}")
    if report is not None:
        title = f"Controllers on {what}"
        reproduce.tracking_page(title, found.table, found.notes, found.runs, of_document=of_document).save(report)
        note(f"wrote {report}")
    typer.echo(json.dumps(found.data, indent=1) if as_json else found.text)


def _flags(*groups: DocumentOptions | GainOptions | MotionOptions | RigOptions | DryRunOptions) -> dict[str, object]:
    """Value of each option by its name; None for those that were not given."""
    options = {name: value for group in groups for name, value in group._asdict().items()}
    return {f"--{name.replace('_', '-')}": None if value is False else value for name, value in options.items()}


def _show_dry_run(replay: LawReplay, output: str | None, figures: str | None, form: str, *, as_json: bool) -> None:
    """Write and print a dry run."""
    from exoid.lab.reproduce.tracking_report import law_replay_figure  # noqa: PLC0415 - see above
    from exoid.view.figure_files import write_figures  # noqa: PLC0415

    if output is not None:
        replay.to_csv(output)
        note(f"wrote {output}")
    if figures is not None:
        for path in write_figures(figures, {"dry_run": law_replay_figure(replay)}, form):
            note(f"wrote {path}")
    typer.echo(json.dumps(replay.to_json(), indent=1) if as_json else str(replay))


def _of_document(document: DocumentOptions, seed: int, progress: Callable[[float], None]) -> Comparison:
    """Run document 2's comparison."""
    from exoid.lab import reproduce  # noqa: PLC0415 - see above

    inertia = {} if document.rotor is None else {"rotor": document.rotor}
    replay = reproduce.reproduce_cuhk_tracking(seed, wrong=document.wrong, progress=progress, **inertia)
    return Comparison(
        replay.laws,
        reproduce.cuhk_tracking_table(replay),
        reproduce.cuhk_tracking_notes(replay),
        reproduce.cuhk_tracking_text(replay),
        reproduce.cuhk_tracking_json(replay),
    )


def _of_leg(
    what: str,
    gains: GainOptions,
    motion: MotionOptions,
    rig: RigOptions,
    reading: LogOptions,
    seed: int,
    progress: Callable[[float], None],
) -> Comparison:
    """Run every controller on a leg."""
    from exoid.lab import reproduce  # noqa: PLC0415 - see above

    source = _source(what)
    model = ControlModel.of(source)
    leg, labels = model.leg, model.leg.joint_labels
    if motion.reference is None:
        reference, period, settle = gait(leg, motion)
    else:
        refuse({"--scale": motion.scale, "--speed": motion.speed}, "the reference is that of a log")
        reference, period, settle = logged(leg, motion.reference, motion.period, reading)
    kp, kd = gains.of(labels, control.default_gains(model, control.mean_pose(reference, period)))
    runs = control.track(
        source,
        kp,
        kd,
        reference,
        period,
        periods=2 if settle is None else 1,
        settle=settle,
        rate=100.0 if gains.rate is None else gains.rate,
        friction=1.0 if rig.friction is None else rig.friction,
        payloads=_payloads(leg, motion, rig),
        seed=seed,
        progress=progress,
    )
    each = ", ".join(f"{name} {p:.3g} / {d:.3g}" for name, p, d in zip(labels, kp, kd, strict=True))
    title = f"{leg.description.name}: reference of {period:g} s; Kp [N·m/rad] / Kd [N·m·s/rad]: {each}"
    table = tracking_table(title, runs.values())
    drives = Estimate.load(what).actuators if is_readable(what) else None
    commands = () if drives is None else (control.command_table(runs.values(), drives),)
    return Comparison(runs, table, (), to_text(table, *commands), reproduce.laws_json(runs, kp, kd, seed))


def _payloads(leg: Leg, motion: MotionOptions, rig: RigOptions) -> list[Payload]:
    """Place the payload of the rig, below the knee where there is one."""
    roles, labels = joint_roles(leg, roles_of(motion.role)), leg.joint_labels
    if rig.payload is None:
        return []
    joint = labels[roles.index("knee")] if "knee" in roles else labels[-1]
    return [Payload(joint, rig.payload, _below(leg, joint))]


def _source(what: str) -> Estimate | Plant:
    if what == "bleex":
        return Plant.build(load_leg("bleex", inertias="identified"), published.bleex_resistances("left"))
    if not is_readable(what):
        raise ExoidError(f"no estimate {what!r}", remedy="name an estimate of exoid identify -o, cuhk or bleex")
    return Estimate.load(what)


def _below(leg: Leg, joint: str) -> tuple[float, float, float]:
    """Place a payload straight below a joint of the hanging leg, in the joint's frame [m]."""
    if not leg.limbs:
        raise ExoidError("--payload has no place", where=leg.description.name, remedy="it needs a planar leg")
    rotations = np.vstack([limb.chain.rotations for limb in leg.limbs])
    x, y, z = (-DEPTH * rotations[leg.joint_labels.index(joint)].T @ leg.plane.up).tolist()
    return x, y, z
