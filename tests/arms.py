"""Industrial arms: their legs' worth of everything beside rigid bodies, and motions within their limits."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from public_robots import urdf_of
from swings import coloured, harmonics

from exoid import Leg, Recording
from exoid.torques import DEFAULT_TERMS, TorqueModel

JOINTS = {"panda": tuple(f"panda_joint{k}" for k in range(1, 8))}
"""Of those robots that have more than their arm."""

SMOOTHING = 0.015


@dataclass(frozen=True, eq=False)
class Arm:
    """A robot with friction, rotor inertia and torque sensors that are off, and everything that is true of it.

    Attributes:
        robot: Its name in example-robot-data.
        rate: Of the samples [Hz].
        seconds: Duration of its motions.
    """

    robot: str
    rate: float = 200.0
    seconds: float = 40.0

    @cached_property
    def leg(self):
        return Leg.from_urdf(urdf_of(self.robot), JOINTS.get(self.robot))

    @cached_property
    def joints(self):
        """c0, d, Ia and offset of each joint, (4, n)."""
        size = (len(self.leg.joint_names),)
        rng = np.random.default_rng(99)
        return np.array([rng.uniform(*span, size) for span in ((0.2, 1.0), (0.2, 1.0), (0.02, 0.2), (-0.3, 0.3))])

    @cached_property
    def noise(self):
        """Standard deviation of the torque sensors [N·m], (n,)."""
        return np.where(self.leg.limits.effort > 0.5 * self.leg.limits.effort.max(), 0.3, 0.1)

    @cached_property
    def truth(self):
        """What an estimate should find, by name: what cannot be told apart is added up."""
        truth = dict(zip(self.leg.parameter_names, self.leg.parameters, strict=True))
        for symbol, values in zip(("c0", "d", "Ia", "offset"), self.joints, strict=True):
            truth |= {f"{symbol}_{label}": x for label, x in zip(self.leg.joint_labels, values, strict=True)}
        for regrouped in TorqueModel(self.leg, DEFAULT_TERMS).regrouped:
            for name, share in regrouped.into.items():
                truth[name] += share * truth[regrouped.name]
        return truth

    def motion(self, seed):
        """Five harmonics of 0.1 Hz within nine tenths of the range and eight tenths of the speed of every joint."""
        rng = np.random.default_rng(seed)
        limits, n = self.leg.limits, len(self.leg.joint_names)
        time = np.arange(round(self.seconds * self.rate)) / self.rate
        omega = 2.0 * np.pi * 0.1 * np.arange(1, 6)
        amplitude = rng.uniform(0.3, 1.0, (n, 5)) / np.sqrt(np.arange(1, 6))
        q, v, a = harmonics(time, amplitude, omega, rng.uniform(0.0, 2.0 * np.pi, (n, 5)))
        lower, upper = np.maximum(limits.lower, -np.pi), np.minimum(limits.upper, np.pi)
        scale = np.minimum(0.9 * (upper - lower) / np.ptp(q, axis=0), 0.8 * limits.velocity / np.abs(v).max(axis=0))
        centre = 0.5 * (lower + upper) - 0.5 * scale * (q.min(axis=0) + q.max(axis=0))
        return time, centre + scale * q, scale * v, scale * a

    def torque(self, q, v, a):
        """Pinocchio's inverse dynamics and the rest [N·m], (N, n)."""
        c0, d, armature, offset = self.joints
        return self.leg.inverse_dynamics(q, v, a) + c0 * np.tanh(v / SMOOTHING) + d * v + armature * a + offset

    def noise_of(self, seed, time_constant=0.0):
        """Draw the noise of a recording, white, or with a memory [s]."""
        memory = np.exp(-1.0 / (self.rate * time_constant)) if time_constant else 0.0
        shape = (round(self.seconds * self.rate), len(self.noise))
        return self.noise * coloured(np.random.default_rng(seed), shape, memory)

    def recording(self, motion, noise):
        """Only angles and torques, as most controllers log them."""
        time, *state = self.motion(motion)
        return Recording(time=time, q=state[0], tau=self.torque(*state) + noise, joint_names=self.leg.joint_names)
