"""Experiments of document 1 as data: poses and motions of one leg.

The document prints neither poses nor amplitudes. The values here are assumptions within the limits of the URDF.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.signals import Poses

from .references import Harmonics

HIP, KNEE, ANKLE = 0, 1, 2
FREQUENCIES = (0.2, 0.4, 0.6, 0.8, 1.0)
"""Frequencies of the dynamic experiments [Hz] (doc. 1, sec. III-F)."""

LOG_RATE = 50.0
"""Sampling rate of the log [Hz] (doc. 1, sec. III-B2)."""


@dataclass(frozen=True, eq=False, repr=False)
class StaticSets:
    """Poses of the static experiments, (K, n) each [rad]."""

    ankle: FloatArray  # sets of constant θ123 and varying θ3, for b2 and b1 of the ankle (doc. 1, eq. (20))
    ankle_set: FloatArray  # number of the set of each ankle pose, (K,)
    knee: FloatArray  # sets of constant θ12 and θ3 and varying θ2, for b2 and b1 of the knee
    knee_set: FloatArray  # number of the set of each knee pose, (K,)
    # consecutive pairs with the same θ3 and θ12 180° apart, for b0 of the ankle (doc. 1, eqs. (22)-(25))
    pairs: FloatArray
    random: FloatArray  # random poses for the mass moments (doc. 1, sec. III-E)

    @property
    def all(self) -> FloatArray:
        """All poses in the order of the attributes, (K, n) [rad]."""
        return np.vstack([self.ankle, self.knee, self.pairs, self.random])

    def split(self, poses: Poses) -> tuple[Poses, Poses, Poses, Poses]:
        """Split measurements at :attr:`all`."""
        ends = np.cumsum([len(self.ankle), len(self.knee), len(self.pairs), len(self.random)])
        if len(poses) != ends[-1]:
            raise BadArgumentError(f"{len(poses)} poses instead of {ends[-1]}", remedy="measure each pose once")
        ankle, knee, pairs, random = (poses.take(slice(b, e)) for b, e in zip((0, *ends[:-1]), ends, strict=True))
        return ankle, knee, pairs, random


def static_sets(rng: np.random.Generator, poses: int = 100) -> StaticSets:
    """Choose the sets of poses that document 1 describes, and random poses."""
    if poses < 1:
        raise BadArgumentError(f"{poses} random poses", remedy="request at least one")
    ankles, knees, pairs = [], [], []  # each pose of the first two with the number of its set
    for index, total in enumerate(np.deg2rad([-40.0, -10.0, 20.0])):  # θ123; hip and knee share what θ3 leaves
        for ankle in np.deg2rad(np.linspace(-38.0, 38.0, 9)):
            hip = np.clip(total - ankle + np.deg2rad(45.0), np.deg2rad(5.0), np.deg2rad(100.0))
            ankles.append((hip, total - ankle - hip, ankle, index))
    for index, total in enumerate(np.deg2rad([-45.0, -20.0, 0.0])):  # θ12; θ2 varies as far as the hip allows
        for knee in np.deg2rad(np.linspace(-105.0, -8.0, 9)):
            if np.deg2rad(-2.0) <= total - knee <= np.deg2rad(112.0):
                knees.append((total - knee, knee, np.deg2rad(5.0), index))
    for ankle in np.deg2rad(np.linspace(-30.0, 30.0, 7)):
        for low in np.deg2rad([-80.0, -76.0, -72.0]):  # leg back and knee bent, then hip forward and knee straight
            pairs.append((np.deg2rad(20.0), low - np.deg2rad(20.0), ankle))
            pairs.append((np.deg2rad(111.0), low + np.pi - np.deg2rad(111.0), ankle))
    (ankle, ankle_set), (knee, knee_set) = ((rows[:, :3], rows[:, 3]) for rows in map(np.array, (ankles, knees)))
    lower, upper = np.deg2rad([-1.0, -112.0, -36.0]), np.deg2rad([112.0, -9.0, 36.0])
    random = rng.uniform(lower, upper, (poses, 3))
    return StaticSets(ankle, ankle_set, knee, knee_set, np.array(pairs), random)


CENTRE = np.deg2rad([30.0, -45.0, 0.0])
"""Mean angles of the dynamic experiments, hip, knee and ankle [rad]."""

AMPLITUDE = np.deg2rad([14.0, 14.0, 22.0])
"""Amplitudes of the sinusoids of hip, knee and ankle [rad]."""


def dynamic_motions() -> Harmonics:
    """Make all motions of the dynamic experiments, one a rig."""
    # In rig 5 j + k joint j follows a sinusoid of the k-th frequency while the others are held (doc. 1, sec. III-F and
    # III-G). In rig 15, `VALIDATION`, all joints move at different frequencies and phases (doc. 1, sec. IV-B).
    rigs = 3 * len(FREQUENCIES) + 1
    amplitude, frequency, phase = np.zeros((3, 2, 3, rigs))
    for joint in (HIP, KNEE, ANKLE):
        for k, each in enumerate(FREQUENCIES):
            amplitude[0, joint, swing_index(joint, k)] = AMPLITUDE[joint]
            frequency[0, joint, swing_index(joint, k)] = 2.0 * np.pi * each
    amplitude[..., VALIDATION] = np.deg2rad([[20.0, 18.0, 14.0], [8.0, 8.0, 8.0]])
    frequency[..., VALIDATION] = 2.0 * np.pi * np.array([[0.35, 0.5, 0.7], [0.8, 0.65, 0.3]])
    phase[..., VALIDATION] = [[0.0, 1.0, 2.0], [0.5, 2.5, 4.0]]
    return Harmonics(np.tile(CENTRE[:, None], (1, rigs)), amplitude, frequency, phase)


VALIDATION = 3 * len(FREQUENCIES)
"""Index of the rig with the validation motion in :func:`dynamic_motions`."""


def swing_index(joint: int, k: int) -> int:
    """Index of the rig in :func:`dynamic_motions` in which a joint swings at the k-th frequency."""
    return joint * len(FREQUENCIES) + k
