"""Replay of document 2: its identification at 0.05 Hz, which hardly excites the inertias, and a multisine that does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.control.standard_laws import SENSORS
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate
from exoid.experiments import Bench, Harmonics, StaticProtocol, cuhk, run_static
from exoid.experiments.bench import run_motion
from exoid.identification import identify
from exoid.leg.catalog import load_leg
from exoid.leg.leg import Leg
from exoid.leg.published import cuhk_parameters, cuhk_resistances
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates
from exoid.signals import MovingAverage, Poses, Preparation, Recording, ZeroPhase
from exoid.tools.json_values import named
from exoid.torques import Armature, Coulomb, Offset, Stiffness, Viscous

from .sequential import cuhk as steps
from .sequential.estimate import SequentialEstimate
from .torque_error import predicted_torque, torque_nrmse, validation_rows

MOTOR, ROTOR = IdealTorque(limit=52.875), 0.8
"""Assumed flat motor of 90 W with gear ratio 50 at up to 15 A, and its rotor at the joint [kg·m²]; none is printed."""

RATES = Rates(control=500.0, log=cuhk.LOG_RATE, step=1e-3)
"""Rates of controller and log, and step of the plant."""

SERVOS = {"document": (150.0, 0.0), "smooth": (150.0, 15.0), "tight": (2000.0, 200.0)}
"""Gains Kp and Kd of the servos [N·m/rad, N·m·s/rad]."""

SETTLE, DURATION = 2.0, 62.0
"""Initial part of every motion that is left out, and its end [s]; the document's validation lasts one minute."""

SMOOTH = Coulomb(smoothing=0.02, reversal_speed=0.0)  # as the joints of the rig
TERMS = (Stiffness(degree=1, joints=("knee",)), SMOOTH, Viscous(), Armature(), Offset(joints=("hip",)))
"""Terms of the estimate from the multisine; b0 is the constant torque of the knee."""

PREPARATION = ZeroPhase(cutoff=3.0)
"""Preparation of the multisine; with a cut-off of 10 Hz the noise of the acceleration would bias J1 by 40 %."""

J2_FACTOR = 5.0
"""Factor of J2 in the test whether the residual of a motion depends on J2."""


@dataclass(frozen=True, eq=False, repr=False)
class CuhkReplay:
    """One leg, identified by Table II and by a multisine."""

    leg: Leg  # leg of the anthropometric plant
    # true parameters of the rig by name; J1 includes the rotor of the hip, as no motion separates the two
    truth: Mapping[str, float]
    table_ii: SequentialEstimate  # estimate by document 2's five steps and its exponential moving average
    table_ii_zero_phase: SequentialEstimate  # estimate by the same steps with a filter without delay
    multisine: Estimate  # estimate from a motion of 0.2 to 1 Hz
    no_rotor: Estimate  # estimate from the same motion without the rotor term
    # torque error of "table_ii", "multisine", "no_rotor" and "truth" on an independent multisine, (2,) each
    nrmse: Mapping[str, FloatArray]
    # residual with J2 five times too large over that of the truth, (2,) each, on the document's validation
    # motion ("document") and on the independent multisine ("multisine")
    residual_ratio: Mapping[str, FloatArray]
    validation: Recording  # recording of the document's validation motion
    predicted: FloatArray  # torque of the multisine estimate on `validation` [N·m], filtered like `measured`, (N, 2)
    measured: FloatArray  # measured torque on `validation` [N·m], (N, 2)
    seed: int  # seed of motions and noise


def truth_values() -> dict[str, float]:
    """Return the true parameters by name: anthropometric bodies, friction of Table III made dissipative, rotors."""
    rotor = {f"Ia_{joint}": ROTOR for joint in ("hip", "knee")}
    return {**cuhk_parameters(), **cuhk_resistances(), **rotor}


def reproduce_cuhk(
    seed: int = 0,
    replicates: int = 1,
    progress: Callable[[float], None] | None = None,
    duration: float = DURATION,
) -> list[CuhkReplay]:
    """Run the experiments of document 2 on virtual rigs and identify.

    Args:
        seed: Seed of random poses, motions and sensor noise.
        replicates: Number of replicates with independent noise.
        progress: Function that receives the completed share, 0 to 1.
        duration: Duration of every motion [s].

    Returns:
        One replay for each replicate.

    Raises:
        ExoidError: The number of replicates is below one, or the duration is too short.
    """
    if replicates < 1:
        raise BadArgumentError(f"{replicates} replicates", remedy="request at least one")
    if not SETTLE < duration < np.inf:
        raise BadArgumentError(f"motions of {duration:g} s", remedy=f"measure longer than {SETTLE:g} s")
    report = progress or (lambda _: None)
    rng = np.random.default_rng(seed)
    leg = load_leg("cuhk")
    plant = Plant.build(leg, truth_values()).repeat(replicates)
    # P control of document 2 with the corrected sign and an assumed gain
    bench = Bench(ProportionalDerivative(SERVOS["document"][0]), MOTOR, SENSORS, RATES)
    approach = StaticProtocol(travel=4.0, wait=10.0)
    poses = [run_static(plant, p, bench, rng, approach) for p in (cuhk.stiffness_poses(), cuhk.random_poses(rng))]
    report(0.2)
    motions = {
        "row 3": ("document", cuhk.swing(cuhk.HIP)),
        "row 4": ("document", cuhk.swing(cuhk.KNEE)),
        "row 5": ("document", cuhk.swing(cuhk.HIP)),
        "document": ("tight", cuhk.validation_motion()),
        "rich": ("smooth", cuhk.multisine(leg, rng)),
        "independent": ("smooth", cuhk.multisine(leg, rng, draws=20)),
    }
    logs = _record(plant, motions, duration, rng, lambda share: report(0.2 + 0.75 * share))
    replays = []
    for k in range(replicates):
        static = [both[k].averaged for both in poses]
        replays.append(_replay(leg, static, {name: of_motion[k] for name, of_motion in logs.items()}, seed))
    report(1.0)
    return replays


