"""What exoid makes of many machines: error, coverage, findings true and false, and time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import pinocchio as pin

import exoid
from exoid import ExoidError, Recording
from exoid.identification.selection import select_terms
from exoid.torques import Coulomb, LoadFriction, Stribeck, Term

from .friction import Array
from .machine import Machine, draw
from .simulate import Log, simulate

TRAINING, TEST = 12.0, 4.0
"""Seconds to learn from, and to be judged on."""

ESTIMATORS = ("wls", "ols", "huber", "ml")
"""Estimators whose intervals are judged."""

Form = tuple[tuple[Term, ...] | None, str]
"""Terms and estimator of one model for all joints."""


def forms() -> dict[str, Form]:
    """List models for all joints that selection joint by joint is compared with."""
    rest = (exoid.Viscous(), exoid.Armature(), exoid.Offset())
    models: dict[str, Form] = {"default": (None, "wls")}
    models["reversals kept"] = (Coulomb(smoothing=0.02, reversal_speed=0.0), *rest), "wls"
    for length in (5e-5, 2e-4, 1e-3):
        models[f"presliding {1e3 * length:g} mrad"] = (Coulomb(presliding=length), *rest), "wls"
    bent = {"presliding": 2e-4}
    models["Stribeck"] = (Coulomb(**bent), Stribeck(velocity=0.1, **bent), *rest), "wls"
    models["load"] = (Coulomb(**bent), LoadFriction(**bent), *rest), "wls"
    models["default, huber"] = None, "huber"
    return models


Spoil = Callable[[Recording, int], Recording | list[Recording]]


def column(name: str, change: Callable[[Array, Recording], Array]) -> Spoil:
    """Change one quantity of one joint."""

    def spoil(recording: Recording, joint: int) -> Recording:
        values = getattr(recording, name).copy()
        values[:, joint] = change(values[:, joint], recording)
        return replace(recording, **{name: values})

    return spoil


def swap(name: str, *, neighbour: bool = False) -> Spoil:
    """Swap a quantity of a joint with that of the one farthest from it, or of a neighbour."""

    def spoil(recording: Recording, joint: int) -> Recording:
        count = recording.n_joints
        order, other = np.arange(count), count - 1 if joint < count / 2 else 0
        if neighbour:
            other = joint - 1 if joint else 1
        order[[joint, other]] = order[[other, joint]]
        return replace(recording, **{name: getattr(recording, name)[:, order]})

    return spoil


def late(seconds: float) -> Callable[[Array, Recording], Array]:
    """Make a signal late."""

    def change(x: Array, recording: Recording) -> Array:
        shift = max(1, round(seconds * recording.sample_rate))
        return np.concatenate([x[:shift], x[:-shift]])

    return change


def velocity(seconds: float = 0.0, gain: float = 1.0) -> Spoil:
    """Log velocities that are late, as those of a filtered estimate are, or out of scale."""

    def spoil(recording: Recording, joint: int) -> Recording:
        stamps = recording.time - seconds
        v = gain * np.gradient(recording.q, recording.time, axis=0)
        return replace(recording, v=np.column_stack([np.interp(stamps, recording.time, x) for x in v.T]))

    return spoil


def some(x: Array, share: float) -> Array:
    """Choose some samples, the same each time."""
    return np.random.default_rng(3).random(len(x)) < share


def held(seconds: float) -> Callable[[Array, Recording], Array]:
    """Keep the value where the signal moves fastest."""

    def change(x: Array, recording: Recording) -> Array:
        count = round(seconds * recording.sample_rate)
        first = int(np.argmax(np.abs(np.gradient(x))[: len(x) - count - 10]))
        return np.where((np.arange(len(x)) >= first) & (np.arange(len(x)) < first + count), x[first], x)

    return change


def half_way(after: Callable[[Array], Array]) -> Callable[[Array, Recording], Array]:
    """Log a signal otherwise in the second half."""
    return lambda x, _: np.where(np.arange(len(x)) < len(x) // 2, x, after(x))


def in_two_logs(recording: Recording, joint: int) -> list[Recording]:
    """Cut the log in two, and let the second encoder read 2° more."""
    first, second = recording.slice(0, len(recording) // 2), recording.slice(len(recording) // 2)
    return [first, column("q", lambda x, _: x + np.deg2rad(2.0))(second, joint)]


def without_samples(recording: Recording, joint: int) -> Recording:
    """Lose 60 ms where the machine moves fastest, while the stamps run on."""
    lost = max(2, round(0.06 * recording.sample_rate))
    speed = np.abs(np.gradient(recording.q, axis=0)).sum(axis=1)[: -10 * lost]
    kept = np.ones(len(recording), dtype=bool)
    kept[int(np.argmax(speed)) :][:lost] = False
    short = recording.slice(0, int(kept.sum()))
    return replace(short, q=recording.q[kept], tau=recording.tau[kept])


def push(x: Array, recording: Recording) -> Array:
    """Add a push, of twice the spread of the torque."""
    return x + 2.0 * x.std() * np.exp(-(((recording.time - 0.6 * recording.time[-1]) / 0.25) ** 2))


def jitter(recording: Recording, joint: int) -> Recording:
    """Stamp samples when they arrive."""
    late = np.random.default_rng(3).standard_normal(len(recording)) / (3.0 * recording.sample_rate)
    stamps = np.maximum.accumulate(recording.time + late) + 1e-7 * np.arange(len(recording))
    return replace(recording, time=stamps)


def spring(recording: Recording, joint: int) -> Recording:
    """Let a spring act that takes a third of the torque."""
    q = recording.q[:, joint] - recording.q[:, joint].mean()
    return column("tau", lambda x, _: x + 0.3 * x.std() / q.std() * q)(recording, joint)


def mixed(recording: Recording, joint: int) -> Recording:
    """Log a share of a neighbour's torque, too: at most all of it, as no sensor sees more."""
    other = recording.tau[:, joint - 1 if joint else 1]
    return column("tau", lambda x, _: x + min(0.3 * x.std() / max(other.std(), 1e-9), 1.0) * other)(recording, joint)


