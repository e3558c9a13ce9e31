"""The experiments of document 1, as data: poses and motions of one leg.

The document prints neither poses nor amplitudes; those here are assumptions within the limits of the URDF.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray

from .references import Harmonics

HIP, KNEE, ANKLE = 0, 1, 2
FREQUENCIES = (0.2, 0.4, 0.6, 0.8, 1.0)
"""[Hz], sec. III-F."""
LOG_RATE = 50.0
"""[Hz], sec. III-B2."""


@dataclass(frozen=True, eq=False)
class StaticSets:
    """Poses of the static experiments, (K, n) each [rad].

    Attributes:
        ankle: Sets of constant θ123 with θ3 varying, for b2 and b1 of the ankle (eq. (20)).
        ankle_set: Which set each belongs to, (K,).
        knee: Sets of constant θ12 and θ3 with θ2 varying, for b2 and b1 of the knee.
        knee_set: Which set each belongs to, (K,).
        pairs: Pairs with θ12 180° apart and the same θ3, one after the other, for b0 of the ankle (eqs. (22)-(25)).
        random: 100 poses for the mass moments (sec. III-E).
    """

    ankle: FloatArray
    ankle_set: FloatArray
    knee: FloatArray
    knee_set: FloatArray
    pairs: FloatArray
    random: FloatArray

    @property
    def all(self) -> FloatArray:
        """All poses, in the order of the attributes."""
        return np.vstack([self.ankle, self.knee, self.pairs, self.random])


def static_sets(rng: np.random.Generator, poses: int = 100) -> StaticSets:
    """Choose the poses: sets as the document describes them, and random ones.

    Args:
        rng: For the random poses.
        poses: How many of them.
    """
    ankle, ankle_set, knee, knee_set = [], [], [], []
    for index, total in enumerate(np.deg2rad([-40.0, -10.0, 20.0])):
        for ankle_angle in np.deg2rad(np.linspace(-38.0, 38.0, 9)):
            thigh_and_shank = total - ankle_angle  # hip and knee share it, both within their limits
            hip = np.clip(thigh_and_shank + np.deg2rad(45.0), np.deg2rad(5.0), np.deg2rad(100.0))
            ankle.append((hip, thigh_and_shank - hip, ankle_angle))
            ankle_set.append(index)
    for index, total in enumerate(np.deg2rad([-45.0, -20.0, 0.0])):
        for knee_angle in np.deg2rad(np.linspace(-105.0, -8.0, 9)):
            hip = total - knee_angle
            if np.deg2rad(-2.0) <= hip <= np.deg2rad(112.0):
                knee.append((hip, knee_angle, np.deg2rad(5.0)))
                knee_set.append(index)
    pairs = []
    for ankle_angle in np.deg2rad(np.linspace(-30.0, 30.0, 7)):
        for shift in np.deg2rad([0.0, 4.0, 8.0]):
            low = np.deg2rad(-80.0) + shift  # θ12 of the first, 180° below the second
            pairs.append((np.deg2rad(20.0), low - np.deg2rad(20.0), ankle_angle))
            pairs.append((np.deg2rad(111.0), low + np.pi - np.deg2rad(111.0), ankle_angle))
    lower, upper = np.deg2rad([-1.0, -112.0, -36.0]), np.deg2rad([112.0, -9.0, 36.0])
    random = rng.uniform(lower, upper, (poses, 3))
    return StaticSets(*(np.array(x) for x in (ankle, ankle_set, knee, knee_set, pairs, random)))


CENTRE = np.deg2rad([30.0, -45.0, 0.0])
"""About which joints swing [rad]."""

AMPLITUDE = np.deg2rad(14.0)
"""Of the sinusoids [rad]."""


def dynamic_motions() -> Harmonics:
    """All motions of the dynamic experiments as rigs side by side.

    Rig 5 j + k: joint j follows a sinusoid of the k-th frequency while the others are held (sec. III-F, III-G). Rig 15,
    :data:`VALIDATION`: all joints move at once, at frequencies and phases of their own (sec. IV-B).
    """
    rigs = 3 * len(FREQUENCIES) + 1
    amplitude, frequency, phase = np.zeros((3, 2, 3, rigs))
    for joint in (HIP, KNEE, ANKLE):
        for k, each in enumerate(FREQUENCIES):
            amplitude[0, joint, swing(joint, k)] = AMPLITUDE
            frequency[0, joint, swing(joint, k)] = 2.0 * np.pi * each
    amplitude[..., VALIDATION] = np.deg2rad([[16.0, 18.0, 14.0], [8.0, 8.0, 8.0]])
    frequency[..., VALIDATION] = 2.0 * np.pi * np.array([[0.35, 0.5, 0.7], [0.8, 0.65, 0.3]])
    phase[..., VALIDATION] = [[0.0, 1.0, 2.0], [0.5, 2.5, 4.0]]
    return Harmonics(np.tile(CENTRE[:, None], (1, rigs)), amplitude, frequency, phase)


VALIDATION = 3 * len(FREQUENCIES)
"""Rig of the validation motion in :func:`dynamic_motions`."""


def swing(joint: int, k: int) -> int:
    """Rig in which a joint swings at the k-th frequency."""
    return joint * len(FREQUENCIES) + k
