"""The experiments of document 2: Table II, its validation motion, and a motion that sees inertia."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.torques import Armature, Coulomb, Offset, Stiffness, TorqueModel, Viscous

from .references import Harmonics

HIP, KNEE = 0, 1
LOG_RATE = 100.0
"""Assumed; the document gives none for the log [Hz]."""

TABLE_II_FREQUENCY = 0.1 * np.pi
"""Of rows 3 to 5 [rad/s]: 0.05 Hz."""

LOWEST, HIGHEST = np.deg2rad([-10.0, 5.0]), np.deg2rad([60.0, 85.0])
"""Angles of the multisine [rad], hip and knee: within the limits of a seated or standing wearer."""

FASTEST = 2.0
"""Speed of the multisine [rad/s]."""

BASE_FREQUENCY, HARMONICS = 0.2, 5
"""Of the multisine: 0.2, 0.4, … 1.0 Hz."""


def stiffness_poses(difference: float = np.deg2rad(-10.0)) -> FloatArray:
    """Row 1: knee every 5° from 10°, the hip such that Δ = θk − θh stays the same [rad], (K, 2).

    Args:
        difference: Δ [rad], not printed.
    """
    knee = np.deg2rad(np.arange(10.0, 71.0, 5.0))
    return np.column_stack([knee - difference, knee])


def random_poses(rng: np.random.Generator, count: int = 40) -> FloatArray:
    """Row 2: randomly selected pairs [rad], (count, 2)."""
    return rng.uniform(np.deg2rad([-10.0, 5.0]), np.deg2rad([80.0, 95.0]), (count, 2))


def swing(joint: int) -> Harmonics:
    """Rows 3 and 5 (the hip) or row 4 (the knee): 40° + 20° sin(0.1 π t), the other joint at 20°."""
    centre, amplitude = np.full((2, 1), np.deg2rad(20.0)), np.zeros((1, 2, 1))
    centre[joint], amplitude[0, joint] = np.deg2rad(40.0), np.deg2rad(20.0)
    return Harmonics(centre, amplitude, np.full((1, 1, 1), TABLE_II_FREQUENCY), np.zeros((1, 1, 1)))


def validation_motion() -> Harmonics:
    """Both joints alike, 40° + 20° sin(0.4 π t) (sec. III-B): Δ = 0 throughout, which hides J2."""
    return Harmonics(
        np.full((2, 1), np.deg2rad(40.0)),
        np.full((1, 2, 1), np.deg2rad(20.0)),
        np.full((1, 1, 1), 0.4 * np.pi),
        np.zeros((1, 1, 1)),
    )


def multisine(leg: Leg, rng: np.random.Generator, draws: int = 300) -> Harmonics:
    """Five harmonics of 0.2 Hz within the limits of angle and speed: the best conditioned of random draws.

    Args:
        leg: Whose regressor is to be well conditioned.
        rng: For the draws.
        draws: How many.

    Raises:
        ExoidError: There are no draws.
    """
    if draws < 1:
        raise ExoidError(f"the best of {draws} draws", remedy="draw at least one motion")
    model = TorqueModel(
        leg,
        (
            Stiffness(degree=1, joints=(leg.joint_labels[KNEE],)),
            Coulomb(),
            Viscous(),
            Armature(),
            Offset(joints=(leg.joint_labels[HIP],)),
        ),
    )
    drawn = [_draw_multisine(rng) for _ in range(draws)]
    return drawn[int(np.argmin([_condition(model, motion) for motion in drawn]))]


def _draw_multisine(rng: np.random.Generator) -> Harmonics:
    """Draw shares and phases of the harmonics, as large as the limits allow."""
    frequency = 2.0 * np.pi * BASE_FREQUENCY * np.arange(1.0, HARMONICS + 1.0)[:, None, None]
    share = rng.dirichlet(np.ones(HARMONICS), 2).T[..., None]
    phase = rng.uniform(0.0, 2.0 * np.pi, (HARMONICS, 2))[..., None]
    shape, rate, _ = _period(Harmonics(np.zeros((2, 1)), share, frequency, phase))
    scale = np.minimum((HIGHEST - LOWEST) / np.ptp(shape, axis=0), FASTEST / np.abs(rate).max(axis=0))
    centre = 0.5 * (LOWEST + HIGHEST) - 0.5 * scale * (shape.max(axis=0) + shape.min(axis=0))
    return Harmonics(centre[:, None], scale[:, None] * share, frequency, phase)


def _period(motion: Harmonics) -> tuple[FloatArray, FloatArray, FloatArray]:
    """One period of the multisine: angles, velocities and accelerations, (N, 2) each."""
    time = np.arange(0.0, 1.0 / BASE_FREQUENCY, 0.02)
    instants = Harmonics(motion.centre, motion.amplitude, motion.frequency, motion.phase + motion.frequency * time)
    q, v, _ = instants.at(0.0)  # every instant as a rig of its own
    return q.T, v.T, instants.acceleration(0.0).T


def _condition(model: TorqueModel, motion: Harmonics) -> float:
    """Condition number of the regressor over one period, columns scaled to one."""
    q, v, a = _period(motion)
    W = model.regressor(q, v, a).reshape(2 * len(q), -1)
    return float(np.linalg.cond(W / np.linalg.norm(W, axis=0)))