def without_gravity(machine: Machine, recording: Recording) -> Recording:
    """Log the efforts of a controller that takes the gravity torque of its own, true model out."""
    driven = [not joint.passive for joint in machine.joints]
    return replace(recording, tau=recording.tau - driven * machine.leg(believed=False).gravity(recording.q))


def elastic(machine: Machine, joint: int) -> Log:
    """Log a motion with a spring of 5 Hz, with the other joints locked, between the encoder of a joint and its link."""
    inertia = pin.crba(leg := machine.leg(believed=False).model, leg.createData(), np.zeros(leg.nq))[joint, joint]
    joints = [*machine.joints]
    joints[joint] = replace(joints[joint], spring=float((2.0 * np.pi * 5.0) ** 2 * inertia))
    machine = replace(machine, joints=tuple(joints))
    log, turn = simulate(machine, TRAINING), 2.0 * np.pi / 2**machine.sensing.bits
    return replace(log, recording=replace(log.recording, q=turn * np.round(log.truth.rotor[0] / turn)))


def beyond(machine: Machine, joint: int) -> Log:
    """Log the commands of a machine of which the drive of a joint gives 85 % of what the motion needs."""
    machine, joints = machine.with_sensing(torque="command"), [*machine.joints]
    most = np.abs(simulate(machine, TRAINING).truth.drive[:, joint]).max()
    joints[joint] = replace(joints[joint], limit=0.85 * float(most))
    return simulate(replace(machine, joints=tuple(joints)), TRAINING)


