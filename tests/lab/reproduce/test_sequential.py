"""Each step of the documents' procedures identifies its parameters and their uncertainty."""

import dataclasses
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pytest

import exoid
from exoid import Recording, published
from exoid.errors import ExoidError
from exoid.experiments import bleex, cuhk
from exoid.lab.reproduce.sequential import bleex as steps
from exoid.lab.reproduce.sequential import cuhk as cuhk_steps
from exoid.lab.reproduce.sequential.estimate import SequentialEstimate
from exoid.signals import FiniteDifference, Poses
from exoid.torques import TorqueModel

# Both experiments without a rig: exact poses and motions, torque from the regressor, noise if wanted


@dataclasses.dataclass(frozen=True)
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


# Steps


@pytest.fixture(scope="module", params=["left", "right"])
def exact(request):
    model = steps.document_model(exoid.load_leg("bleex", request.param))
    return Exact(model, bleex_truth(request.param))


@pytest.fixture(scope="module")
def data(exact):
    return bleex_data(exact)


def test_all_steps_in_turn_give_every_parameter_back(exact, data):
    found = bleex_all(exact.model, data).as_dict()
    assert found.keys() == exact.truth.keys()
    for name, value in exact.truth.items():
        assert found[name] == pytest.approx(value, rel=1e-9, abs=1e-9), name


def scatter(estimates):
    """Standard deviation over replicates, and the mean of what they claim."""
    values = np.array([estimate.values for estimate in estimates])
    return values.std(axis=0, ddof=1), np.sqrt(np.mean([np.diag(e.covariance) for e in estimates], axis=0))


def assert_honest(estimates, tolerance=0.15):
    actual, claimed = scatter(estimates)
    ratio = dict(zip(estimates[0].names, claimed / actual, strict=True))
    wrong = {name: round(float(r), 3) for name, r in ratio.items() if abs(r - 1.0) > tolerance}
    assert not wrong


@pytest.fixture(scope="module")
def noisy_bleex():
    """Estimates from 150 replicates of document 1's experiments on the left leg, which tell a deviation to 6 %."""
    model = steps.document_model(exoid.load_leg("bleex"))
    sets, measured, swings = bleex_data(Exact(model, bleex_truth("left")), seconds=5.0, poses=40)
    few = [of_joint[::2] for of_joint in swings]  # three of five frequencies are enough here
    noisy = Noisy(np.random.default_rng(3), (0.3, 0.2, 0.1))
    return [bleex_all(model, (sets, noisy(measured), noisy(few))) for _ in range(150)]


@pytest.mark.slow
def test_what_document_1_steps_claim_agrees_with_the_scatter(noisy_bleex):
    """Including what each inherits from the steps before, and how errors go together."""
    assert_honest(noisy_bleex)
    claimed = noisy_bleex[0].covariance / np.outer(noisy_bleex[0].std, noisy_bleex[0].std)
    actual = np.corrcoef(np.array([estimate.values for estimate in noisy_bleex]).T)
    np.testing.assert_allclose(actual, claimed, atol=0.35)


@pytest.mark.slow
def test_estimates_are_unbiased_by_noise(noisy_bleex):
    values = np.array([estimate.values for estimate in noisy_bleex])
    truth = np.array([bleex_truth("left")[name] for name in noisy_bleex[0].names])
    assert (np.abs(values.mean(axis=0) - truth) < 4.0 * values.std(axis=0) / np.sqrt(len(values))).all()


def test_all_steps_of_document_2_are_exact_without_its_moving_average(cuhk_leg):
    known = cuhk_all(cuhk_leg, cuhk_data(cuhk_leg), FiniteDifference())
    truth = {**cuhk_truth(), **CUHK_FRICTION}
    assert set(known.names) == set(truth)
    for name, value in truth.items():
        assert known.as_dict()[name] == pytest.approx(value, rel=1e-9, abs=1e-9), name


def test_the_moving_average_biases_what_moves_but_not_what_stands(cuhk_leg):
    known = cuhk_all(cuhk_leg, cuhk_data(cuhk_leg)).as_dict()
    truth = {**cuhk_truth(), **CUHK_FRICTION}
    assert all(known[name] == pytest.approx(truth[name], abs=1e-9) for name in ("b1_knee", "X1", "Y1", "X2", "Y2"))
    assert known["c0_hip"] < truth["c0_hip"] - 0.03
    assert known["d_hip"] > truth["d_hip"] + 0.2


NOTHING = SequentialEstimate()
REFUSED = {  # words: call with the model, sets, poses, swings and poses that are all alike
    "hip, knee and ankle": lambda *_: steps.document_model(exoid.load_leg("cuhk")),
    "hip and knee": lambda *_: cuhk_steps.document_model(exoid.load_leg("bleex")),
    "not pairs": lambda m, sets, poses, *_: steps.ankle_offset(m, NOTHING, sets.split(poses)[2].take(slice(3))),
    "gravity does not cancel": lambda m, sets, poses, *_: steps.ankle_offset(
        m, NOTHING, sets.split(poses)[3].take(slice(4))
    ),
    "one number a pose": lambda m, sets, poses, *_: steps.stiffness_coefficients(
        m, NOTHING, poses, sets.ankle_set, steps.ANKLE
    ),
    "X3, Y3 is known already": lambda m, sets, poses, *_: steps.mass_moments(
        m, steps.mass_moments(m, NOTHING, sets.split(poses)[3], steps.ANKLE), poses, steps.ANKLE
    ),
    "do not determine X3, Y3": lambda m, sets, poses, swings, alike: steps.mass_moments(m, NOTHING, alike, steps.ANKLE),
    "too few measurements": lambda m, sets, poses, swings, alike: steps.mass_moments(
        m, NOTHING, alike.take(slice(2)), steps.ANKLE
    ),
    "no torque": lambda m, sets, poses, swings, _: steps.inertia(
        m, NOTHING, [dataclasses.replace(swings[1][0], tau=None)], 3
    ),
    "no recordings": lambda m, *_: steps.inertia(m, NOTHING, [], 3),
    "c0_knee": lambda m, sets, poses, swings, _: steps.kinetic_friction(m, NOTHING, swings[steps.ANKLE], steps.KNEE),
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_the_steps_cannot_use_is_refused(words, exact, data):
    alike = exact.poses(np.tile(data[1].q[:1], (10, 1)))
    with pytest.raises(ExoidError, match=words):
        REFUSED[words](exact.model, *data, alike)
