"""True parameters of the virtual BLEEX, and measurements by the experiments of document 1."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from exoid.errors import BadArgumentError
from exoid.experiments import Bench, Harmonics, StaticProtocol, bleex, run_static
from exoid.experiments.bench import run_motion
from exoid.leg.catalog import load_leg
from exoid.leg.published import bleex_parameters, bleex_resistances
from exoid.rig import HydraulicServo, Plant, ProportionalDerivative, Rates, Run, Sensors
from exoid.rig.sensors import read_angle
from exoid.signals import Approaches, Poses, Recording

ASSUMED_HIP: Mapping[str, Mapping[str, float]] = {
    "left": {"b2_hip": -0.6, "b1_hip": -1.9, "b0_hip": -0.3, "c0_hip": 0.5},
    "right": {"b2_hip": -1.2, "b1_hip": -2.2, "b0_hip": 0.4, "c0_hip": 0.45},
}
"""Assumed stiffness and friction of the hip, which the document takes as zero without a reason."""

BENCH = Bench(
    controller=ProportionalDerivative(1.0),
    actuator=HydraulicServo(stiffness=5000.0, leakage=0.01, valve_gain=10.0),
    sensors=Sensors(encoder_counts=2.0**16, torque_noise=(0.3, 0.2, 0.1)),
    rates=Rates(control=500.0, log=bleex.LOG_RATE, step=1e-3),
)
"""Servo of 10 1/s bandwidth and 1000 N·m/rad static stiffness, with assumed sensors."""

STATIC = StaticProtocol(readings=25)
"""Approach and readings of the static experiments."""

SETTLE = 2.0
"""Initial part of a dynamic experiment that is left out [s]."""


@dataclass(frozen=True)
class Extent:
    """Extent of the measurements.

    Attributes:
        duration: Duration of every motion [s]; 22 s less :data:`SETTLE` contain whole periods of all frequencies.
        poses: Number of random poses, upright and at each tilt (doc. 1, sec. III-E).

    Raises:
        ExoidError: The duration is not longer than :data:`SETTLE`, or there is no pose.
    """

    duration: float = 22.0
    poses: int = 100

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (SETTLE < self.duration < np.inf and self.poses >= 1):
            raise BadArgumentError(f"{self}", remedy=f"measure longer than {SETTLE:g} s and at least one pose")


@dataclass(frozen=True, eq=False, repr=False)
class Measurements:
    """Measurements of one leg."""

    sets: bleex.StaticSets  # commanded poses
    upright: Approaches  # poses approached from both sides with the torso upright, in the order of `sets.all`
    tilted: tuple[Poses, ...]  # averaged poses at each torso tilt
    swings: tuple[tuple[Recording, ...], ...]  # recordings of the swinging hip, knee and ankle at five frequencies each
    validation: Recording  # recording with all joints in motion
    coarse: tuple[tuple[Recording, ...], ...]  # swings as logged by an encoder of 2^12 counts


def truth_values(side: str) -> dict[str, float]:
    """Return the true parameters by name: Tables I to IV of one side in exoid's signs, and the assumed hip."""
    return {**bleex_parameters(side), **bleex_resistances(side), **ASSUMED_HIP[side]}


def measure_bleex(
    side: str, rng: np.random.Generator, replicates: int, extent: Extent, report: Callable[[float], None]
) -> list[Measurements]:
    """Run the experiments of one leg."""
    leg, truth = load_leg("bleex", side=side), truth_values(side)
    plant = Plant.build(leg, truth).repeat(replicates)
    sets = bleex.static_sets(rng, extent.poses)
    upright = run_static(plant, sets.all, BENCH, rng, STATIC)
    report(0.2)
    tilted = []
    for tilt in (-30.0, 30.0):  # [deg], for the stiffness of the hip; document 1 proposes them but does not use them
        poses = bleex.static_sets(rng, extent.poses).random
        tilted_plant = Plant.build(leg, truth, pitch=np.deg2rad(tilt)).repeat(replicates)
        tilted.append([both.averaged for both in run_static(tilted_plant, poses, BENCH, rng, STATIC)])
    report(0.4)
    rigs = bleex.VALIDATION + 1
    run = run_motion(
        plant.repeat(rigs),
        Harmonics.concatenate([bleex.dynamic_motions()] * replicates),
        BENCH,
        extent.duration,
        rng,
        progress=lambda share: report(0.4 + 0.6 * share),
    )
    sensors = Sensors(encoder_counts=(2.0**12))  # counts of an encoder for which raw second differences fail
    coarse = replace(run, q_measured=np.array([read_angle(sensors, sample, rng) for sample in run.q]))
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
