"""Worn logs whose every torque is known: a smooth motion, RNEA, friction, and a torque of the wearer."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, group_delay, lfilter
from strides import stride
from walking import TORQUE_NOISE, Walk

from exoid import Coulomb, Estimate, Leg, Offset, Recording, Viscous, identify
from exoid.control.observers import SensorNoise
from exoid.experiments import Harmonics, gait_for_leg
from exoid.experiments.bench import stiff_servo
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Rates, Run, Sensors, Target, Wearer, simulate
from exoid.rig.controllers import Reference
from exoid.torques import TorqueModel

Array = NDArray[np.float64]

COUNT = 2.0 * np.pi / 2.0**16
"""Step of the encoders [rad]."""

ANGLE_NOISE = COUNT / np.sqrt(12.0)

FRICTION = {"c0": (0.5, 0.5, 0.25), "d": (0.3, 0.2, 0.1), "offset": (0.5, -0.3, 0.2)}

TERMS = (Coulomb(), Viscous(), Offset())

TORQUE_SIZE = np.array([8.0, 5.0, 2.0])
"""Size of the wearer's torque [N·m]."""


@dataclass(frozen=True, eq=False)
class WornLog:
    """Log of a leg that a wearer moves.

    Attributes:
        leg: The leg.
        seconds: Duration [s].
        rate: [Hz].
        seed: Seed of motion, torque and noise.
        size: Size of the wearer's torque over the usual one; 0 for nobody.
        noise: Size of the noise over the usual one.
        tachometer: Noise of a measured velocity [rad/s]; None if it is not measured.
        late: Delay of the logged torques [s].
        zero: Size of the torque sensors' zero offsets over the usual one.
    """

    leg: Leg
    seconds: float = 20.0
    rate: float = 1000.0
    seed: int = 0
    size: float = 1.0
    noise: float = 1.0
    tachometer: float | None = None
    late: float = 0.0
    zero: float = 1.0
    walk: Walk = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "walk", Walk(self.leg, self.seconds, self.rate, self.seed))

    @property
    def values(self) -> Array:
        """True parameters of bodies and terms."""
        model = self.model
        known = dict(zip(self.leg.parameter_names, self.leg.parameters.tolist(), strict=True))
        for symbol, row in FRICTION.items():
            scale = self.zero if symbol == "offset" else 1.0
            known |= {f"{symbol}_{label}": scale * x for label, x in zip(self.leg.joint_labels, row, strict=False)}
        return np.array([known[name] for name in model.names])

    @property
    def model(self) -> TorqueModel:
        """Bodies and terms."""
        return TorqueModel(self.leg, TERMS)

    @property
    def wearer(self) -> Array:
        """Torque of the wearer on the leg [N·m], (N, n)."""
        n = len(self.leg.joint_names)
        waves = [self.walk.waves(1.0, 1.0, 50 + j)[0] for j in range(n)]
        return self.size * TORQUE_SIZE[:n] * np.column_stack(waves)

    @property
    def torque(self) -> Array:
        """True torque of the actuators [N·m], (N, n)."""
        q, v, a = self.walk.joints
        rest = np.tensordot(self.model.regressor(q, v, a)[..., len(self.leg.parameters) :], self._friction, axes=1)
        return np.asarray(self.leg.inverse_dynamics(q, v, a) + rest - self.wearer)

    def recording(self) -> Recording:
        """Log with encoders, torque noise, and a tachometer where there is one."""
        rng = np.random.default_rng([self.seed, 98])
        q, v, _ = self.walk.joints
        n = q.shape[1]
        time, tau = self.walk.time, self.torque
        if self.late:
            tau = np.column_stack([np.interp(time - self.late, time, x) for x in tau.T])
        tau = tau + self.noise * TORQUE_NOISE[:n] * rng.standard_normal(q.shape)
        angle = np.rint(q / COUNT) * COUNT if self.noise else q
        speed = None if self.tachometer is None else v + self.tachometer * rng.standard_normal(q.shape)
        return Recording(time, angle, speed, tau=tau, joint_names=self.leg.joint_names)

    @property
    def sensors(self) -> SensorNoise:
        """Noise of the log."""
        n = len(self.leg.joint_names)
        return SensorNoise(self.noise * TORQUE_NOISE[:n], self.tachometer or 0.0, self.noise * ANGLE_NOISE)

    @property
    def _friction(self) -> Array:
        return self.values[len(self.leg.parameters) :]


def nrmse(read: Array, true: Array, skip: int = 0) -> Array:
    """RMS difference over the standard deviation of the truth, without the first samples, (n,)."""
    return np.asarray(np.sqrt(np.mean((read - true)[skip:] ** 2, axis=0)) / true[skip:].std(axis=0))


