"""Experiments of document 2: Table II, the validation motion, and a multisine that excites the inertias."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.torques import Armature, Coulomb, Offset, Stiffness, TorqueModel, Viscous

from .references import Harmonics

HIP, KNEE = 0, 1
LOG_RATE = 100.0
"""Sampling rate of the log [Hz]; assumed, as the document does not print it."""

LOWEST, HIGHEST = np.deg2rad([-10.0, 5.0]), np.deg2rad([60.0, 85.0])
"""Range of angle of the multisine, hip and knee [rad]: within the limits of a seated or standing wearer."""

MAX_SPEED = 2.0
"""Largest speed of the multisine [rad/s]."""

BASE_FREQUENCY, HARMONICS = 0.2, 5
"""Base frequency [Hz] and number of harmonics of the multisine: 0.2, 0.4, … 1.0 Hz."""

PERIOD = np.arange(0.0, 1.0 / BASE_FREQUENCY, 0.02)
"""Samples of one period of the multisine [s]."""


def stiffness_poses() -> FloatArray:
    """Make the poses of row 1: knee every 5° from 10°, hip at a constant difference Δ = θk − θh of −10°."""
    knee = np.deg2rad(np.arange(10.0, 71.0, 5.0))
    return np.column_stack([knee + np.deg2rad(10.0), knee])


def random_poses(rng: np.random.Generator, count: int = 40) -> FloatArray:
    """Draw the poses of row 2."""
    return rng.uniform(np.deg2rad([-10.0, 5.0]), np.deg2rad([80.0, 95.0]), (count, 2))


def swing(joint: int) -> Harmonics:
    """Make the motion of rows 3 and 5 (hip) or row 4 (knee): 40° + 20° sin(0.1 π t), the other joint at 20°."""
    centre, amplitude = np.full((2, 1), np.deg2rad(20.0)), np.zeros((1, 2, 1))
    centre[joint], amplitude[0, joint] = np.deg2rad(40.0), np.deg2rad(20.0)
    return Harmonics(centre, amplitude, np.full((1, 1, 1), 0.1 * np.pi), np.zeros((1, 1, 1)))


def validation_motion() -> Harmonics:
    """Make the validation motion, 40° + 20° sin(0.4 π t) at both joints (doc. 2, sec. III-B)."""
    # Δ = 0 throughout, so that the torque does not depend on J2.
    return Harmonics(
        np.full((2, 1), np.deg2rad(40.0)),
        np.full((1, 2, 1), np.deg2rad(20.0)),
        np.full((1, 1, 1), 0.4 * np.pi),
        np.zeros((1, 1, 1)),
    )


def multisine(leg: Leg, rng: np.random.Generator, draws: int = 300) -> Harmonics:
    """Draw multisines of five harmonics of 0.2 Hz within limits of angle and speed; keep the best conditioned."""
    if draws < 1:
        raise BadArgumentError(f"the best of {draws} draws", remedy="draw at least one motion")
    hip, knee = leg.joint_labels
    terms = (Stiffness(degree=1, joints=(knee,)), Coulomb(), Viscous(), Armature(), Offset(joints=(hip,)))
    model = TorqueModel(leg, terms)
    drawn = [_draw_multisine(rng) for _ in range(draws)]
    return drawn[int(np.argmin([_condition(model, motion) for motion in drawn]))]


def _draw_multisine(rng: np.random.Generator) -> Harmonics:
    """Draw amplitude ratios and phases of the harmonics, and scale the motion to the limits."""
    frequency = 2.0 * np.pi * BASE_FREQUENCY * np.arange(1.0, HARMONICS + 1.0)[:, None, None]
    share = rng.dirichlet(np.ones(HARMONICS), 2).T[..., None]
    phase = rng.uniform(0.0, 2.0 * np.pi, (HARMONICS, 2))[..., None]
    shape, rate, _ = Harmonics(np.zeros((2, 1)), share, frequency, phase).over(PERIOD)
    scale = np.minimum((HIGHEST - LOWEST) / np.ptp(shape, axis=0), MAX_SPEED / np.abs(rate).max(axis=0))
    centre = 0.5 * (LOWEST + HIGHEST) - 0.5 * scale * (shape.max(axis=0) + shape.min(axis=0))
    return Harmonics(centre[:, None], scale[:, None] * share, frequency, phase)


def _condition(model: TorqueModel, motion: Harmonics) -> float:
    """Condition number of the regressor over one period, columns scaled to unit length."""
    W = model.regressor(*motion.over(PERIOD)).reshape(2 * len(PERIOD), -1)
    return float(np.linalg.cond(W / np.linalg.norm(W, axis=0)))
