"""Rigs with a wearer: logs of the leg alone, with a passive limb, and with an active wearer, and the true torque."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from strides import stride

import exoid
from exoid import Armature, Coulomb, Estimate, Leg, Recording, Stiffness, Viscous, published
from exoid.experiments import gait_for_leg
from exoid.experiments.bench import stiff_servo
from exoid.experiments.references import Harmonics
from exoid.rig import Controller, IdealTorque, Plant, Rates, Run, Sensors, Target, Wearer, simulate
from exoid.signals import without_torque_delay
from exoid.torques import Term

Array = NDArray[np.float64]

RATES = Rates(control=500.0, log=500.0, step=1e-3)
"""The log has every torque that the controller commands: every second one would alias the ripple of a stiff servo."""

HELD = 0.5 / RATES.control
"""Lag of logged torques behind angles [s]: the rig logs the torque of the interval before each sample."""

STRIDE = 2.4
"""Duration of a stride [s]."""

CUHK = {
    "c0_hip": 1.445,
    "c0_knee": 0.593,
    "d_hip": 0.038,
    "d_knee": 0.192,
    "b1_knee": 0.5,
    "Ia_hip": 0.8,
    "Ia_knee": 0.8,
}
"""Friction of CUHK-EXO (Table III, dissipative), and reflected inertia of its motors."""


@dataclass(frozen=True)
class Machine:
    """An exoskeleton leg on the rig.

    Attributes:
        plant: True leg.
        cad: Leg by CAD, without friction.
        terms: Terms of the identification.
        centre: Middle of the training motion [rad], (n,).
        amplitude: Its largest deviation [rad], (n,).
        noise: Noise of the torque sensors [N·m], (n,).
    """

    plant: Plant
    cad: Leg
    terms: tuple[Term, ...]
    centre: Array
    amplitude: Array
    noise: Array

    @property
    def sensors(self) -> Sensors:
        """Sensors: encoders of 16 bits with noise, and torque."""
        return Sensors(angle_noise=2e-5, torque_noise=self.noise)


def machine(name: str) -> Machine:
    """Make BLEEX (Tables II to IV, left; CAD of Table V) or CUHK-EXO (anthropometric bodies; CAD without motors)."""
    if name == "bleex":
        leg = exoid.load_leg("bleex", "left", "identified")
        plant = Plant.build(leg, published.bleex_resistances("left"), end_stops=False)
        cad, terms = (
            exoid.load_leg("bleex", "left", "cad"),
            (Stiffness(degree=2, joints=("knee", "ankle")), Coulomb(), Viscous()),
        )
        centre, amplitude = np.deg2rad([20.0, -38.0, -3.0]), np.deg2rad([35.0, 42.0, 30.0])
        return Machine(plant, cad, terms, centre, amplitude, np.array([0.5, 0.4, 0.2]))
    leg = exoid.load_leg("cuhk")
    terms = (Stiffness(degree=1, joints=("knee",)), Coulomb(), Viscous(), Armature())
    centre, amplitude = np.deg2rad([20.0, 38.0]), np.deg2rad([35.0, 42.0])
    return Machine(Plant.build(leg, CUHK, end_stops=False), leg, terms, centre, amplitude, np.array([0.5, 0.3]))


def true_values(one: Machine, names: tuple[str, ...]) -> Array:
    """True values of the parameters of an estimate; the rotor of CUHK-EXO's hip is part of its J1."""
    friction = CUHK if "Ia_knee" in names else published.bleex_resistances("left")
    rigid = zip(one.plant.leg.parameter_names, one.plant.parameters[:, 0].tolist(), strict=True)
    known = {**friction, **dict(rigid)}
    if "Ia_hip" in known and "Ia_hip" not in names:
        known["J1"] += known["Ia_hip"]
    return np.array([known.get(name, 0.0) for name in names])


@dataclass(frozen=True)
class GravitySupport:
    """Exoskeleton that carries its own weight by a model, and is moved by the wearer.

    Attributes:
        leg: The model.
    """

    leg: Leg

    def command(self, target: Target, q: Array, v: Array, interaction: Array | None = None) -> Array:
        """Torque of gravity, (n, B)."""
        return self.leg.gravity(q.T).T


