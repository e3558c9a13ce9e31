"""Worn logs whose every torque is known: a smooth motion, RNEA, friction, and a torque of the wearer."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from walking import TORQUE_NOISE, Walk

from exoid import Coulomb, Leg, Offset, Recording, Viscous
from exoid.control.observers import SensorNoise
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
    """

    leg: Leg
    seconds: float = 20.0
    rate: float = 1000.0
    seed: int = 0
    size: float = 1.0
    noise: float = 1.0
    tachometer: float | None = None
    late: float = 0.0
    walk: Walk = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "walk", Walk(self.leg, self.seconds, self.rate, self.seed))

    @property
    def values(self) -> Array:
        """True parameters of bodies and terms."""
        model = self.model
        known = dict(zip(self.leg.parameter_names, self.leg.parameters.tolist(), strict=True))
        for symbol, row in FRICTION.items():
            known |= {f"{symbol}_{label}": x for label, x in zip(self.leg.joint_labels, row, strict=False)}
        return np.array([known[name] for name in model.names])

    @property
    def model(self) -> TorqueModel:
        """Bodies and terms."""
        return TorqueModel.at_start(self.leg, TERMS)

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


def nrmse(read: Array, true: Array, skip: int) -> Array:
    """RMS difference over the standard deviation of the truth, without the first samples, (n,)."""
    return np.asarray(np.sqrt(np.mean((read - true)[skip:] ** 2, axis=0)) / true[skip:].std(axis=0))