MISTAKES: dict[str, tuple[Spoil, str]] = {
    "sign of one torque": (column("tau", lambda x, _: -x), "torque-sign"),
    "one torque 40 ms late": (column("tau", late(0.04)), "torque-delay"),
    "two far joints swapped": (swap("tau"), "joint-order"),
    "velocity 5 ms late": (velocity(0.005), "velocity-delay"),
    "one torque as a magnitude": (column("tau", lambda x, _: np.abs(x)), "unsigned-torque"),
    "all torques as magnitudes": (lambda r, _: replace(r, tau=np.abs(r.tau)), "unsigned-torque"),
    "torque clock 0.5 % slow": (
        lambda r, _: replace(r, tau=np.column_stack([np.interp(0.995 * r.time, r.time, x) for x in r.tau.T])),
        "two-clocks",
    ),
    "efforts without gravity": (lambda r, _: r, "gravity-compensated-effort"),
    "an elastic joint": (lambda r, _: r, "elastic-joint"),
    "commands beyond the limit of a drive": (lambda r, _: r, "saturation"),
    "one torque 25 ms late": (column("tau", late(0.025)), "torque-delay"),
    "all torques 20 ms late": (
        lambda r, _: replace(r, tau=np.column_stack([late(0.02)(x, r) for x in r.tau.T])),
        "torque-delay",
    ),
    "sign of all torques": (lambda r, _: replace(r, tau=-r.tau), "torque-sign"),
    "sign of one angle": (column("q", lambda x, _: -x), "angle-sign"),
    "angles of neighbours swapped": (swap("q", neighbour=True), "joint-order"),
    "torque in N·mm": (column("tau", lambda x, _: 1000.0 * x), "torque-scale"),
    "all torques in N·mm": (lambda r, _: replace(r, tau=1000.0 * r.tau), "torque-scale"),
    "torque sensor reads 1.3 times": (column("tau", lambda x, _: 1.3 * x), "torque-scale"),
    "zero of an angle 10° off": (column("q", lambda x, _: x + np.deg2rad(10.0)), "angle-offset"),
    "angle reads 1.1 times": (column("q", lambda x, _: 1.1 * x), "angle-scale"),
    "clock 1.15 times too fast": (lambda r, _: replace(r, time=r.time / 1.15), "clock"),
    "a spring": (spring, "unmodelled-force"),
    "sensor sees a neighbour": (mixed, "cross-talk"),
    "torque at its rail": (column("tau", lambda x, _: np.clip(x, *np.quantile(x, [0.06, 0.94]))), "saturation"),
    "angle frozen for 1 s": (column("q", held(1.0)), "stuck-channel"),
    "torque frozen for 0.5 s": (column("tau", held(0.5)), "stuck-channel"),
    "torque of a slower sensor": (column("tau", lambda x, _: np.repeat(x[::3], 3)[: len(x)]), "stale-samples"),
    "torque drops to zero": (column("tau", lambda x, _: np.where(some(x, 0.01), 0.0, x)), "dropout"),
    "torque has spikes": (column("tau", lambda x, _: x + 4.0 * x.std() * some(x, 0.01)), "spikes"),
    "60 ms lost": (without_samples, "missing-samples"),
    "angle wraps": (column("q", lambda x, _: np.mod(x - np.median(x), 2.0 * np.pi)), "angle-wrap"),
    "velocity twice as large": (velocity(gain=2.0), "velocity-scale"),
    "velocity 2 % too large": (velocity(gain=1.02), "velocity-scale"),
    "encoder slips by 2° half way": (column("q", half_way(lambda x: x + np.deg2rad(2.0))), "angle-jump"),
    "zero set again by 2° between two logs": (in_two_logs, "change"),
    "torque sensor is set again half way": (column("tau", half_way(lambda x: x + 0.5 * x.std())), "change"),
    "scale of a torque grows by 0.1 half way": (column("tau", half_way(lambda x: 1.1 * x)), "change"),
    "angle off by 10 mrad, four times a turn": (
        column("q", lambda x, _: x + 0.01 * np.sin(4.0 * x + 0.5)),
        "angle-ripple",
    ),
    "angle off by 1 mrad, 50 times a turn": (column("q", lambda x, _: x + 1e-3 * np.sin(50.0 * x)), "angle-ripple"),
    "somebody pushes for half a second": (column("tau", push), "large-residual"),
    "stamps jitter by a third of a sample": (jitter, "stamp-jitter"),
    "log passed twice": (lambda r, _: [r, replace(r, tau=r.tau.copy())], "repeated-data"),
}
"""Mistakes of a log, and the kind of finding that names them."""

