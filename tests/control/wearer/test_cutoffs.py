"""A cut-off below that of the estimate is chosen where noise is larger than the torque, and keeps the equation."""

import numpy as np
import pytest
from worn import log, push, swing, unworn_estimate

import exoid
from exoid import ExoidError
from exoid.control.wearer.cutoffs import choose_cutoffs, joined, with_cutoff
from exoid.control.wearer.evaluation import Evaluation
from exoid.signals import FiniteDifference, ZeroPhase, zero_phase

RATE, OWN = 100.0, ZeroPhase(cutoff=8.0)


def evaluation(torque, noise, time=None):
    """Torque and noise of one joint behind the estimate's filter."""
    time = np.arange(len(torque)) / RATE if time is None else time
    y = torque[:, None]
    return Evaluation(time, y, y, np.full_like(y, noise**2), np.array([noise**2]))


def slow_torque(seed, noise, seconds=60.0, frequency=0.5):
    """A sine beside white noise, behind 8 Hz: reading, truth, and standard deviation of the noise."""
    time = np.arange(0.0, seconds, 1.0 / RATE)
    truth = np.sin(2.0 * np.pi * frequency * time)
    white = noise * np.random.default_rng(seed).standard_normal(len(time))
    left = noise * np.sqrt(OWN.independent_fraction(RATE))
    return zero_phase(truth + white, RATE, 8.0), truth, left


@pytest.mark.parametrize("frequency", [0.5, 2.0])
def test_the_chosen_cutoff_errs_no_more_than_any_other_by_a_tenth(frequency):
    inner = slice(300, -300)
    for seed in range(5):
        y, truth, left = slow_torque(seed, 0.5, frequency=frequency)
        chosen = choose_cutoffs(evaluation(y, left), OWN, RATE)
        found = chosen.cutoff[0]

        def error(cutoff, y=y, truth=truth):
            return np.sqrt(np.mean((zero_phase(y, RATE, cutoff) - truth)[inner] ** 2))

        assert frequency < found < 8.0
        assert error(found) < 0.75 * np.sqrt(np.mean((y - truth)[inner] ** 2))
        assert error(found) < 1.1 * min(error(cutoff) for cutoff in np.geomspace(0.5, 8.0, 30))
        assert chosen.lost[0] < 0.1


def test_without_noise_the_cutoff_stays_that_of_the_estimate():
    torque = zero_phase(np.random.default_rng(0).standard_normal(4000), RATE, 8.0)
    assert choose_cutoffs(evaluation(torque, 1e-3), OWN, RATE).cutoff[0] == OWN.cutoff


def test_a_gap_is_no_torque_and_a_short_log_keeps_the_cutoff():
    y, _, left = slow_torque(3, 0.5)
    time = np.arange(len(y)) / RATE
    there = (time < 25.0) | (time > 32.0)
    whole = choose_cutoffs(evaluation(y, left), OWN, RATE).cutoff[0]
    parts = choose_cutoffs(evaluation(y[there], left, time[there]), OWN, RATE).cutoff[0]
    assert abs(np.log(parts / whole)) < 0.3
    assert choose_cutoffs(evaluation(y[:40], left), OWN, RATE).cutoff[0] == OWN.cutoff


def test_joints_are_joined_at_the_samples_that_all_have():
    time = np.arange(100) / RATE
    y = np.column_stack([time, 2.0 * time])
    whole = Evaluation(time, y, y, y, np.ones(2))
    fewer = Evaluation(time[10:-20], y[10:-20], y[10:-20], y[10:-20], 3.0 * np.ones(2))
    both = joined([whole, fewer], RATE)
    assert np.array_equal(both.time, time[10:-20])
    assert np.array_equal(both.torque, y[10:-20])
    assert np.array_equal(both.noise, [1.0, 3.0])


def behind(recording, cutoffs, torque, time):
    whole = np.column_stack([zero_phase(x, RATE, c) for c, x in zip(cutoffs, torque.T, strict=True)])
    return whole[np.searchsorted(recording.time, time - 0.5 / RATE)]


def nrmse(found, truth):
    return np.sqrt(((found - truth) ** 2).mean(axis=0)) / truth.std(axis=0)


@pytest.fixture(scope="module", params=["bleex", "cuhk"])
def estimate(request):
    return unworn_estimate(exoid.load_leg(request.param))


def test_both_sides_pass_the_chosen_filter_and_the_band_holds_the_truth(estimate):
    inside = []
    for seed in (20, 21, 22):
        motion = swing(estimate.model.leg, seed)
        truth = 0.3 * push(motion, seed)
        recording = log(motion, truth, seed=seed)
        found, whole = (exoid.interaction(estimate, recording, cutoff=how) for how in ("auto", None))
        assert (found.cutoffs < whole.cutoffs).all()
        alike, full = (behind(recording, x, truth, found.time) for x in (found.cutoffs, whole.cutoffs))
        common = np.isin(np.round(whole.time, 6), np.round(found.time, 6))
        assert (nrmse(found.torque, alike) < nrmse(whole.torque[common], full)).all()
        assert (nrmse(found.torque, full) < 1.02 * nrmse(whole.torque[common], full)).all()
        inside.append(np.abs(found.torque - alike) <= found.band)
    assert 0.92 < np.mean(np.concatenate(inside)) < 0.98
    assert found.worn
    assert "least expected error" in str(found)
    assert {each.value for each in found.findings if each.kind == "lower-cutoff"} == set(found.cutoffs.tolist())
    for name, cutoff in zip(found.joint_names, found.cutoffs, strict=True):
        assert found.to_json()["joints"][name]["cutoff"] == cutoff


def test_an_unworn_leg_is_not_called_worn_behind_a_lower_cutoff(estimate):
    for seed in (30, 31):
        recording = log(swing(estimate.model.leg, seed), seed=seed)
        assert not exoid.interaction(estimate, recording, cutoff="auto").worn


def test_angles_pass_the_filter_of_the_estimate():
    lower = with_cutoff(OWN, 2.0, RATE)
    assert (lower.cutoff, lower.kinematics_cutoff_at(RATE)) == (2.0, OWN.kinematics_cutoff_at(RATE))


def test_what_cannot_be_chosen_is_refused(estimate):
    recording = log(swing(estimate.model.leg, 30), seed=30)
    with pytest.raises(ExoidError, match="'best'"):
        exoid.interaction(estimate, recording, cutoff="best")
    with pytest.raises(ExoidError, match="pass one of them"):
        exoid.interaction(estimate, recording, cutoff="auto", preparation=FiniteDifference())
