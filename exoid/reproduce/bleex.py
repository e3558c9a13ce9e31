"""Document 1 replayed: experiments on a virtual BLEEX, the document's identification, and what beats it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from exoid import published
from exoid._typing import FloatArray
from exoid.catalog import load_leg
from exoid.experiments import Bench, bleex, refuse_motion_beyond_limits, run_static
from exoid.identification import Estimate, identify
from exoid.identification.rows import make_rows
from exoid.identification.sequential import Known
from exoid.identification.sequential import bleex as steps
from exoid.leg import Leg
from exoid.rig import HydraulicServo, Plant, Proportional, Rates, Run, Sensors, simulate
from exoid.signals import Approaches, Poses, Recording, Smoothed, ZeroPhase
from exoid.torques import Coulomb, Stiffness, TorqueModel

SIDES = ("left", "right")

HIDDEN_HIP: Mapping[str, Mapping[str, float]] = {
    "left": {"b2_hip": -0.6, "b1_hip": -1.9, "b0_hip": -0.3, "c0_hip": 0.5},
    "right": {"b2_hip": -1.2, "b1_hip": -2.2, "b0_hip": 0.4, "c0_hip": 0.45},
}
"""Assumed: the document takes hip stiffness and friction as zero, but sees no reason why they should be."""

BENCH = Bench(
    controller=Proportional(1.0),
    actuator=HydraulicServo(stiffness=5000.0, leakage=0.01, valve_gain=10.0),
    sensors=Sensors(encoder_counts=2.0**16, torque_noise=(0.3, 0.2, 0.1)),
    rates=Rates(control=500.0, log=bleex.LOG_RATE, step=1e-3),
)
"""Servo of 10 1/s bandwidth and 1000 N·m/rad static stiffness; sensors as assumed for the replay."""

COARSE_COUNTS = 2.0**12
"""Of an encoder with which raw second differences fail."""

SETTLE, DURATION = 2.0, 22.0
"""Of the dynamic experiments [s]: whole periods remain after the start."""

TILTS = (-30.0, 30.0)
"""Of the torso [deg], which document 1 proposes for the hip's stiffness and did not do."""

TILTED_POSES = 100

JOINT_TERMS = (Stiffness(), Coulomb(smoothing=0.0, dead_band=0.15))
"""Of the joint estimate; samples near a reversal are left out, never filtered across it."""

JOINT_PREPARATION = Smoothed(cutoff=8.0)

VALIDATION_FILTER = ZeroPhase(cutoff=5.0)


@dataclass(frozen=True, eq=False)
class Data:
    """What was measured on one leg.

    Attributes:
        sets: The poses that were asked for.
        upright: Approached from both sides, torso upright, in the order of ``sets.all``.
        tilted: Averaged poses at each torso tilt.
        swings: Recordings of the swinging hip, knee and ankle at five frequencies each.
        validation: All joints in motion.
        coarse: Swings as an encoder of 2^12 counts would have logged them.
    """

    sets: bleex.StaticSets
    upright: Approaches
    tilted: tuple[Poses, ...]
    swings: tuple[tuple[Recording, ...], ...]
    validation: Recording
    coarse: tuple[tuple[Recording, ...], ...]


@dataclass(frozen=True, eq=False)
class SideReplay:
    """One leg, identified in several ways.

    Attributes:
        leg: With CAD inertias.
        truth: What the rig was made of.
        data: What was measured.
        sequential: By the document's procedure.
        one_sided: By the same from A⁺ alone, without averaging.
        coarse: By the same with an encoder of 2^12 counts.
        joint: All rows at once, torso tilts included.
        upright_condition: Condition number of the same without the tilts.
        cad: Table V, without friction and stiffness.
        nrmse: Torque error on the validation motion of each of "sequential", "joint", "cad" and "truth", (3,).
    """

    leg: Leg
    truth: Mapping[str, float]
    data: Data
    sequential: Known
    one_sided: Known
    coarse: Known
    joint: Estimate
    upright_condition: float
    cad: Mapping[str, float]
    nrmse: Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class Replay:
    """Both legs.

    Attributes:
        left: Left leg.
        right: Right leg.
        seed: Of poses and noise.
    """

    left: SideReplay
    right: SideReplay
    seed: int


def truth_of(side: str) -> dict[str, float]:
    """Tables I to IV of one side in exoid's signs, and the hidden hip."""
    return {**published.bleex_parameters(side), **published.bleex_resistances(side), **HIDDEN_HIP[side]}


def reproduce_bleex(
    seed: int = 0, replicates: int = 1, progress: Callable[[float], None] | None = None
) -> list[Replay]:
    """Run all experiments of document 1 on virtual rigs and identify both legs.

    Args:
        seed: Of random poses and sensor noise.
        replicates: How often everything is repeated with other noise, all at once.
        progress: Told the share that is done.

    Returns:
        One replay for each replicate.
    """
    told = progress or (lambda _: None)
    rng = np.random.default_rng(seed)
    measured = {side: _measure(side, rng, replicates, told, k / 2.0) for k, side in enumerate(SIDES)}
    replays = []
    for k in range(replicates):
        left, right = (_identify_side(side, measured[side][k]) for side in SIDES)
        replays.append(Replay(left, right, seed))
    told(1.0)
    return replays


