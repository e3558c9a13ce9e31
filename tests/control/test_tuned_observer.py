"""Bandwidths by a log: nearly the least error of all bandwidths, within the delay that is allowed."""

from dataclasses import replace

import numpy as np
import pytest
from observing import WornLog, estimate_of, nrmse

import exoid
from exoid import ExoidError
from exoid.control import KalmanObserver, MomentumObserver, tuned_observer

RATE = 1000.0


@pytest.fixture(scope="module")
def estimate():
    return estimate_of(exoid.load_leg("cuhk"))


@pytest.fixture(scope="module")
def logs(estimate):
    """Two worn logs with the same kind of torque."""
    return [WornLog(estimate.leg, 6.0, RATE, seed=seed, size=0.5) for seed in (4, 5)]


@pytest.fixture(scope="module")
def tuned(estimate, logs):
    return tuned_observer(MomentumObserver(estimate, 10.0, RATE), logs[0].recording())


def error(observer, log):
    """Mean square error over the variance of the torque, of the same samples for all observers."""
    return nrmse(observer.run(log.recording()).torque, log.wearer, 1000)


def test_the_error_is_nearly_the_least_of_all_bandwidths(tuned, logs):
    chosen = error(tuned, logs[1])
    every = [
        error(replace(tuned, bandwidth=bandwidth, cutoff=cutoff), logs[1])
        for bandwidth in (10.0, 20.0, 40.0)
        for cutoff in (20.0, 40.0)
    ]
    assert (chosen < 1.15 * np.min(every, axis=0)).all()
    assert (chosen < 0.25).all()
    assert tuned.delay.max() <= 0.025


def test_more_noise_asks_for_a_narrower_band(logs, tuned):
    noisy = tuned_observer(replace(tuned, noise=None), replace(logs[0], noise=6.0).recording())
    assert (noisy.delay > 1.1 * tuned.delay).all()
    assert (noisy.bandwidths < tuned.bandwidths).all()


def test_the_delay_is_bounded(logs, tuned):
    calm = replace(logs[0], noise=20.0).recording()
    observer = replace(tuned, noise=None)
    free, bound = (tuned_observer(observer, calm, delay=delay).delay.max() for delay in (0.2, 0.012))
    assert free > 0.012 >= bound
    with pytest.raises(ExoidError, match="a delay of at most 1 ms"):
        tuned_observer(observer, calm, delay=1e-3)


@pytest.mark.slow
def test_a_kalman_observer_is_tuned_alike(estimate, logs, tuned):
    kalman = tuned_observer(KalmanObserver(estimate, 10.0, RATE), logs[0].recording())
    assert kalman.delay.max() <= 0.025
    assert (error(kalman, logs[1]) < 1.2 * error(tuned, logs[1])).all()
