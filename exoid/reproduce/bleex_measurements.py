"""What the virtual BLEEX is made of, and what the experiments of document 1 measure on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from exoid import published
from exoid.catalog import load_leg
from exoid.errors import ExoidError
from exoid.experiments import Bench, StaticProtocol, bleex, run_motion, run_static
from exoid.rig import HydraulicServo, Plant, Proportional, Rates, Run, Sensors
from exoid.signals import Approaches, Poses, Recording

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

STATIC = StaticProtocol(readings=25)

COARSE_COUNTS = 2.0**12
"""Of an encoder with which raw second differences fail."""

SETTLE = 2.0
"""Start of a dynamic experiment that is left out [s]."""

TILTS = (-30.0, 30.0)
"""Of the torso [deg], which document 1 proposes for the hip's stiffness and did not do."""


@dataclass(frozen=True)
class Extent:
    """How much is measured.

    Attributes:
        duration: Of every motion [s]; after :data:`SETTLE`, whole periods of all frequencies remain of 22 s.
        poses: Random ones, upright and at each tilt (sec. III-E).
    """

    duration: float = 22.0
    poses: int = 100

    def __post_init__(self) -> None:
        """Check that something is left."""
        if not (SETTLE < self.duration < np.inf and self.poses >= 1):
            raise ExoidError(f"{self}", remedy=f"measure longer than {SETTLE:g} s and at least one pose")


@dataclass(frozen=True, eq=False)
class Measurements:
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


def truth_of(side: str) -> dict[str, float]:
    """Tables I to IV of one side in exoid's signs, and the hidden hip."""
    return {**published.bleex_parameters(side), **published.bleex_resistances(side), **HIDDEN_HIP[side]}


def measure_bleex(
    side: str, rng: np.random.Generator, replicates: int, extent: Extent, told: Callable[[float], None]
) -> list[Measurements]:
    """Run the experiments of one leg.

    Args:
        side: "left" or "right".
        rng: Of random poses and sensor noise.
        replicates: Rigs that do the same side by side, with noise of their own.
        extent: How much is measured.
        told: Told the share that is done.

    Returns:
        One set of measurements for each replicate.
    """
    leg, truth = load_leg("bleex", side=side), truth_of(side)
    plant = Plant.build(leg, truth).repeat(replicates)
    sets = bleex.static_sets(rng, extent.poses)
    upright = run_static(plant, sets.all, BENCH, rng, STATIC)
    told(0.2)
    tilted = []
    for tilt in TILTS:
        poses = bleex.static_sets(rng, extent.poses).random
        leaning = Plant.build(leg, truth, pitch=np.deg2rad(tilt)).repeat(replicates)
        tilted.append([both.averaged for both in run_static(leaning, poses, BENCH, rng, STATIC)])
    told(0.4)
    rigs = bleex.VALIDATION + 1
    run = run_motion(
        plant.repeat(rigs),
        bleex.dynamic_motions().tile(replicates),
        BENCH,
        extent.duration,
        rng,
        progress=lambda share: told(0.4 + 0.6 * share),
    )
    coarse = _coarser(run, rng)
    return [
        Measurements(
            sets,
            upright[k],
            tuple(poses[k] for poses in tilted),
            _swings(run, k * rigs),
            _log(run, k * rigs + bleex.VALIDATION),
            _swings(coarse, k * rigs),
        )
        for k in range(replicates)
    ]


def _log(run: Run, rig: int) -> Recording:
    return run.recording(rig).between(SETTLE, float(run.time[-1]))


def _swings(run: Run, first: int) -> tuple[tuple[Recording, ...], ...]:
    frequencies = range(len(bleex.FREQUENCIES))
    return tuple(tuple(_log(run, first + bleex.swing_index(joint, k)) for k in frequencies) for joint in range(3))


def _coarser(run: Run, rng: np.random.Generator) -> Run:
    """Log the same run once more, with coarse encoders."""
    sensors = Sensors(encoder_counts=COARSE_COUNTS)
    return replace(run, q_measured=np.array([sensors.angle(sample, rng) for sample in run.q]))
