"""Long logs of a leg: five harmonics a joint, and torques of the model with noise, formed piece by piece."""

import numpy as np

import exoid
from exoid import Recording
from exoid.torques import DEFAULT_TERMS, TorqueModel

RATE = 500.0
NOISE = (1.0, 0.7, 0.3)
"""Of the torques [N·m]."""


def truth(leg: exoid.Leg) -> np.ndarray:
    """The leg's own parameters, and friction, offset and rotors."""
    count = len(TorqueModel(leg, DEFAULT_TERMS).names)
    return np.append(leg.parameters, np.random.default_rng(0).uniform(0.2, 0.8, count - len(leg.parameters)))


def long_log(leg: exoid.Leg, samples: int, seed: int = 0) -> Recording:
    """Log of so many samples at 500 Hz."""
    rng, joints = np.random.default_rng(seed), len(leg.joint_names)
    stamps = np.arange(samples) / RATE
    model, omega = TorqueModel(leg, DEFAULT_TERMS), 2.0 * np.pi * 0.1 * np.arange(1, 6)
    amplitude, phase = rng.uniform(0.05, 0.2, (joints, 5)), rng.uniform(0.0, 6.28, (joints, 5))
    q, tau = np.zeros((2, samples, joints))
    for start in range(0, samples, 10_000):
        rows = slice(start, start + 10_000)
        angle = np.multiply.outer(stamps[rows], omega)[:, None, :] + phase
        q[rows] = (amplitude * np.sin(angle)).sum(-1)
        v, a = (amplitude * omega * np.cos(angle)).sum(-1), -(amplitude * omega**2 * np.sin(angle)).sum(-1)
        tau[rows] = model.regressor(q[rows], v, a) @ truth(leg)
    tau += rng.normal(scale=NOISE, size=tau.shape)
    return Recording(stamps, q, tau=tau, joint_names=leg.joint_names)
