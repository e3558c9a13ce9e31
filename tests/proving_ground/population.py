"""What exoid makes of many machines: error, coverage, findings true and false, and time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

import exoid
from exoid import ExoidError, Recording
from exoid.identification.selection import select_terms
from exoid.torques import Coulomb, LoadFriction, Stribeck, Term

from .friction import Array
from .machine import Machine, draw
from .simulate import Log, simulate

TRAINING, TEST = 12.0, 4.0
"""Seconds to learn from, and to be judged on."""

Form = tuple[tuple[Term, ...] | None, str]
"""Terms and estimator of one model for all joints."""


def forms() -> dict[str, Form]:
    """List models for all joints that selection joint by joint is compared with."""
    rest = (exoid.Viscous(), exoid.Armature(), exoid.Offset())
    models: dict[str, Form] = {"default": (None, "wls")}
    models["reversals kept"] = (Coulomb(), *rest), "wls"
    for length in (5e-5, 2e-4, 1e-3):
        models[f"presliding {1e3 * length:g} mrad"] = (Coulomb(presliding=length), *rest), "wls"
    bent = {"presliding": 2e-4}
    models["Stribeck"] = (Coulomb(**bent), Stribeck(velocity=0.1, **bent), *rest), "wls"
    models["load"] = (Coulomb(**bent), LoadFriction(**bent), *rest), "wls"
    models["default, huber"] = None, "huber"
    return models


def swap(recording: Recording, joint: int) -> Recording:
    """Swap the torques of a joint and of the one farthest from it."""
    count = recording.n_joints
    order, other = np.arange(count), count - 1 if joint < count / 2 else 0
    order[[joint, other]] = order[[other, joint]]
    return replace(recording, tau=recording.tau[:, order])


def late(recording: Recording, joint: int) -> Recording:
    """Make the torque of one joint 40 ms late."""
    tau, shift = recording.tau.copy(), round(0.04 * recording.sample_rate)
    tau[shift:, joint] = recording.tau[:-shift, joint]
    return replace(recording, tau=tau)


def turned(recording: Recording, joint: int) -> Recording:
    """Log the torque of one joint with the wrong sign."""
    tau = recording.tau.copy()
    tau[:, joint] *= -1.0
    return replace(recording, tau=tau)


def late_velocity(recording: Recording, joint: int) -> Recording:
    """Log velocities that are 5 ms late, as those of a filtered estimate are."""
    stamps = recording.time - 0.005
    v = np.gradient(recording.q, recording.time, axis=0)
    return replace(recording, v=np.column_stack([np.interp(stamps, recording.time, x) for x in v.T]))


MISTAKES: dict[str, tuple[Callable[[Recording, int], Recording], str]] = {
    "sign of one torque": (turned, "torque-sign"),
    "one torque 40 ms late": (late, "torque-delay"),
    "two far joints swapped": (swap, "joint-order"),
    "velocity 5 ms late": (late_velocity, "velocity-delay"),
}
"""Mistakes of a log, and the kind of finding that names them."""


@dataclass
class Outcome:
    """What came of one machine.

    Attributes:
        machine: The machine.
        nrmse: Mean NRMSE of the driven joints on the motion to be judged on, without errors of sensors, by model.
        seconds: Processor time by what was done [s].
        inside: Which 95 % intervals of the rigid bodies contain the truth.
        false: Findings of the log that nothing in the machine explains, as (severity, kind).
        true: Findings that the machine explains.
        named: Whether each mistake is named with the right joint, and whether the log without it is not.
        refused: What was refused, with the reason.
    """

    machine: Machine
    nrmse: dict[str, float] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    inside: Array = field(default_factory=lambda: np.zeros(0))
    false: list[tuple[str, str]] = field(default_factory=list)
    true: list[tuple[str, str]] = field(default_factory=list)
    named: dict[str, bool] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)


def attend(seed: int, *, seconds: float = TRAINING, features: Sequence[str] = ("fit", "select", "doctor")) -> Outcome:
    """Draw, simulate and identify one machine."""
    outcome = Outcome(draw(seed))
    machine, leg = outcome.machine, outcome.machine.leg()
    training = simulate(machine, seconds)
    if "doctor" in features:
        for mistake in MISTAKES:
            _attempt(outcome, mistake, partial(_diagnose, outcome, leg, training.recording, mistake))
    if {"fit", "select"}.isdisjoint(features):
        return outcome
    test = simulate(machine, TEST, test=True)
    fits: dict[str, Callable[[], exoid.Estimate]] = {}
    if "fit" in features:
        for name, form in {**forms(), "true form": (machine.terms(), "wls")}.items():
            fits[name] = partial(exoid.identify, leg, training.recording, *form, check=False)
        fits["checked"] = partial(exoid.identify, leg, training.recording)
    if "select" in features:
        fits["joint by joint"] = lambda: select_terms(leg, training.recording).estimate
    for name, fit in fits.items():
        estimate = _attempt(outcome, name, fit)
        if estimate is not None:
            outcome.nrmse[name] = error(machine, estimate, test)
            if name == "checked":
                outcome.inside = inside(machine, estimate)
                judge(outcome, estimate.findings)
    return outcome


def error(machine: Machine, estimate: exoid.Estimate, test: Log) -> float:
    """Mean NRMSE of the driven joints against what the torques truly were."""
    cutoff = min(8.0, 0.2 * machine.sensing.rate)
    nrmse = exoid.validate(estimate, test.clean, cutoff=cutoff).nrmse
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
    sensing = outcome.machine.sensing
    delay = sensing.delay - sensing.lag * (sensing.torque == "command")
    for finding in findings:
        if finding.severity == "info":
            continue
        explained = finding.kind == "unmodelled-friction" or (
            finding.kind == "torque-delay" and abs(finding.value - delay) < 1e-3 < abs(delay) + 1e-9
        )
        (outcome.true if explained else outcome.false).append((finding.severity, finding.kind))


def _diagnose(outcome: Outcome, leg: exoid.Leg, recording: Recording, mistake: str) -> None:
    """See whether a mistake at some driven joint is named with that joint, or for all where all have it."""
    spoil, kind = MISTAKES[mistake]
    driven = [k for k, joint in enumerate(outcome.machine.joints) if not joint.passive]
    joint = driven[outcome.machine.seed % len(driven)]
    found = exoid.check(leg, spoil(recording, joint))
    name = recording.joint_names[joint]
    labels = {"", name, leg.joint_labels[joint]}
    outcome.named[mistake] = any(f.kind == kind and (f.joint in labels or name in f.message) for f in found)


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