OF_MODEL = ("torque-scale", "angle-offset", "angle-scale", "clock", "unmodelled-force", "cross-talk", "angle-sign")
OF_MODEL += ("unsigned-torque", "gravity-compensated-effort", "two-clocks", "elastic-joint", "change", "angle-ripple")
"""Kinds that are not looked for beside rows of a base, nor is the order of angles."""


@dataclass
class Outcome:
    """What came of one machine.

    Attributes:
        machine: The machine.
        nrmse: Mean NRMSE of the driven joints on the motion to be judged on, without errors of sensors, by model.
        seconds: Processor time by what was done [s].
        inside: Which 95 % intervals of the rigid bodies contain the truth, by estimator.
        doubtful: Which of these parameters a warning or error makes doubtful, likewise.
        false: Findings of the log that nothing in the machine explains, as (severity, kind).
        true: Findings that the machine explains.
        named: Whether each mistake is named with the right joint.
        bands: Share of the measured torque of each driven joint within its 95 % band on that motion, and whether a
            warning of the estimate or the validation says that it is not to be trusted there.
        shown: By how much a mistake that is not named makes the residual of some joint larger: 1.1 is 10 %.
        refused: What was refused, with the reason.
    """

    machine: Machine
    nrmse: dict[str, float] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    inside: dict[str, Array] = field(default_factory=dict)
    doubtful: dict[str, Array] = field(default_factory=dict)
    false: list[tuple[str, str]] = field(default_factory=list)
    true: list[tuple[str, str]] = field(default_factory=list)
    named: dict[str, bool] = field(default_factory=dict)
    bands: list[tuple[float, bool]] = field(default_factory=list)
    shown: dict[str, float] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)


def attend(
    seed: int,
    *,
    seconds: float = TRAINING,
    features: Sequence[str] = ("fit", "select", "check", "doctor"),
    mistakes: Iterable[str] = tuple(MISTAKES),
) -> Outcome:
    """Draw, simulate and identify one machine; the doctor sees the log with each of these mistakes."""
    outcome = Outcome(draw(seed))
    machine, leg = outcome.machine, outcome.machine.leg()
    training = simulate(machine, seconds)
    if "doctor" in features:
        for mistake in mistakes:
            _attempt(outcome, mistake, partial(_diagnose, outcome, leg, training.recording, mistake))
    if {"fit", "select", "check"}.isdisjoint(features):
        return outcome
    test = simulate(machine, TEST, test=True)
    fits: dict[str, Callable[[], exoid.Estimate]] = {}
    if "fit" in features:
        for name, form in {**forms(), "true form": (machine.terms(), "wls")}.items():
            fits[name] = partial(exoid.identify, leg, training.recording, *form, check=False)
    if "check" in features:
        for name in ESTIMATORS:
            fits[f"checked, {name}"] = partial(exoid.identify, leg, training.recording, estimator=name)
    if "select" in features:
        fits["joint by joint"] = lambda: select_terms(leg, training.recording).estimate
        true = machine.leg(believed=False)
        known = {
            name: x for name, x in zip(true.parameter_names, true.parameters.tolist(), strict=True) if name[0] == "Y"
        }
        if known:  # what a user knows of a planar machine with symmetric links
            fits["Y known"] = lambda: select_terms(leg, training.recording, known=known).estimate
    for name, fit in fits.items():
        estimate = _attempt(outcome, name, fit)
        if estimate is not None:
            outcome.nrmse[name] = error(machine, estimate, test)
            if name.startswith("checked"):
                _cover(outcome, name.removeprefix("checked, "), estimate, test)
    return outcome


