"""Document 2 replayed: its identification at 0.05 Hz, why that cannot see inertia, and a motion that can."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from exoid import published
from exoid._typing import FloatArray
from exoid.catalog import load_leg
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.experiments import Bench, Harmonics, StaticProtocol, cuhk, run_motion, run_static
from exoid.identification import identify
from exoid.leg import Leg
from exoid.rig import DcMotor, Plant, Proportional, ProportionalDerivative, Rates, Sensors
from exoid.signals import MovingAverage, Poses, Preparation, Recording, ZeroPhase
from exoid.torques import Armature, Coulomb, Offset, Stiffness, Viscous

from .sequential import Known
from .sequential import cuhk as steps
from .torque_error import by_name, predicted_torque, torque_nrmse, torque_rmse, validation_rows

MOTOR = DcMotor(torque_constant=0.0705, ratio=50.0, rotor_inertia=3.2e-4, current_limit=15.0)
"""A 90 W flat motor behind a gear of 50: 0.8 kg·m² at the joint. PriorKnowledge, as the document names neither."""

SENSORS = Sensors(encoder_counts=2.0**13, angle_noise=np.deg2rad(0.03), velocity_noise=0.01, torque_noise=0.3)
"""Potentiometer behind a 13-bit converter, tachometer and current sensor; assumed."""

RATES = Rates(control=500.0, log=cuhk.LOG_RATE, step=1e-3)
AMPERES = 1.0 / (MOTOR.torque_constant * MOTOR.ratio)
"""Current for one newton metre at the joint [A/(N·m)]."""

DOCUMENT = Bench(Proportional(150.0 * AMPERES), MOTOR, SENSORS, RATES)
"""P control of 150 N·m/rad with the corrected sign, as document 2 identifies. The gain is assumed."""

SERVOS = {"document": (150.0, 0.0), "smooth": (150.0, 15.0), "tight": (2000.0, 200.0)}
"""Stiffness and damping of PD control [N·m/rad, N·m·s/rad]: the document's, a gentle one, one that tracks closely."""

SETTLE, DURATION = 2.0, 62.0
"""Of every motion [s]: what is left out at its start, and its end; the document's validation lasts one minute."""

STATIC = StaticProtocol(travel=4.0, wait=10.0)

KNEE_ONLY, HIP_ONLY = ("knee",), ("hip",)
TERMS = (
    Stiffness(degree=1, joints=KNEE_ONLY),
    Coulomb(),
    Viscous(),
    Armature(),
    Offset(joints=HIP_ONLY),
)
"""Of the estimate from the multisine; the knee's constant is its b0."""

WITHOUT_ROTOR = tuple(term for term in TERMS if not isinstance(term, Armature))
PREPARATION = ZeroPhase(cutoff=3.0)
"""Noise of a potentiometer, twice derived, would bias J1 by 40 % through a filter of 10 Hz."""

FIVEFOLD = 5.0
"""By how much J2 is changed to see whether a motion notices."""


@dataclass(frozen=True, eq=False)
class CuhkReplay:
    """One leg, identified by Table II and by a multisine.

    Attributes:
        leg: The anthropometric plant.
        truth: What the rig was made of; J1 contains the hip's rotor, which no motion tells from it.
        table_ii: By document 2's five steps and its exponential moving average.
        table_ii_zero_phase: By the same steps with a filter that does not lag.
        multisine: From a motion of 0.2 to 1 Hz.
        no_rotor: From the same without the rotor term.
        nrmse: Torque error on an independent multisine, (2,), of "table_ii", "multisine", "no_rotor" and "truth".
        blindness: Residual with J2 five times too large over that of the truth, (2,), on the document's
            validation motion ("document") and on the independent one ("multisine").
        validation: The document's validation motion.
        predicted: Torque of the multisine estimate on it [N·m], filtered like ``measured``, (N, 2).
        measured: Measured torque on it [N·m], (N, 2).
        seed: Of motions and noise.
    """

    leg: Leg
    truth: Mapping[str, float]
    table_ii: Known
    table_ii_zero_phase: Known
    multisine: Estimate
    no_rotor: Estimate
    nrmse: Mapping[str, FloatArray]
    blindness: Mapping[str, FloatArray]
    validation: Recording
    predicted: FloatArray
    measured: FloatArray
    seed: int


def truth_values() -> dict[str, float]:
    """Anthropometric bodies, Table III's friction magnitudes in dissipative sign, and rotors, by name."""
    rotor = {f"Ia_{joint}": MOTOR.armature for joint in ("hip", "knee")}
    return {**published.cuhk_parameters(), **published.cuhk_resistances(), **rotor}


