"""Swing phases of 0.4 s, as segments of a longer log or as recordings of their own."""

import dataclasses
from functools import cache

import numpy as np
import pytest
from swings import TERMS, Swing, coloured, holds

import exoid
from exoid import ExoidError
from exoid.regression.every_row import make_rows
from exoid.signals import ZeroPhase
from exoid.torques import TorqueModel

pytestmark = pytest.mark.slow

RATE, SWINGS, LENGTH = 100.0, 30, 0.4
NOISE = np.array([0.3, 0.2, 0.1])


@cache
def swing(seed=1):
    return Swing(exoid.load_leg("bleex"), RATE, SWINGS + 1.0, seed, base=0.45)


def mask():
    inside = np.zeros(len(swing().time), dtype=bool)
    for k in range(SWINGS):
        inside[round((0.3 + k) * RATE) :][: round(LENGTH * RATE)] = True
    return inside


def log(noise=0.0, seed=1, stance=0.0):
    """Angles, and torques that outside the swings are not those of a free leg."""
    tau = swing(seed).torque + noise
    rng = np.random.default_rng(99)
    tau = np.where(mask()[:, None], tau, tau + stance * (1.0 + rng.standard_normal(tau.shape)))
    return swing(seed).recording(v=None, a=None, tau=tau)


def segmented(**options):
    return dataclasses.replace(log(**options), mask=mask())


def apart(**options):
    """Each swing as a recording of its own."""
    edges = np.flatnonzero(np.diff(mask(), prepend=False, append=False))
    return [log(**options).slice(first, last) for first, last in zip(edges[::2], edges[1::2], strict=True)]


def disturbance(seed, time_constant):
    memory = np.exp(-1.0 / (time_constant * RATE)) if time_constant else 0.0
    return NOISE * coloured(np.random.default_rng(seed), swing().torque.shape, memory)


def error(recordings, **options):
    estimate = exoid.identify(swing().leg, recordings, TERMS, **options)
    return np.abs(estimate.values / swing().truth - 1.0).max()


@pytest.mark.parametrize("estimator", ["wls", pytest.param("ols", marks=pytest.mark.nightly), "huber"])
def test_segments_give_every_parameter_though_the_torque_between_them_is_that_of_a_stance(estimator):
    """Noise-free, 50 N·m of another force outside; the parallel filter does not carry it into the segments."""
    assert error(segmented(stance=50.0), estimator=estimator) < 1e-4
    assert error(log(stance=50.0), estimator=estimator) > 0.1, "without the mask it must show"


def test_torque_outside_the_segments_does_not_change_the_estimate_in_the_last_bit():
    some, other = (exoid.identify(swing().leg, segmented(stance=s), TERMS) for s in (0.0, 50.0))
    np.testing.assert_array_equal(some.values, other.values)
    np.testing.assert_array_equal(some.covariance, other.covariance)


def test_segments_lose_no_row_to_the_filter():
    rows = make_rows(TorqueModel(swing().leg, TERMS), segmented(), ZeroPhase())
    np.testing.assert_array_equal(rows.time, swing().time[mask()])


def test_a_dead_torque_channel_outside_the_segments_is_none():
    tau = np.where(mask()[:, None], swing().torque, 0.0)
    assert error(dataclasses.replace(segmented(), tau=tau)) < 1e-4
    with pytest.raises(ExoidError, match="is 0 N·m in 61% of samples"):
        error(dataclasses.replace(log(), tau=tau))


def test_validation_is_of_the_segments_only():
    estimate = exoid.identify(swing().leg, segmented(noise=disturbance(3, 0.0)), TERMS)
    inside = exoid.validate(estimate, segmented(noise=disturbance(4, 0.0), stance=50.0))
    assert len(inside.time) == mask().sum()
    assert (inside.rmse < 0.5 * NOISE).all()
    assert (exoid.validate(estimate, log(stance=50.0)).rmse > 10.0).all()


def test_swings_that_were_recorded_apart_identify_the_leg_too():
    """Of forty samples each, the ends take seven each; it was refused when they took 52 each."""
    assert error(apart()) < 1e-3
    assert 2 * ZeroPhase().edge(RATE) == 14


def test_a_swing_of_26_samples_gives_rows_and_shorter_ones_say_what_to_do():
    few = [each.slice(0, 26) for each in apart()]
    assert error(few) < 2e-3
    with pytest.raises(ExoidError, match=r"14 samples are too few.*of a longer log, pass all with Recording.segments"):
        error([each.slice(0, 14) for each in apart()])


@pytest.mark.parametrize("counted", [7, 0])
def test_segments_within_the_ends_of_a_log_or_none_at_all_are_refused(counted):
    with pytest.raises(ExoidError, match="no sample counts"):
        error(dataclasses.replace(log(), mask=np.arange(len(mask())) < counted))


def test_noise_that_outlasts_the_segments_is_warned_of_and_other_noise_is_not():
    def warned(recordings):
        estimate = exoid.identify(swing().leg, recordings, TERMS, check=False)
        return any("too short to tell how long the torque noise" in warning for warning in estimate.warnings)

    assert not warned(segmented(noise=disturbance(6, 0.0)))
    assert not warned(apart(noise=disturbance(6, 0.0)))
    assert not warned(log(noise=disturbance(6, 1.0)))
    assert warned(segmented(noise=disturbance(6, 1.0)))
    assert warned([each.slice(0, 26) for each in apart(noise=disturbance(6, 0.0))])


@pytest.mark.nightly
@pytest.mark.parametrize("time_constant", [0.0, 0.05])
@pytest.mark.parametrize("form", [segmented, apart])
def test_intervals_from_thirty_swings_contain_the_truth_as_often_as_they_say(form, time_constant):
    """Nominal 95 %; 40 replicates of 15 parameters."""
    inside = []
    for seed in range(40):
        recordings = form(noise=disturbance([seed, 7], time_constant), seed=seed)
        inside.append(holds(exoid.identify(swing().leg, recordings, TERMS, check=False), swing().truth))
    assert 0.92 < np.mean(inside) < 0.985
    assert np.mean(inside, axis=0).min() > 0.79
