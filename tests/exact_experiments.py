"""Both documents' experiments without a rig: exact poses and motions, torque from the regressor, noise if wanted."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid import Recording, published
from exoid.experiments import bleex, cuhk
from exoid.lab.reproduce.sequential import bleex as bleex_steps
from exoid.lab.reproduce.sequential import cuhk as cuhk_steps
from exoid.lab.reproduce.sequential.estimate import SequentialEstimate
from exoid.signals import Poses
from exoid.torques import TorqueModel


@dataclass(frozen=True)
class Exact:
    """Measurements of a leg whose every parameter is known.

    Attributes:
        model: The document's.
        truth: Parameters by name; what is not named is zero.
    """

    model: TorqueModel
    truth: Mapping[str, float]

    def torque(self, q, v, a):
        return self.model.regressor(q, v, a) @ np.array([self.truth.get(name, 0.0) for name in self.model.names])

    def poses(self, q):
        still = np.zeros_like(q)
        return Poses(q, self.torque(q, still, still), self.model.leg.joint_names)

    def recording(self, motion, rig, seconds, rate):
        time = np.arange(round(seconds * rate)) / rate
        samples = [motion.at(t) for t in time]
        q, v, a = (np.array([part[:, rig] for part in parts]) for parts in zip(*samples, strict=True))
        return Recording(time=time, q=q, v=v, a=a, tau=self.torque(q, v, a), joint_names=self.model.leg.joint_names)


class Noisy(NamedTuple):
    """Adds white noise of a standard deviation for each joint [N·m] to all torques of some measurements."""

    rng: np.random.Generator
    std: tuple[float, ...]

    def __call__(self, data):
        if isinstance(data, (Poses, Recording)):
            return dataclasses.replace(data, tau=data.tau + self.rng.standard_normal(data.tau.shape) * self.std)
        return [self(item) for item in data]


def bleex_truth(side):
    """Tables I to IV in exoid's signs; the hip has neither stiffness nor friction, as the document assumes."""
    return {**published.bleex_parameters(side), **published.bleex_resistances(side)}


def cuhk_truth():
    """The plant of this library without friction where document 2 neglects it."""
    return {**published.cuhk_parameters(), "b1_knee": 0.5, "b0_knee": -0.4}


def bleex_data(exact, seconds=10.0, poses=100):
    """Poses as measured, the sets they belong to, and recordings of the swinging hip, knee and ankle."""
    sets = bleex.static_sets(np.random.default_rng(1), poses)
    motions = bleex.dynamic_motions()
    swings = [
        [exact.recording(motions, bleex.swing_index(joint, k), seconds, bleex.LOG_RATE) for k in range(5)]
        for joint in range(3)
    ]
    return sets, exact.poses(sets.all), swings


BLEEX_STEPS = {
    "ankle stiffness": ("b2_ankle", "b1_ankle"),
    "ankle offset": ("b0_ankle",),
    "foot moments": ("X3", "Y3"),
    "knee stiffness": ("b2_knee", "b1_knee"),
    "shank moments": ("X2", "Y2", "b0_knee"),
    "thigh moments": ("X1", "Y1"),
    "foot inertia": ("J3",),
    "shank inertia": ("J2",),
    "thigh inertia": ("J1",),
    "ankle friction": ("c0_ankle",),
    "knee friction": ("c0_knee",),
}
"""Document 1's steps in its order, and what each finds."""


def bleex_step(name, known, model, data):
    """Take one step of document 1."""
    sets, measured, swings = data
    ankle, knee, pairs, random = sets.split(measured)
    steps = bleex_steps
    return {
        "ankle stiffness": lambda: steps.stiffness_coefficients(model, known, ankle, sets.ankle_set, steps.ANKLE),
        "ankle offset": lambda: steps.ankle_offset(model, known, pairs),
        "foot moments": lambda: steps.mass_moments(model, known, random, steps.ANKLE),
        "knee stiffness": lambda: steps.stiffness_coefficients(model, known, knee, sets.knee_set, steps.KNEE),
        "shank moments": lambda: steps.mass_moments(model, known, random, steps.KNEE),
        "thigh moments": lambda: steps.mass_moments(model, known, random, steps.HIP),
        "foot inertia": lambda: steps.inertia(model, known, swings[steps.KNEE], 3),
        "shank inertia": lambda: steps.inertia(model, known, swings[steps.HIP], 2),
        "thigh inertia": lambda: steps.inertia(model, known, swings[steps.HIP], 1),
        "ankle friction": lambda: steps.kinetic_friction(model, known, swings[steps.ANKLE], steps.ANKLE),
        "knee friction": lambda: steps.kinetic_friction(model, known, swings[steps.KNEE], steps.KNEE),
    }[name]()


def bleex_all(model, data):
    """Take all of them."""
    known = SequentialEstimate()
    for name in BLEEX_STEPS:
        known = bleex_step(name, known, model, data)
    return known


class CuhkData(NamedTuple):
    """Rows 1 to 5 of Table II; friction, which row 3 neglects, acts from row 4 on."""

    row1: Poses
    row2: Poses
    row3: Recording
    row4: Recording
    row5: Recording


CUHK_FRICTION = {"c0_knee": 0.593, "d_knee": 0.192, "c0_hip": 1.445, "d_hip": 0.038, "b0_hip": 0.7}


def cuhk_data(leg, seconds=20.0):
    """Document 2's five experiments, exact."""
    model = cuhk_steps.document_model(leg)
    smooth, rough = Exact(model, cuhk_truth()), Exact(model, {**cuhk_truth(), **CUHK_FRICTION})
    hip, knee = cuhk.swing(cuhk.HIP), cuhk.swing(cuhk.KNEE)
    return CuhkData(
        smooth.poses(cuhk.stiffness_poses()),
        smooth.poses(cuhk.random_poses(np.random.default_rng(2))),
        smooth.recording(hip, 0, seconds, cuhk.LOG_RATE),
        rough.recording(knee, 0, seconds, cuhk.LOG_RATE),
        rough.recording(hip, 0, seconds, cuhk.LOG_RATE),
    )


def cuhk_all(leg, data, preparation=None):
    """Take document 2's five steps."""
    model, (row1, row2, row3, row4, row5) = cuhk_steps.document_model(leg), data
    known = cuhk_steps.knee_stiffness(model, SequentialEstimate(), row1)
    known = cuhk_steps.mass_moments(model, known, row2)
    known = cuhk_steps.inertias(model, known, row3, preparation)
    known = cuhk_steps.damping(model, known, row4, cuhk.KNEE, preparation)
    return cuhk_steps.damping(model, known, row5, cuhk.HIP, preparation)