def _cover(outcome: Outcome, estimator: str, estimate: exoid.Estimate, test: Log) -> None:
    """Note which intervals contain the truth, and which parameters are doubtful; findings and bands are judged once."""
    if estimator == ESTIMATORS[0]:
        judge(outcome, estimate.findings)
        outcome.bands = list(bands(outcome.machine, estimate, test))
    outcome.inside[estimator] = inside(outcome.machine, estimate)
    doubtful = {name for one in estimate.findings if one.severity != "info" for name in one.parameters}
    rigid = [name for name in estimate.names if name in estimate.leg.parameter_names]
    outcome.doubtful[estimator] = np.array([name in doubtful for name in rigid])


def bands(machine: Machine, estimate: exoid.Estimate, test: Log) -> Iterator[tuple[float, bool]]:
    """Judge the bands of the driven joints on another kind of motion."""
    found = exoid.validate(estimate, test.recording)
    warned = {one.joint for one in (*estimate.findings, *found.findings) if one.severity != "info"}
    for k, (name, joint) in enumerate(zip(machine.names, machine.joints, strict=True)):
        if not joint.passive:
            yield float(found.coverage[k]), not warned.isdisjoint({"", name, estimate.joint_names[k]})


def error(machine: Machine, estimate: exoid.Estimate, test: Log) -> float:
    """Mean NRMSE of the driven joints against what the torques truly were."""
    cutoff = min(8.0, 0.2 * machine.sensing.rate)
    in_time = replace(estimate, torque_delays=None)  # the truth is not late
    nrmse = exoid.validate(in_time, test.clean, cutoff=cutoff).nrmse
    return float(np.mean(nrmse[-len(machine.joints) :][[not joint.passive for joint in machine.joints]]))


def inside(machine: Machine, estimate: exoid.Estimate) -> Array:
    """Say which intervals of the rigid bodies contain the truth, with what rotors add to them."""
    leg = machine.leg(believed=False)
    known = dict(zip(leg.parameter_names, leg.parameters.tolist(), strict=True))
    for joint, label in zip(machine.joints, leg.joint_labels, strict=True):
        known[f"Ia_{label}"] = 0.0 if machine.sensing.torque == "sensor" else joint.rotor
    for regrouped in estimate.model.regrouped:
        for name, share in regrouped.into.items():
            if name in known:
                known[name] += share * known.get(regrouped.name, 0.0)
    rigid = [k for k, name in enumerate(estimate.names) if name in leg.parameter_names]
    true, (low, high) = np.array([known[estimate.names[k]] for k in rigid]), estimate.interval()[rigid].T
    return (low <= true) & (true <= high)


def judge(outcome: Outcome, findings: Iterable[exoid.Finding]) -> None:
    """Sort warnings and errors into those that the machine explains, and others."""
    sensing, machine = outcome.machine.sensing, outcome.machine
    heavier = max(cad.mass / body.mass for cad, body in zip(machine.believed[1:], machine.bodies, strict=True))
    laws = {joint.friction.kind for joint in machine.joints} | {joint.friction.transition for joint in machine.joints}
    lacking = not laws <= {"sharp", "smooth"}
    delay = sensing.delay - sensing.lag * (sensing.torque == "command")
    for finding in findings:
        if finding.severity == "info":
            continue
        low, high = finding.interval or (np.inf, -np.inf)
        near = low < delay < high or abs(finding.value - delay) < 1e-3
        warned = finding.severity == "warning"
        explained = (
            finding.kind == "unmodelled-friction"
            or (finding.kind == "torque-delay" and near and abs(delay) + 1e-9 > 1e-3)
            or (finding.kind == "torque-scale" and warned and heavier > 3.0)
            or (finding.kind == "large-residual" and warned and lacking)
        )
        (outcome.true if explained else outcome.false).append((finding.severity, finding.kind))


