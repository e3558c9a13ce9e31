"""Logs of a leg on which a wearer acts with a known torque."""

import dataclasses

import numpy as np
from swings import TERMS, Swing

import exoid
from exoid import Estimate, Leg, Recording

ANGLE_NOISE, TORQUE_NOISE = 5e-5, 0.4
"""Noise of the sensors [rad, N·m]."""


def swing(leg: Leg, seed: int, seconds: float = 40.0, base: float = 0.15) -> Swing:
    return Swing(leg, 100.0, seconds, seed, base)


def push(motion: Swing, seed: int = 0, size: float = 6.0) -> np.ndarray:
    """Torque of a wearer: waves at frequencies of their own, (N, n)."""
    rng = np.random.default_rng([seed, 11])
    joints = len(motion.leg.joint_names)
    frequencies, phases = np.array([0.35, 0.8, 1.7]), rng.uniform(0.0, 2.0 * np.pi, (3, joints))
    waves = np.sin(2.0 * np.pi * np.multiply.outer(motion.time, frequencies)[:, :, None] + phases)
    return size * np.einsum("nkj,k->nj", waves, [1.0, 0.6, 0.3])


def log(motion: Swing, tau_wearer: np.ndarray | float = 0.0, *, noise: float = 1.0, seed: int = 0) -> Recording:
    """Readings of angles and actuator torques τ = RNEA + friction − τ_w."""
    rng = np.random.default_rng([seed, motion.seed])
    q, tau = motion.motion[0], motion.torque - tau_wearer
    angles = q + noise * ANGLE_NOISE * rng.standard_normal(q.shape)
    if noise == 0.0 and np.ndim(tau_wearer) == 0:
        return motion.encoders_only()
    tau = tau + noise * TORQUE_NOISE * rng.standard_normal(q.shape)
    return dataclasses.replace(motion.encoders_only(), q=angles, tau=tau)


def unworn_estimate(leg: Leg, seed: int = 1, noise: float = 1.0) -> Estimate:
    return exoid.identify(leg, log(swing(leg, seed), noise=noise, seed=seed), TERMS)


def filtered(estimate: Estimate, recording: Recording, torque: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Pass the truth through the filter of the estimate, at some of the samples."""
    rate = recording.sample_rate
    whole = estimate.preparation.filter(torque, rate)
    return whole[np.searchsorted(recording.time, time - 0.5 / rate)]