@dataclass(frozen=True, eq=False)
class StopAndGo:
    """Motion of B rigs in which each joint moves and rests in turn, at times of its own.

    Attributes:
        size: Amplitudes [rad], (n, B).
        phase: Where in its turn each joint begins, (n, B).
        centre: Mean angles [rad], (n, 1).
    """

    size: Array
    phase: Array
    centre: Array

    @classmethod
    def draw(cls, n: int, rigs: int, seed: int) -> StopAndGo:
        """Draw motions of a leg."""
        rng = np.random.default_rng([seed, 17])
        size = rng.uniform(0.1, 0.45, (n, rigs))
        return cls(size, rng.uniform(0.0, 10.0, (n, rigs)), np.array([[0.4], [-0.6], [0.0]])[:n])

    def at(self, time: float) -> Target:
        """Four seconds of motion at 0.75 Hz, then two of rest, over and over."""
        turn, share = np.divmod(time + self.phase, 6.0)
        s = np.minimum(share / 4.0, 1.0)
        way, rate, change = s**3 * (10 - 15 * s + 6 * s * s), 30 * (s * (1 - s)) ** 2, 60 * s * (1 - s) * (1 - 2 * s)
        w = 6.0 * np.pi
        angle, speed, push = w * (turn + way), w * rate / 4.0, w * change / 16.0
        v = self.size * np.cos(angle) * speed
        a = self.size * (np.cos(angle) * push - np.sin(angle) * speed**2)
        return Target(self.centre + self.size * np.sin(angle), v, a)


def sticking_run(leg: Leg, rigs: int, seconds: float, seed: int = 0, rate: float = 1000.0) -> Run:
    """Rigs that nobody wears, with friction that sticks; a soft servo leaves each joint at rest under some torque."""
    n = len(leg.joint_names)
    law = ProportionalDerivative(np.array([[150.0], [120.0], [40.0]])[:n], np.array([[15.0], [8.0], [1.5]])[:n])
    return _worn(leg, StopAndGo.draw(n, rigs, seed), law, None, seconds, seed, rate)


def estimate_of(leg: Leg, **changes: float) -> Estimate:
    """Identify a leg from a log that nobody wears, of 30 s at 200 Hz."""
    return identify(leg, WornLog(leg, 30.0, 200.0, seed=1, size=0.0, **changes).recording(), terms=TERMS)  # type: ignore[arg-type]


def worn_run(leg: Leg, periods: Array, seconds: float, seed: int = 0, rate: float = 1000.0) -> Run:
    """Rigs whose actuators are off, worn by walkers of several stride times."""
    gait = walks(leg, periods)
    law = ProportionalDerivative(0.0, 0.0)
    return _worn(leg, gait, law, Wearer.build(leg, intention=gait), seconds, seed, rate)


def passive_run(leg: Leg, periods: Array, seconds: float, seed: int = 0, rate: float = 1000.0) -> Run:
    """Rigs whose servo moves them and a passive limb in strides of several times."""
    plant = _plant(leg, len(periods))
    return _worn(leg, walks(leg, periods), stiff_servo(plant), Wearer.build(leg), seconds, seed, rate)


def walks(leg: Leg, periods: Array) -> Harmonics:
    """Strides of several times."""
    return Harmonics.concatenate([gait_for_leg(leg, stride(period)) for period in periods])


def _plant(leg: Leg, rigs: int) -> Plant:
    """Rigs with friction that sticks."""
    friction = {
        f"{symbol}_{label}": value
        for symbol, row in FRICTION.items()
        if symbol != "offset"
        for label, value in zip(leg.joint_labels, row, strict=False)
    }
    return Plant.build(leg, friction, pitch=np.zeros(rigs), end_stops=False)


def _worn(
    leg: Leg, aim: Reference, law: ProportionalDerivative, wearer: Wearer | None, seconds: float, seed: int, rate: float
) -> Run:
    n, rigs = aim.at(0.0).q.shape
    return simulate(
        _plant(leg, rigs),
        aim,
        law,
        IdealTorque(),
        seconds,
        sensors=Sensors(torque_noise=TORQUE_NOISE[:n]),
        rates=Rates(rate, rate),
        wearer=wearer,
        seed=seed,
    )


def slow_tachometer(log: WornLog, cutoff: float) -> tuple[Recording, float]:
    """Log whose velocities passed a low-pass of second order [Hz], and their lag [s]."""
    b, a = butter(2, cutoff, fs=log.rate)
    _, v, _ = log.walk.joints
    lag = group_delay((b, a), [1e-3], fs=log.rate)[1][0] / log.rate
    return replace(log.recording(), v=lfilter(b, a, v, axis=0)), float(lag)
