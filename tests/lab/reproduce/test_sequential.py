"""Each step of the documents' procedures identifies its parameters and their uncertainty."""

import dataclasses

import numpy as np
import pytest
from exact_experiments import (
    CUHK_FRICTION,
    Exact,
    Noisy,
    bleex_all,
    bleex_data,
    bleex_truth,
    cuhk_all,
    cuhk_data,
    cuhk_truth,
)

import exoid
from exoid.errors import ExoidError
from exoid.lab.reproduce.sequential import bleex as steps
from exoid.lab.reproduce.sequential import cuhk as cuhk_steps
from exoid.lab.reproduce.sequential.estimate import SequentialEstimate
from exoid.signals import FiniteDifference


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