def _measure(
    side: str, rng: np.random.Generator, replicates: int, told: Callable[[float], None], done: float
) -> list[Data]:
    """Run the experiments of one leg."""
    leg = load_leg("bleex", side=side)
    truth = truth_of(side)
    plant = Plant.build(leg, truth).each(replicates)
    sets = bleex.static_sets(rng)
    upright = run_static(plant, sets.all, BENCH, rng)
    tilted = []
    for tilt in TILTS:
        poses = bleex.static_sets(rng, TILTED_POSES).random
        leaning = Plant.build(leg, truth, pitch=np.deg2rad(tilt)).each(replicates)
        tilted.append([both.averaged for both in run_static(leaning, poses, BENCH, rng)])
    motions = bleex.dynamic_motions()
    refuse_motion_beyond_limits(leg, motions, DURATION)
    rigs = bleex.VALIDATION + 1
    run = simulate(
        plant.each(rigs),
        motions.each(replicates),
        BENCH.controller,
        BENCH.actuator,
        DURATION,
        sensors=BENCH.sensors,
        rates=BENCH.rates,
        seed=rng,
        progress=lambda share: told(done + 0.45 * share),
    )
    coarse = _coarser(run, rng)
    return [
        Data(
            sets,
            upright[k],
            tuple(poses[k] for poses in tilted),
            _swings(run, k * rigs),
            _log(run, k * rigs + bleex.VALIDATION),
            _swings(coarse, k * rigs),
        )
        for k in range(replicates)
    ]


def _identify_side(side: str, data: Data) -> SideReplay:
    """Identify one leg in all ways."""
    leg = load_leg("bleex", side=side)
    model = steps.document_model(leg)
    recordings = [recording for swings in data.swings for recording in swings]
    upright = data.upright.averaged
    joint = identify(leg, [upright, *data.tilted, *recordings], JOINT_TERMS, preparation=JOINT_PREPARATION)
    no_tilt = identify(leg, [upright, *recordings], JOINT_TERMS, preparation=JOINT_PREPARATION)
    sequential = sequential_bleex(model, data.sets, upright, data.swings)
    cad = published.bleex_parameters("cad")
    truth = truth_of(side)
    predictions = {
        "sequential": sequential.as_dict(),
        "joint": dict(zip(joint.names, joint.values.tolist(), strict=True)),
        "cad": cad,
        "truth": truth,
    }
    return SideReplay(
        leg=leg,
        truth=truth,
        data=data,
        sequential=sequential,
        one_sided=sequential_bleex(model, data.sets, data.upright.below, data.swings),
        coarse=sequential_bleex(model, data.sets, upright, data.coarse),
        joint=joint,
        upright_condition=no_tilt.condition_number,
        cad=cad,
        nrmse={name: torque_nrmse(model, values, data.validation) for name, values in predictions.items()},
    )


def sequential_bleex(
    model: TorqueModel, sets: bleex.StaticSets, poses: Poses, swings: tuple[tuple[Recording, ...], ...]
) -> Known:
    """All steps of document 1 in its order: ankle, knee and hip statics, then inertias, then kinetic friction.

    Args:
        model: Of :func:`exoid.identification.sequential.bleex.document_model`.
        sets: The poses asked for.
        poses: What was measured there, in the order of ``sets.all``.
        swings: Recordings of the swinging hip, knee and ankle.
    """
    ends = np.cumsum([len(sets.ankle), len(sets.knee), len(sets.pairs), len(sets.random)])
    ankle, knee, pairs, random = (
        Poses(q, tau, poses.joint_names)
        for q, tau in zip(np.split(poses.q, ends[:-1]), np.split(poses.tau, ends[:-1]), strict=True)
    )
    known = steps.stiffness_shape(model, Known(), ankle, sets.ankle_set, steps.ANKLE)
    known = steps.ankle_offset(model, known, pairs)
    known = steps.mass_moments(model, known, random, steps.ANKLE)
    known = steps.stiffness_shape(model, known, knee, sets.knee_set, steps.KNEE)
    known = steps.mass_moments(model, known, random, steps.KNEE)
    known = steps.mass_moments(model, known, random, steps.HIP)
    known = steps.inertia(model, known, swings[steps.KNEE], 3)
    known = steps.inertia(model, known, swings[steps.HIP], 2)
    known = steps.inertia(model, known, swings[steps.HIP], 1)
    known = steps.kinetic_friction(model, known, swings[steps.ANKLE], steps.ANKLE)
    return steps.kinetic_friction(model, known, swings[steps.KNEE], steps.KNEE)


def torque_nrmse(model: TorqueModel, values: Mapping[str, float], recording: Recording) -> FloatArray:
    """RMS torque error over the standard deviation of the measured torque, both 5 Hz zero-phase, (n,)."""
    rows = make_rows(model, recording, VALIDATION_FILTER)
    predicted = rows.W @ np.array([values.get(name, 0.0) for name in model.names])
    return np.asarray(np.sqrt(np.mean((rows.tau - predicted) ** 2, axis=0)) / rows.tau.std(axis=0))


def _log(run: Run, rig: int) -> Recording:
    return run.recording(rig).between(SETTLE, DURATION)


def _swings(run: Run, first: int) -> tuple[tuple[Recording, ...], ...]:
    frequencies = range(len(bleex.FREQUENCIES))
    return tuple(tuple(_log(run, first + bleex.swing(joint, k)) for k in frequencies) for joint in range(3))


def _coarser(run: Run, rng: np.random.Generator) -> Run:
    """Log the same run once more, with coarse encoders."""
    sensors = Sensors(encoder_counts=COARSE_COUNTS)
    q = np.array([sensors.angle(sample, rng) for sample in run.q])
    return Run(run.plant, run.time, run.q, run.v, run.tau, q, run.v_measured, run.tau_measured, run.target, run.energy)