def identify_cuhk(seed: int = 0, progress: Callable[[float], None] | None = None) -> Estimate:
    """Identify the leg from a multisine, without the experiments of Table II."""
    rng, leg = np.random.default_rng(seed), load_leg("cuhk")
    motions = {"rich": ("smooth", cuhk.multisine(leg, rng))}
    plant = Plant.build(leg, truth_values())
    log = _record(plant, motions, DURATION, rng, progress or (lambda _: None))["rich"][0]
    return identify(leg, log, TERMS, preparation=PREPARATION)


def truth_with_rotor() -> dict[str, float]:
    """Return the true parameters by name, the rotor of the hip merged into J1, as no motion separates the two."""
    truth = truth_values()
    truth["J1"] += truth.pop("Ia_hip")
    return truth


def _replay(leg: Leg, static: list[Poses], logs: Mapping[str, Recording], seed: int) -> CuhkReplay:
    """Identify the leg by all methods and compare."""
    rich, independent, document = logs["rich"], logs["independent"], logs["document"]
    estimate = identify(leg, rich, TERMS, preparation=PREPARATION)
    without_rotor = tuple(term for term in TERMS if not isinstance(term, Armature))
    no_rotor = identify(leg, rich, without_rotor, preparation=PREPARATION)
    delayed, zero_phase = (_table_ii(leg, static, logs, each) for each in (MovingAverage(), ZeroPhase()))
    truth, model = truth_with_rotor(), estimate.model
    models = {
        "table_ii": delayed.as_dict(),
        "multisine": named(model.names, estimate.values),
        "no_rotor": named(no_rotor.names, no_rotor.values),
        "truth": truth,
    }
    wrong = {**truth, "J2": J2_FACTOR * truth["J2"]}
    rows = validation_rows(model, document)
    return CuhkReplay(
        leg=leg,
        truth=truth,
        table_ii=delayed,
        table_ii_zero_phase=zero_phase,
        multisine=estimate,
        no_rotor=no_rotor,
        nrmse={name: torque_nrmse(model, values, independent) for name, values in models.items()},
        residual_ratio={
            name: torque_nrmse(model, wrong, motion) / torque_nrmse(model, truth, motion)
            for name, motion in (("document", document), ("multisine", independent))
        },
        validation=document,
        predicted=predicted_torque(model, named(model.names, estimate.values), rows),
        measured=rows.tau,
        seed=seed,
    )


def _table_ii(
    leg: Leg, static: list[Poses], logs: Mapping[str, Recording], preparation: Preparation
) -> SequentialEstimate:
    """Identify by document 2's five steps."""
    model = steps.document_model(leg)
    known = steps.knee_stiffness(model, SequentialEstimate(), static[0])
    known = steps.mass_moments(model, known, static[1])
    known = steps.inertias(model, known, logs["row 3"], preparation)
    known = steps.damping(model, known, logs["row 4"], steps.KNEE, preparation)
    return steps.damping(model, known, logs["row 5"], steps.HIP, preparation)


def _record(
    plant: Plant,
    motions: Mapping[str, tuple[str, Harmonics]],
    duration: float,
    rng: np.random.Generator,
    report: Callable[[float], None],
) -> dict[str, list[Recording]]:
    """Run every motion under its servo in one simulation; return the logs of all rigs by motion."""
    count, servos = plant.count, np.array([SERVOS[servo] for servo, _ in motions.values()])
    stiffness, damping = np.repeat(servos.T, count, axis=1)
    bench = Bench(ProportionalDerivative(stiffness[None], damping[None]), MOTOR, SENSORS, RATES)
    run = run_motion(
        Plant.concatenate([plant] * len(motions)),
        Harmonics.concatenate([motion for _, motion in motions.values() for _ in range(count)]),
        bench,
        duration,
        rng,
        report,
    )
    return {
        name: [
            run.recording(m * count + k, velocity=servo == "document").between(SETTLE, duration) for k in range(count)
        ]
        for m, (name, (servo, _)) in enumerate(motions.items())
    }
