"""``exoid track``: comparison of controllers on a leg."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, NamedTuple

from typer import Argument, Option

import exoid
from exoid.errors import BadArgumentError
from exoid.tools.tables import DataTable

from .column_map import with_remembered
from .inputs import load_estimate
from .messages import note, progress_bar
from .numbers import parse_gains, parse_roles
from .option_groups import expand_options
from .options import (
    READ_AS_IT_IS,
    AsJson,
    DryRunOptions,
    Figures,
    GainOptions,
    LogOptions,
    Number,
    Report,
    Roles,
    Text,
    given,
)
from .outputs import check_outputs, print_result, save_figures, show_report
from .refusals import is_readable, refuse

if TYPE_CHECKING:
    from exoid.actuators import Actuators
    from exoid.control import Tracking
    from exoid.lab.reproduce import ReplayReport
    from exoid.leg.leg import Leg
    from exoid.rig import Payload, Plant


class MotionOptions(NamedTuple):
    """The motion to follow; None for the default of each."""

    period: Annotated[Number, Option(metavar="S", help="Period of the gait; default 10.")] = None
    scale: Annotated[Number, Option(help="Factor of the gait's amplitudes; default 0.8.")] = None
    reference: Annotated[
        Text, Option(metavar="LOG", help="Follow the angles of a log from its beginning to its end.")
    ] = None
    role: Roles = None


class RigOptions(NamedTuple):
    """How the rig differs from the model."""

    rig_payload: Annotated[Number, Option(metavar="KG", help="Unknown payload on the rig's shank.")] = None
    rig_friction: Annotated[Number, Option(metavar="X", help="Factor of the rig's friction.")] = None


@expand_options(without={"reading": ("payload", "base_position", "wrench")})
def track(
    what: Annotated[str, Argument(metavar="EST.JSON|bleex", help="An estimate, or BLEEX of document 1.")],
    seed: Annotated[int, Option(min=0, help="Seed of sensor noise.")] = 0,
    gains: GainOptions = GainOptions(),  # noqa: B008 - a tuple does not change
    motion: MotionOptions = MotionOptions(),  # noqa: B008
    reading: LogOptions = READ_AS_IT_IS,
    rig: RigOptions = RigOptions(),  # noqa: B008
    dry: DryRunOptions = DryRunOptions(),  # noqa: B008
    figures: Figures = None,
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Run controllers on a rig and compare tracking error, torque, energy and chatter.

    Rig and controllers have the same model; --rig-payload and --rig-friction change the rig. With --dry-run a
    controller reads a log, and nothing moves.

    Example: exoid track est.json --rate 50
    """
    if motion.reference is None and dry.dry_run is None:
        refuse(given(reading), "only the log of --reference or --dry-run is read")
    inputs = [what, motion.reference, dry.dry_run]
    check_outputs({"--report": report, "--output": dry.output}, inputs, figures)
    logs = [each for each in inputs[1:] if each is not None]
    if logs and is_readable(what):
        reading = with_remembered(reading, exoid.Estimate.load(what), what, logs)
    if dry.dry_run is not None:
        refuse({**given(motion, rig), "--report": report}, "--dry-run has no rig")
        _dry_run(what, dry, gains, reading, figures, as_json=as_json)
        return
    refuse(given(dry), "there is no --dry-run")
    with progress_bar(f"tracking {what}") as progress:
        found = _of_leg(what, gains, motion, rig, reading, seed, progress)
    show_report(found, figures, report, as_json=as_json)


def _dry_run(
    what: str, dry: DryRunOptions, gains: GainOptions, reading: LogOptions, figures: str | None, *, as_json: bool
) -> None:
    """Replay a controller on a log, write and print it."""
    from .dry_run import dry_run  # noqa: PLC0415 - help needs no controllers

    replay = dry_run(_source(what), dry, gains, reading)
    if dry.output is not None:
        replay.to_csv(dry.output)
        note(f"wrote {dry.output}")
    if figures is not None:
        from exoid.lab.reproduce.tracking_report import law_replay_figure  # noqa: PLC0415 - it needs matplotlib

        save_figures(figures, {"dry_run": law_replay_figure(replay)})
    print_result(replay, as_json=as_json)