def multisine(one: Machine, seeds: list[int], base: float = 0.3, share: float = 1.0) -> Harmonics:
    """Five harmonics with phases by seed, scaled to the range."""
    joints = len(one.centre)
    frequency = 2.0 * np.pi * base * np.arange(1.0, 6.0)[:, None, None]
    parts = [np.random.default_rng([seed, 3]).uniform(0.0, 2.0 * np.pi, (5, joints)) for seed in seeds]
    size = share * one.amplitude[:, None] * np.array([0.35, 0.25, 0.2, 0.12, 0.08])[:, None, None]
    return Harmonics(
        np.tile(one.centre[:, None], len(seeds)), np.tile(size, len(seeds)), frequency, np.stack(parts, -1)
    )


def gait(one: Machine, seeds: list[int], period: float = STRIDE) -> Harmonics:
    """A stride in a phase by seed."""
    motion = Harmonics.concatenate([gait_for_leg(one.plant.leg, stride(period))] * len(seeds))
    shift = np.array([np.random.default_rng([seed, 5]).uniform(0.0, period) for seed in seeds])
    return Harmonics(motion.centre, motion.amplitude, motion.frequency, motion.phase + motion.frequency * shift)


def alone(
    one: Machine, seeds: list[int], seconds: float = 60.0, *, motion: Harmonics | None = None, draw: int = 0
) -> Run:
    """The servo moves the leg without a wearer."""
    return _run(one, motion or multisine(one, seeds), stiff_servo(one.plant), seconds, len(seeds), [*seeds, draw])


def passive(
    one: Machine, seeds: list[int], wearer: Wearer, seconds: float = 60.0, *, motion: Harmonics | None = None
) -> Run:
    """The servo moves the leg with a passive limb in it."""
    law = stiff_servo(one.plant)
    return _run(one, motion or multisine(one, seeds), law, seconds, len(seeds), [*seeds, 1], wearer)


def active(one: Machine, seeds: list[int], seconds: float = 30.0) -> Run:
    """The wearer walks, and the exoskeleton carries its weight."""
    motion = gait(one, seeds)
    wearer = Wearer.build(one.plant.leg, intention=motion)
    support = GravitySupport(one.plant.leg.with_parameters(one.plant.parameters[:, 0]))
    return _run(one, motion, support, seconds, len(seeds), [*seeds, 2], wearer)


def _run(
    one: Machine,
    motion: Harmonics,
    law: Controller,
    seconds: float,
    count: int,
    seed: list[int],
    wearer: Wearer | None = None,
) -> Run:
    options: dict[str, Any] = {"sensors": one.sensors, "rates": RATES, "seed": np.random.default_rng(seed)}
    if wearer is not None:
        options["wearer"] = wearer
    return simulate(one.plant.repeat(count), motion, law, IdealTorque(), seconds, **options)


def log(run: Run, k: int) -> Recording:
    """Readings of a rig, with torques at the time of the angles."""
    return without_torque_delay(run.recording(k), dict.fromkeys(range(run.plant.n), HELD))


def cad_torque(one: Machine, estimate: Estimate, recording: Recording, time: Array) -> Array:
    """Torque of the wearer by the CAD model, filtered alike [N·m], (N, n)."""
    prepared = estimate.preparation.kinematics(recording)
    need = one.cad.inverse_dynamics(prepared.q, prepared.v, prepared.a)
    return at(estimate, recording, need - recording.tau, time)


def at(estimate: Estimate, recording: Recording, torque: Array, time: Array) -> Array:
    """Pass a torque through the filter of the estimate, at some samples."""
    return at_samples(recording, estimate.preparation.filter(torque, recording.sample_rate), time)


def at_samples(recording: Recording, torque: Array, time: Array) -> Array:
    """Pick a torque at some samples."""
    return torque[np.searchsorted(recording.time, time - 0.5 / recording.sample_rate)]


def nrmse(found: Array, truth: Array) -> Array:
    """RMS error of each joint over the standard deviation of the truth, (n,)."""
    return np.sqrt(((found - truth) ** 2).mean(axis=0)) / truth.std(axis=0)
