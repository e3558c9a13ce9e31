"""Motions with known derivatives, and recordings of legs whose every parameter is known."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.signal import lfilter

from exoid import Coulomb, Leg, Recording, Viscous
from exoid.signals import Kinematics, ZeroPhase, zero_phase
from exoid.signals.differentiation import difference
from exoid.torques.payloads import payload_parameters

SMOOTHING = 0.02

SMOOTH = Coulomb(smoothing=SMOOTHING, reversal_speed=0.0)
"""Friction that is a function of velocity throughout."""

TERMS = (SMOOTH, Viscous())
"""What acts on the joints of every :class:`Swing`."""


def harmonics(time, size, omega, phase):
    """Angles, velocities and accelerations (N, n) of sums of K sines; size, omega and phase are (n, K) or (K,)."""
    angle = time[:, None, None] * omega + phase
    parts = np.sin(angle), omega * np.cos(angle), -(omega**2) * np.sin(angle)
    return tuple((size * part).sum(-1) for part in parts)


def coloured(rng, shape, memory):
    """Draw stationary AR(1) noise of unit variance along the first axis."""
    drive = rng.standard_normal(shape)
    drive[1:] *= np.sqrt(1.0 - memory**2)
    return lfilter([1.0], [1.0, -memory], drive, axis=0)


def with_payloads(leg, payloads):
    """Fix payloads to a leg, so that its model includes them."""
    return leg.with_parameters(leg.parameters + payload_parameters(leg, payloads))


def log_of(leg, time, motion, acting=0.0, noise=0.0, seed=0, *, exact=False):
    """Log of a leg: Pinocchio's inverse dynamics, torques that act beside them, and white noise [N·m].

    Angles alone are logged, or exact velocities and accelerations, too.
    """
    q, v, a = motion
    white = np.random.default_rng(seed).standard_normal(q.shape)
    tau = leg.inverse_dynamics(q, v, a) + acting + noise * white
    measured = {"v": v, "a": a} if exact else {}
    return Recording(time, q, tau=tau, joint_names=leg.joint_names, **measured)


def holds(estimate, truth):
    """Whether the 95 % interval of each parameter contains its true value, (P,)."""
    low, high = estimate.interval(0.95).T
    return (low <= truth) & (truth <= high)


def late(recording, seconds, joints):
    """Delay torques."""
    tau = np.array(recording.tau)
    for joint in joints:
        tau[:, joint] = np.interp(recording.time - seconds, recording.time, tau[:, joint])
    return replace(recording, tau=tau)


@dataclass(frozen=True, eq=False)
class Swing:
    """Harmonic motion of a leg with Coulomb and viscous friction; it starts and ends in the middle of a motion.

    Attributes:
        leg: The leg.
        rate: Of the samples [Hz].
        seconds: Duration.
        seed: Of amplitudes and phases.
        base: Frequency of the first of five harmonics [Hz].
        smoothing: Width of Coulomb friction [rad/s]; that of the default terms is 0.015.
    """

    leg: Leg
    rate: float = 100.0
    seconds: float = 20.0
    seed: int = 1
    base: float = 0.1
    smoothing: float = SMOOTHING

    @cached_property
    def time(self):
        return 2.137 + np.arange(int(self.seconds * self.rate)) / self.rate

    @cached_property
    def motion(self):
        """Angles, velocities and accelerations, (N, n) each."""
        rng = np.random.default_rng(self.seed)
        n = len(self.leg.joint_names)
        omega = 2.0 * np.pi * self.base * np.arange(1, 6)
        amplitude = 0.42 * rng.uniform(0.4, 1.0, (n, 5)) / np.array([1.0, 1.2, 1.5, 2.0, 2.5])
        return harmonics(self.time, amplitude, omega, rng.uniform(0.0, 2.0 * np.pi, (n, 5)))

    @property
    def coulomb(self):
        """[N·m], (n,)."""
        return np.array([0.8, 0.6, 0.4, 0.3, 0.25, 0.2])[: len(self.leg.joint_names)]

    @property
    def viscous(self):
        """[N·m·s/rad], (n,)."""
        return np.array([0.5, 0.3, 0.2, 0.15, 0.1, 0.1])[: len(self.leg.joint_names)]

    @property
    def truth(self):
        """Values that an estimate with :data:`TERMS` should find, (P,)."""
        return np.concatenate([self.leg.parameters, self.coulomb, self.viscous])

    def friction(self, v):
        """[N·m], (N, n)."""
        return self.coulomb * np.tanh(v / self.smoothing) + self.viscous * v

    @cached_property
    def torque(self):
        """Pinocchio's inverse dynamics plus friction [N·m], (N, n)."""
        q, v, a = self.motion
        return self.leg.inverse_dynamics(q, v, a) + self.friction(v)

    def recording(self, **changes):
        """Angles, velocities, accelerations and torques, all exact unless changed."""
        q, v, a = self.motion
        exact = {"time": self.time, "q": q, "v": v, "a": a, "tau": self.torque, "joint_names": self.leg.joint_names}
        return Recording(**{**exact, **changes})

    def encoders_only(self):
        """Exact angles and torques; velocities and accelerations are left to the preparation."""
        return self.recording(v=None, a=None)

    def with_noise(self, rng, std):
        """White noise of ``std`` [N·m] on the torques, all else exact."""
        return self.recording(tau=self.torque + rng.normal(scale=std, size=self.torque.shape))


@dataclass(frozen=True)
class WithEdges(ZeroPhase):
    """The default preparation with motions reflected at the ends, and none of their rows removed: a common mistake."""

    def kinematics(self, recording: Recording) -> Kinematics:
        rate = recording.sample_rate
        q = zero_phase(recording.q, rate, self.kinematics_cutoff_at(rate))
        return Kinematics(q, difference(q, rate, 1, 4), difference(q, rate, 2, 4), slice(None))
