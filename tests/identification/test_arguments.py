"""No argument of identify is silently ignored: with every estimator it changes the estimate, or it is refused."""

import dataclasses

import numpy as np
import pytest
from test_closed_loop_estimators import LEG, LOOP, TERMS, TRUTH, log, noisy

import exoid
from exoid import ExoidError
from exoid.identification.estimators import JointML, OutputError
from exoid.signals import MovingAverage

ESTIMATORS = {
    "ols": "ols",
    "wls": "wls",
    "huber": "huber",
    "gls": "gls",
    "ml": JointML(0.06),
    "output-error": OutputError(LOOP),
}
ARGUMENTS = {
    "cutoff": {"cutoff": 4.0},
    "preparation": {"preparation": MovingAverage()},
    "both": {"cutoff": 4.0, "preparation": MovingAverage()},
    "noise": {"noise": "white"},
    "known": {"known": {"X1": 1.02 * TRUTH[0]}},
    "prior": {"prior": {"J2": (1.1 * TRUTH[5], 1e-4)}},
    "nonnegative": {"nonnegative": True},
    "own": {"own": ("c0",)},
}
REFUSED = {
    *((name, "both") for name in ESTIMATORS),
    *((name, argument) for name in ("ml", "output-error") for argument in ("cutoff", "preparation")),
    *((name, "own") for name in ("ml", "output-error")),
    ("gls", "noise"),
}


@pytest.fixture(scope="module")
def recordings():
    """Friction of the knee is negative, so that a bound must act; two days, so that parameters may differ."""
    truth = TRUTH.copy()
    first = noisy(log(truth=truth), 1e-5, 0.3, 1)
    v = np.gradient(first.q, 1.0 / first.sample_rate, axis=0)
    first = dataclasses.replace(first, tau=first.tau - np.array([0.0, 0.8]) * v)
    return [first, noisy(first, 0.0, 0.1, 2)]


@pytest.fixture(scope="module")
def plain(recordings):
    """Estimates without the argument."""
    return {name: identify(recordings, name) for name in ESTIMATORS}


def identify(recordings, name, **arguments):
    data = recordings if "own" in arguments else recordings[:1]
    return exoid.identify(LEG, data, TERMS, ESTIMATORS[name], check=False, **arguments)


SLOW = {("output-error", argument) for argument in ("known", "prior", "nonnegative")}
CASES = [
    pytest.param(name, argument, id=f"{name}-{argument}", marks=[pytest.mark.slow] if (name, argument) in SLOW else [])
    for name in ESTIMATORS
    for argument in ARGUMENTS
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "argument"), CASES)
def test_every_argument_acts_or_is_refused(recordings, plain, name, argument):
    if (name, argument) in REFUSED:
        with pytest.raises(ExoidError):
            identify(recordings, name, **ARGUMENTS[argument])
        return
    found = identify(recordings, name, **ARGUMENTS[argument])
    if argument == "own":
        assert {f"c0_{joint}[{group}]" for joint in ("hip", "knee") for group in "12"} <= set(found.names)
    elif (name, argument) == ("output-error", "nonnegative"):  # which it always is
        np.testing.assert_allclose(found.values, plain[name].values, rtol=1e-4)
        assert plain[name].value("d_knee") >= 0.0
    elif argument == "noise":
        np.testing.assert_allclose(found.values, plain[name].values, rtol=1e-9)
        assert (np.abs(found.std / plain[name].std - 1.0) > 1e-3).any()
    else:
        assert (np.abs(found.values - plain[name].values) > 1e-6).any()


def test_a_refusal_names_the_argument(recordings):
    for argument in ("cutoff", "preparation"):
        with pytest.raises(ExoidError, match=f"ml.*{argument} does not apply"):
            identify(recordings, "ml", **ARGUMENTS[argument])
    with pytest.raises(ExoidError, match="noise='white' does not apply"):
        identify(recordings, "gls", noise="white")
    with pytest.raises(ExoidError, match="pass one of them"):
        identify(recordings, "wls", **ARGUMENTS["both"])
