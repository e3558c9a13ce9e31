"""The experiments of document 1, as data: poses and motions of one leg.

The document prints neither poses nor amplitudes; those here are assumptions within the limits of the URDF.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.signals import Poses

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

    def split(self, poses: Poses) -> tuple[Poses, Poses, Poses, Poses]:
        """Separate what was measured at :attr:`all` into the ankle's sets, the knee's, pairs and random poses.

        Raises:
            ExoidError: There are not as many poses as were asked for.
        """
        ends = np.cumsum([len(self.ankle), len(self.knee), len(self.pairs), len(self.random)])
        if len(poses) != ends[-1]:
            raise ExoidError(f"{len(poses)} poses, {ends[-1]} were asked for", remedy="measure each pose once")
        ankle, knee, pairs, random = (poses.take(slice(b, e)) for b, e in zip((0, *ends[:-1]), ends, strict=True))
        return ankle, knee, pairs, random


def static_sets(rng: np.random.Generator, poses: int = 100) -> StaticSets:
    """Choose the poses: sets as the document describes them, and random ones.

    Args:
        rng: For the random poses.
        poses: How many of them.

    Raises:
        ExoidError: There are no random poses.
    """
    if poses < 1:
        raise ExoidError(f"{poses} random poses", remedy="ask for at least one")
    ankle, ankle_set = _ankle_sets()
    knee, knee_set = _knee_sets()
    lower, upper = np.deg2rad([-1.0, -112.0, -36.0]), np.deg2rad([112.0, -9.0, 36.0])
    return StaticSets(ankle, ankle_set, knee, knee_set, _pairs(), rng.uniform(lower, upper, (poses, 3)))


def _ankle_sets() -> tuple[FloatArray, FloatArray]:
    """Three values of θ123, at each of which θ3 varies; hip and knee share what is left, both within their limits."""
    poses, of_set = [], []
    for index, total in enumerate(np.deg2rad([-40.0, -10.0, 20.0])):
        for ankle in np.deg2rad(np.linspace(-38.0, 38.0, 9)):
            hip = np.clip(total - ankle + np.deg2rad(45.0), np.deg2rad(5.0), np.deg2rad(100.0))
            poses.append((hip, total - ankle - hip, ankle))
            of_set.append(index)
    return np.array(poses), np.array(of_set, dtype=np.float64)


def _knee_sets() -> tuple[FloatArray, FloatArray]:
    """Three values of θ12, at each of which θ2 varies as far as the hip can make up for it."""
    poses, of_set = [], []
    for index, total in enumerate(np.deg2rad([-45.0, -20.0, 0.0])):
        for knee in np.deg2rad(np.linspace(-105.0, -8.0, 9)):
            if np.deg2rad(-2.0) <= total - knee <= np.deg2rad(112.0):
                poses.append((total - knee, knee, np.deg2rad(5.0)))
                of_set.append(index)
    return np.array(poses), np.array(of_set, dtype=np.float64)


def _pairs() -> FloatArray:
    """θ12 low with the leg back and the knee bent, then 180° higher with the hip far forward and the knee straight."""
    poses = []
    for ankle in np.deg2rad(np.linspace(-30.0, 30.0, 7)):
        for low in np.deg2rad([-80.0, -76.0, -72.0]):
            poses.append((np.deg2rad(20.0), low - np.deg2rad(20.0), ankle))
            poses.append((np.deg2rad(111.0), low + np.pi - np.deg2rad(111.0), ankle))
    return np.array(poses)


CENTRE = np.deg2rad([30.0, -45.0, 0.0])
"""About which joints swing [rad]."""

AMPLITUDE = np.deg2rad([14.0, 14.0, 22.0])
"""Of the sinusoids of hip, knee and ankle [rad]."""


def dynamic_motions() -> Harmonics:
    """All motions of the dynamic experiments as rigs side by side.

    Rig 5 j + k: joint j follows a sinusoid of the k-th frequency while the others are held (sec. III-F, III-G). Rig 15,
    :data:`VALIDATION`: all joints move at once, at frequencies and phases of their own (sec. IV-B).
    """
    rigs = 3 * len(FREQUENCIES) + 1
    amplitude, frequency, phase = np.zeros((3, 2, 3, rigs))
    for joint in (HIP, KNEE, ANKLE):
        for k, each in enumerate(FREQUENCIES):
            amplitude[0, joint, swing(joint, k)] = AMPLITUDE[joint]
            frequency[0, joint, swing(joint, k)] = 2.0 * np.pi * each
    amplitude[..., VALIDATION] = np.deg2rad([[20.0, 18.0, 14.0], [8.0, 8.0, 8.0]])
    frequency[..., VALIDATION] = 2.0 * np.pi * np.array([[0.35, 0.5, 0.7], [0.8, 0.65, 0.3]])
    phase[..., VALIDATION] = [[0.0, 1.0, 2.0], [0.5, 2.5, 4.0]]
    return Harmonics(np.tile(CENTRE[:, None], (1, rigs)), amplitude, frequency, phase)


VALIDATION = 3 * len(FREQUENCIES)
"""Rig of the validation motion in :func:`dynamic_motions`."""


def swing(joint: int, k: int) -> int:
    """Rig in which a joint swings at the k-th frequency."""
    return joint * len(FREQUENCIES) + k