def _diagnose(outcome: Outcome, leg: exoid.Leg, recording: Recording, mistake: str) -> None:
    """See whether a mistake at some driven joint is named with that joint, or for all where all have it."""
    (spoil, kind), count = MISTAKES[mistake], recording.n_joints
    unseen = outcome.machine.floating and (kind in OF_MODEL or "angles" in mistake or "commands" in mistake)
    unseen |= (kind == "cross-talk" and not 1 < count <= 4) or (kind == "clock" and count < 3)
    unseen |= kind == "stale-samples" and recording.sample_rate < 100.0
    if unseen:
        return
    driven = [k for k, joint in enumerate(outcome.machine.joints) if not joint.passive]
    joint = driven[outcome.machine.seed % len(driven)]
    if kind == "unsigned-torque" and not 0.05 < np.mean(recording.tau[:, joint] < 0.0) < 0.95:
        return
    if kind == "gravity-compensated-effort":
        recording = without_gravity(outcome.machine, recording)
    machines = {"an elastic joint": elastic, "commands beyond the limit of a drive": beyond}
    spoiled = machines[mistake](outcome.machine, joint).recording if mistake in machines else spoil(recording, joint)
    found = exoid.check(leg, spoiled)
    name = recording.joint_names[joint]
    labels = {name, leg.joint_labels[joint]}
    # Of all, or of two joints of which only the ratio shows.
    if mistake.startswith(("all", "efforts", "torque clock", "sign of all", "clock", "60 ms", "log", "stamps")) or (
        kind == "torque-scale" and count == 2
    ):
        labels |= {"", *recording.joint_names}
    kinds = {kind}
    if kind == "angle-offset" and joint == 0:  # of the first joint it may be the direction of gravity
        kinds |= {"gravity-direction"}
        labels |= {""}
    if kind == "angle-sign" and joint == 0:  # of a mirrored leg, the sign of the first torque is as likely
        kinds |= {"torque-sign"}
    outcome.named[mistake] = any(f.kind in kinds and (f.joint in labels or name in f.message) for f in found)
    if not outcome.named[mistake] and isinstance(spoiled, Recording):
        growth = residuals(leg, spoiled) / residuals(leg, recording)
        outcome.shown[mistake] = float(growth[driven].max())


def residuals(leg: exoid.Leg, recording: Recording) -> Array:
    """RMS residual of each joint after a fit, over the spread of its torque."""
    estimate = exoid.identify(leg, recording, check=False)
    return estimate.residual_rms[-recording.n_joints :] / np.maximum(np.std(recording.tau, axis=0), 1e-9)


def _attempt(outcome: Outcome, name: str, do: Callable[[], object]) -> object:
    """Do something, with its processor time; None if exoid refuses."""
    begin = time.process_time()
    try:
        return do()
    except ExoidError as refusal:
        outcome.refused[name] = refusal.what
    except (ValueError, IndexError, TypeError, np.linalg.LinAlgError) as crash:  # of exoid: to be shown, not to stop at
        outcome.refused[name] = f"crash: {type(crash).__name__}: {crash}"
    finally:
        outcome.seconds[name] = time.process_time() - begin
    return None


def population(seeds: Iterable[int], *, workers: int = 1, **options: object) -> Iterable[Outcome]:
    """Attend many machines, as they are done."""
    if workers == 1:
        yield from map(partial(attend, **options), seeds)
        return
    with ProcessPoolExecutor(workers) as pool:
        for done in as_completed([pool.submit(attend, seed, **options) for seed in seeds]):
            yield done.result()


def best_for_all(outcome: Outcome) -> float:
    """Error of the best model for all joints, which nobody could know beforehand."""
    return min((outcome.nrmse[name] for name in forms() if name in outcome.nrmse), default=np.nan)
