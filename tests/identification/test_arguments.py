"""No argument of identify is silently ignored: with every estimator it changes the estimate, or it is refused."""

import dataclasses

import numpy as np
import pytest
from swings import TERMS, Swing
from unchecked import identify

import exoid
from exoid import ExoidError
from exoid.identification.estimators import JointML
from exoid.signals import MovingAverage

SWING = Swing(exoid.load_leg("cuhk"), 100.0, 8.0)
ESTIMATORS = {"ols": "ols", "wls": "wls", "huber": "huber", "ml": JointML(0.06)}
ARGUMENTS = {
    "cutoff": {"cutoff": 4.0},
    "preparation": {"preparation": MovingAverage()},
    "both": {"cutoff": 4.0, "preparation": MovingAverage()},
    "noise": {"noise": "white"},
    "known": {"known": {"X1": 1.02 * SWING.truth[0]}},
    "prior": {"prior": {"J2": (1.1 * SWING.truth[5], 1e-4)}},
    "nonnegative": {"nonnegative": True},
    "own": {"own": ("c0",)},
}
REFUSED = {
    "both": (tuple(ESTIMATORS), "pass one of them"),
    "cutoff": (("ml",), "ml.*cutoff does not apply"),
    "preparation": (("ml",), "ml.*preparation does not apply"),
    "own": (("ml",), "for one leg alone"),
}


@pytest.fixture(scope="module")
def recordings():
    """Friction of the knee is negative, so that a bound must act; two days, so that parameters may differ."""
    first = SWING.with_noise(np.random.default_rng(1), 0.3)
    first = dataclasses.replace(first, tau=first.tau - np.array([0.0, 4.0]) * SWING.motion[1])
    noise = np.random.default_rng(2).normal(scale=0.1, size=first.tau.shape)
    return [first, dataclasses.replace(first, tau=first.tau + noise)]


@pytest.mark.parametrize("name", ESTIMATORS)
def test_every_argument_acts_or_is_refused(recordings, name):
    plain = identify(SWING.leg, recordings[0], TERMS, ESTIMATORS[name])
    for argument, given in ARGUMENTS.items():
        data = recordings if argument == "own" else recordings[0]
        estimators, words = REFUSED.get(argument, ((), ""))
        if name in estimators:
            with pytest.raises(ExoidError, match=words):
                identify(SWING.leg, data, TERMS, ESTIMATORS[name], **given)
            continue
        found = identify(SWING.leg, data, TERMS, ESTIMATORS[name], **given)
        if argument == "own":
            assert {f"c0_{joint}[{group}]" for joint in ("hip", "knee") for group in "12"} <= set(found.names)
        elif argument == "noise":
            np.testing.assert_allclose(found.values, plain.values, rtol=1e-9)
            assert (np.abs(found.std / plain.std - 1.0) > 1e-3).any()
        else:
            assert (np.abs(found.values - plain.values) > 1e-6).any(), argument