def _of_leg(
    what: str,
    gains: GainOptions,
    motion: MotionOptions,
    rig: RigOptions,
    reading: LogOptions,
    seed: int,
    progress: Callable[[float], None],
) -> ReplayReport:
    """Run every controller on a leg."""
    source = _source(what)
    from exoid.control.standard_laws import SENSORS  # noqa: PLC0415
    from exoid.control.tracking import tracking_table  # noqa: PLC0415
    from exoid.lab.reproduce.tracking_report import laws_json, tracking_report  # noqa: PLC0415 - see above
    from exoid.tools.numbers import checked  # noqa: PLC0415
    from exoid.torques.position_units import heading, position_units  # noqa: PLC0415

    from .motions import gait, logged  # noqa: PLC0415 - help needs no gaits

    model = exoid.control.ControlModel.of(source)
    leg, labels = model.leg, model.leg.joint_labels
    if motion.reference is None:
        reference, period, settle = gait(leg, motion.period, motion.scale, motion.role)
    else:
        refuse({"--scale": motion.scale, "--period": motion.period}, "the reference is that of a log")
        reference, period, settle = logged(leg, motion.reference, reading)
    rate = 100.0 if gains.rate is None else gains.rate
    usual = exoid.control.default_gains(model, exoid.control.mean_pose(reference, period), rate)
    kp, kd = parse_gains(gains.kp, gains.kd, labels, usual)
    plant = source if isinstance(source, exoid.rig.Plant) else model.plant()
    factor = checked(1.0 if rig.rig_friction is None else rig.rig_friction, "--rig-friction", least=0.0)
    rubbing = {name: factor * getattr(plant, name) for name in ("coulomb", "static", "viscous")}
    runs = exoid.control.compare_laws(
        exoid.rig.plant_with_payloads(replace(plant, **rubbing), _payloads(leg, motion, rig)),
        exoid.control.standard_laws(source, kp, kd, reference, period, rate=rate),
        reference,
        period if settle is not None else 2.0 * period,
        sensors=SENSORS,
        settle=period if settle is None else settle,
        seed=seed,
        progress=progress,
    )
    units = [heading(position_units(leg), of) for of in ("{torque}/{rad}", "{torque}·s/{rad}")]
    each = ", ".join(f"{name} {p:.3g} / {d:.3g}" for name, p, d in zip(labels, kp, kd, strict=True))
    title = f"{leg.description.name}: reference of {period:g} s; Kp [{units[0]}] / Kd [{units[1]}]: {each}"
    tables = [tracking_table(title, runs.values())]
    drives = source.actuators if isinstance(source, exoid.Estimate) else None
    if drives is not None:
        tables.append(_commands(runs.values(), drives))
    return tracking_report(f"Controllers on {what}", runs, tables, laws_json(runs, kp, kd, seed))


def _commands(runs: Iterable[Tracking], actuators: Actuators) -> DataTable:
    """Make a table of the largest and RMS commands of the drives."""
    import numpy as np  # noqa: PLC0415 - help needs no arrays

    rows = []
    for run in runs:
        commands = actuators.command(run.tau, run.q, run.v)
        for name, unit, values in zip(run.joint_names, actuators.units, commands.T, strict=True):
            rows.append((run.law, name, f"{np.abs(values).max():.3g}", f"{np.sqrt(np.mean(values**2)):.3g}", unit))
    return DataTable("Commands of the drives", ("controller", "joint", "largest", "rms", "unit"), rows)


def _source(what: str) -> exoid.Estimate | Plant:
    if what == "bleex":
        leg = exoid.load_leg("bleex", inertias="identified")
        return exoid.rig.Plant.build(leg, exoid.published.bleex_resistances("left"))
    if not is_readable(what):
        remedy = "name an estimate of exoid identify -o, or bleex; exoid reproduce tracking has document 2's comparison"
        raise BadArgumentError(f"no estimate {what!r}", remedy=remedy)
    return load_estimate(what)


def _payloads(leg: Leg, motion: MotionOptions, rig: RigOptions) -> list[Payload]:
    """Place the payload of the rig 0.3 m straight below the knee, or the last joint, of the hanging leg."""
    import numpy as np  # noqa: PLC0415 - help needs no arrays

    from exoid.leg.leg_data import joint_roles  # noqa: PLC0415

    roles, labels = joint_roles(leg, parse_roles(motion.role)), leg.joint_labels
    if rig.rig_payload is None:
        return []
    if not leg.limbs:
        raise BadArgumentError("--rig-payload has no place", where=leg.description.name, remedy="it needs a planar leg")
    joint = roles.index("knee") if "knee" in roles else len(labels) - 1
    rotations = np.vstack([limb.chain.rotations for limb in leg.limbs])
    x, y, z = (-0.3 * rotations[joint].T @ leg.plane.up).tolist()
    return [exoid.rig.Payload(labels[joint], rig.rig_payload, (x, y, z))]
