"""Document 2 replayed: its identification at 0.05 Hz, why that cannot see inertia, and a motion that can."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from exoid import published
from exoid._typing import FloatArray
from exoid.catalog import load_leg
from exoid.experiments import Bench, StaticProtocol, cuhk, run_static
from exoid.experiments.references import Harmonics
from exoid.identification import Estimate, identify
from exoid.identification.rows import make_rows
from exoid.identification.sequential import Known
from exoid.identification.sequential import cuhk as steps
from exoid.leg import Leg
from exoid.rig import DcMotor, Plant, Proportional, ProportionalDerivative, Rates, Sensors, simulate
from exoid.signals import MovingAverage, Poses, Preparation, Recording, ZeroPhase
from exoid.torques import Armature, Coulomb, Offset, Stiffness, TorqueModel, Viscous

MOTOR = DcMotor(torque_constant=0.0705, ratio=50.0, rotor_inertia=3.2e-4, current_limit=15.0)
"""A 90 W flat motor behind a gear of 50: 0.8 kg·m² at the joint. Assumed, as the document names neither."""

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
"""Of every motion [s]; the document's validation lasts one minute."""

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

VALIDATION_FILTER = ZeroPhase(cutoff=5.0)
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
        blindness: Residual with J2 five times too large over that of the truth, (2,), on the document's validation
        motion
            ("document") and on the independent one ("multisine").
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
    seed: int = 0, replicates: int = 1, progress: Callable[[float], None] | None = None
) -> list[CuhkReplay]:
    """Run the experiments of document 2 on virtual rigs and identify.

    Args:
        seed: Of random poses, motions and sensor noise.
        replicates: How often everything is repeated with other noise, all at once.
        progress: Told the share that is done.

    Returns:
        One replay for each replicate.
    """
    told = progress or (lambda _: None)
    rng = np.random.default_rng(seed)
    leg = load_leg("cuhk")
    plant = Plant.build(leg, truth_values()).each(replicates)
    poses = [run_static(plant, p, DOCUMENT, rng, STATIC) for p in (cuhk.stiffness_poses(), cuhk.random_poses(rng))]
    motions = {
        "hip": ("document", cuhk.swing(0)),
        "knee": ("document", cuhk.swing(1)),
        "document": ("tight", cuhk.validation_motion()),
        "rich": ("smooth", cuhk.multisine(leg, rng)),
        "independent": ("smooth", cuhk.multisine(leg, rng, draws=20)),
    }
    logs = _record(plant, motions, rng, told)
    replays = []
    for k in range(replicates):
        first, second = (static[k].averaged for static in poses)
        model = steps.document_model(leg)
        by_steps = {
            way.name: _table_ii(model, first, second, [logs["hip"][k], logs["knee"][k]], way)
            for way in (MovingAverage(), ZeroPhase())
        }
        rich, independent, document = (logs[name][k] for name in ("rich", "independent", "document"))
        replays.append(_replay(leg, by_steps, rich, independent, document, seed))
    told(1.0)
    return replays


def _replay(
    leg: Leg, by_steps: Mapping[str, Known], rich: Recording, independent: Recording, document: Recording, seed: int
) -> CuhkReplay:
    estimate = identify(leg, rich, TERMS, preparation=PREPARATION)
    no_rotor = identify(leg, rich, WITHOUT_ROTOR, preparation=PREPARATION)
    truth = truth_values()
    truth["J1"] += truth.pop("Ia_hip")
    model = estimate.model
    predictions = {
        "table_ii": by_steps["moving-average"].as_dict(),
        "multisine": dict(zip(estimate.names, estimate.values.tolist(), strict=True)),
        "no_rotor": dict(zip(no_rotor.names, no_rotor.values.tolist(), strict=True)),
        "truth": truth,
    }
    wrong = {**truth, "J2": FIVEFOLD * truth["J2"]}
    motions = {"document": document, "multisine": independent}
    blindness = {name: _rmse(model, wrong, motion) / _rmse(model, truth, motion) for name, motion in motions.items()}
    rows = make_rows(model, document, VALIDATION_FILTER)
    spread = make_rows(model, independent, VALIDATION_FILTER).tau.std(axis=0)
    return CuhkReplay(
        leg=leg,
        truth=truth,
        table_ii=by_steps["moving-average"],
        table_ii_zero_phase=by_steps["zero-phase"],
        multisine=estimate,
        no_rotor=no_rotor,
        nrmse={name: _rmse(model, values, independent) / spread for name, values in predictions.items()},
        blindness=blindness,
        validation=document,
        predicted=rows.W @ estimate.values,
        measured=rows.tau,
        seed=seed,
    )


def _table_ii(model: TorqueModel, first: Poses, second: Poses, swings: list[Recording], way: Preparation) -> Known:
    known = steps.knee_stiffness(model, Known(), first)
    known = steps.mass_moments(model, known, second)
    known = steps.inertias(model, known, swings[steps.HIP], way)
    known = steps.damping(model, known, swings[steps.KNEE], steps.KNEE, way)
    return steps.damping(model, known, swings[steps.HIP], steps.HIP, way)


def _record(
    plant: Plant,
    motions: Mapping[str, tuple[str, Harmonics]],
    rng: np.random.Generator,
    told: Callable[[float], None],
) -> dict[str, list[Recording]]:
    """Run every motion under its servo, all side by side; logs by motion and rig."""
    count, servos = plant.count, np.array([SERVOS[servo] for servo, _ in motions.values()])
    stiffness, damping = np.repeat(servos.T * AMPERES, count, axis=1)
    run = simulate(
        Plant.join([plant] * len(motions)),
        Harmonics.join([motion.each(count) for _, motion in motions.values()]),
        ProportionalDerivative(stiffness[None], damping[None]),
        MOTOR,
        DURATION,
        sensors=SENSORS,
        rates=RATES,
        seed=rng,
        progress=told,
    )
    return {
        name: [
            run.recording(m * count + k, velocity=servo == "document").between(SETTLE, DURATION) for k in range(count)
        ]
        for m, (name, (servo, _)) in enumerate(motions.items())
    }


def _rmse(model: TorqueModel, values: Mapping[str, float], recording: Recording) -> FloatArray:
    """RMS torque error of parameters by name, both torques 5 Hz zero-phase [N·m], (n,)."""
    rows = make_rows(model, recording, VALIDATION_FILTER)
    predicted = rows.W @ np.array([values.get(name, 0.0) for name in model.names])
    return np.asarray(np.sqrt(np.mean((rows.tau - predicted) ** 2, axis=0)))