def reproduce_cuhk(
    seed: int = 0,
    replicates: int = 1,
    progress: Callable[[float], None] | None = None,
    duration: float = DURATION,
) -> list[CuhkReplay]:
    """Run the experiments of document 2 on virtual rigs and identify.

    Args:
        seed: Of random poses, motions and sensor noise.
        replicates: How often everything is repeated with other noise, all at once.
        progress: Told the share that is done.
        duration: Of every motion [s].

    Returns:
        One replay for each replicate.

    Raises:
        ExoidError: There are no replicates, or the duration is too short.
    """
    if replicates < 1:
        raise ExoidError(f"{replicates} replicates", remedy="ask for at least one")
    if not SETTLE < duration < np.inf:
        raise ExoidError(f"motions of {duration:g} s", remedy=f"measure longer than {SETTLE:g} s")
    told = progress or (lambda _: None)
    rng = np.random.default_rng(seed)
    leg = load_leg("cuhk")
    plant = Plant.build(leg, truth_values()).repeat(replicates)
    poses = [run_static(plant, p, DOCUMENT, rng, STATIC) for p in (cuhk.stiffness_poses(), cuhk.random_poses(rng))]
    told(0.2)
    motions = {
        "row 3": ("document", cuhk.swing(cuhk.HIP)),
        "row 4": ("document", cuhk.swing(cuhk.KNEE)),
        "row 5": ("document", cuhk.swing(cuhk.HIP)),
        "document": ("tight", cuhk.validation_motion()),
        "rich": ("smooth", cuhk.multisine(leg, rng)),
        "independent": ("smooth", cuhk.multisine(leg, rng, draws=20)),
    }
    logs = _record(plant, motions, duration, rng, lambda share: told(0.2 + 0.75 * share))
    replays = []
    for k in range(replicates):
        static = [both[k].averaged for both in poses]
        replays.append(_replay(leg, static, {name: of_motion[k] for name, of_motion in logs.items()}, seed))
    told(1.0)
    return replays


def _replay(leg: Leg, static: list[Poses], logs: Mapping[str, Recording], seed: int) -> CuhkReplay:
    """Identify the leg in all ways and compare."""
    rich, independent, document = logs["rich"], logs["independent"], logs["document"]
    estimate = identify(leg, rich, TERMS, preparation=PREPARATION)
    no_rotor = identify(leg, rich, WITHOUT_ROTOR, preparation=PREPARATION)
    late, unlagged = (_table_ii(leg, static, logs, way) for way in (MovingAverage(), ZeroPhase()))
    truth = truth_values()
    truth["J1"] += truth.pop("Ia_hip")
    model = estimate.model
    models = {"table_ii": late.as_dict(), "multisine": by_name(estimate), "no_rotor": by_name(no_rotor), "truth": truth}
    wrong = {**truth, "J2": FIVEFOLD * truth["J2"]}
    rows = validation_rows(model, document)
    return CuhkReplay(
        leg=leg,
        truth=truth,
        table_ii=late,
        table_ii_zero_phase=unlagged,
        multisine=estimate,
        no_rotor=no_rotor,
        nrmse={name: torque_nrmse(model, values, independent) for name, values in models.items()},
        blindness={
            name: torque_rmse(model, wrong, motion) / torque_rmse(model, truth, motion)
            for name, motion in (("document", document), ("multisine", independent))
        },
        validation=document,
        predicted=predicted_torque(model, by_name(estimate), rows),
        measured=rows.tau,
        seed=seed,
    )


def _table_ii(leg: Leg, static: list[Poses], logs: Mapping[str, Recording], way: Preparation) -> Known:
    """Do document 2's five steps."""
    model = steps.document_model(leg)
    known = steps.knee_stiffness(model, Known(), static[0])
    known = steps.mass_moments(model, known, static[1])
    known = steps.inertias(model, known, logs["row 3"], way)
    known = steps.damping(model, known, logs["row 4"], steps.KNEE, way)
    return steps.damping(model, known, logs["row 5"], steps.HIP, way)


def _record(
    plant: Plant,
    motions: Mapping[str, tuple[str, Harmonics]],
    duration: float,
    rng: np.random.Generator,
    told: Callable[[float], None],
) -> dict[str, list[Recording]]:
    """Run every motion under its servo, all side by side; logs by motion and rig."""
    count, servos = plant.count, np.array([SERVOS[servo] for servo, _ in motions.values()])
    stiffness, damping = np.repeat(servos.T * AMPERES, count, axis=1)
    bench = Bench(ProportionalDerivative(stiffness[None], damping[None]), MOTOR, SENSORS, RATES)
    run = run_motion(
        Plant.concatenate([plant] * len(motions)),
        Harmonics.concatenate([motion.tile(count) for _, motion in motions.values()]),
        bench,
        duration,
        rng,
        told,
    )
    return {
        name: [
            run.recording(m * count + k, velocity=servo == "document").between(SETTLE, duration) for k in range(count)
        ]
        for m, (name, (servo, _)) in enumerate(motions.items())
    }
