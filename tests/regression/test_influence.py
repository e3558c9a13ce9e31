"""What each recording does to the estimate is what leaving it out does."""

from __future__ import annotations

import numpy as np
import pytest
from swings import TERMS, Swing
from unchecked import identify

from exoid import Estimate, Stiffness
from exoid.identification.group_rows import Group
from exoid.identification.problem import Problem
from exoid.signals import FiniteDifference, Poses
from exoid.torques import TorqueModel

PLAIN = FiniteDifference()


def logs(leg, spoilt=0.0):
    """Three recordings with noise; in the last one the knee's sensor reads too much."""
    rng = np.random.default_rng(0)
    recordings = [Swing(leg, 100.0, 15.0, seed).with_noise(rng, 0.3) for seed in (1, 2, 3)]
    recordings[2] = Swing(leg, 100.0, 15.0, 3).recording(tau=recordings[2].tau * [1.0, 1.0 + spoilt, 1.0])
    return recordings


def test_one_recording_has_no_influence_to_speak_of(leg):
    assert identify(leg, logs(leg)[0], TERMS).influence is None


@pytest.mark.parametrize("estimator", ["ols", "wls", "huber"])
def test_the_change_is_that_of_an_identification_without_the_recording(leg, estimator):
    """To some parts, as weights stay those of the whole."""
    recordings = logs(leg, 0.05)
    whole = identify(leg, recordings, TERMS, estimator, preparation=PLAIN)
    for k in range(3):
        without = identify(leg, recordings[:k] + recordings[k + 1 :], TERMS, estimator, preparation=PLAIN)
        expected = (without.values - whole.values) / whole.std
        tolerance = {"ols": 1e-6, "wls": 0.25, "huber": 0.5}[estimator]
        np.testing.assert_allclose(
            whole.influence.change[k], expected, atol=tolerance * max(1.0, np.abs(expected).max())
        )


def test_shares_add_up_to_one_and_a_longer_recording_has_more(leg):
    recordings = [Swing(leg, 100.0, seconds).with_noise(np.random.default_rng(0), 0.3) for seconds in (10.0, 40.0)]
    estimate = identify(leg, recordings, TERMS, preparation=PLAIN)
    np.testing.assert_allclose(estimate.influence.share.sum(axis=0), 1.0, atol=1e-9)
    assert (estimate.influence.share[1] > 0.5).all()


def test_shares_stay_between_nought_and_one_where_parameters_are_hardly_told_apart(leg):
    """The diagonal of A⁻¹ A_r does not: stiffness at the hip of an upright leg looks like gravity."""
    terms = (*TERMS, Stiffness(joints=("hip",)))
    recordings = [Swing(leg, 100.0, 15.0, seed).with_noise(np.random.default_rng(seed), 0.3) for seed in (1, 2, 3)]
    estimate = identify(leg, recordings, terms, preparation=PLAIN)
    assert estimate.condition_number > 100.0
    share = estimate.influence.share
    np.testing.assert_allclose(share.sum(axis=0), 1.0, atol=1e-6)
    assert (share >= 0.0).all()
    assert (share <= 1.0).all()


def test_a_share_is_the_part_of_the_variance_that_a_recordings_noise_makes(leg):
    """Of replicates in which the torque of one recording alone has noise; 300 of them, so give or take a tenth."""
    swings = [Swing(leg, 50.0, 8.0, seed) for seed in (1, 2)]
    rng = np.random.default_rng(0)
    share = identify(
        leg, [swing.with_noise(rng, 0.3) for swing in swings], TERMS, "ols", preparation=PLAIN
    ).influence.share
    problem = Problem((Group("", TorqueModel(leg, TERMS), [swing.recording() for swing in swings], PLAIN),))
    W = [np.concatenate(block.rows.W) for block in problem.blocks()]
    whole = np.linalg.pinv(np.vstack(W))
    parts = np.split(whole, [len(W[0])], axis=1)
    scatter = [(part @ rng.normal(size=(part.shape[1], 300))).var(axis=1) for part in parts]
    np.testing.assert_allclose(share, scatter / np.sum(scatter, axis=0), atol=0.1)


@pytest.mark.nightly
def test_changes_scatter_as_expected(leg):
    """Of recordings of one leg, 80 times."""
    rng = np.random.default_rng(1)
    swings = [Swing(leg, 50.0, seconds, seed) for seed, seconds in ((1, 6.0), (2, 12.0))]
    found = [identify(leg, [s.with_noise(rng, 0.3) for s in swings], TERMS, preparation=PLAIN) for _ in range(80)]
    scatter = np.std([e.influence.change for e in found], axis=0)
    expected = np.mean([e.influence.expected for e in found], axis=0)
    assert (np.abs(np.log(scatter / expected)) < 0.35).all()
    assert abs(np.log(scatter / expected).mean()) < 0.1


def test_a_prior_has_a_share_too(leg):
    estimate = identify(leg, logs(leg), TERMS, preparation=PLAIN, prior={"J3": (0.06, 0.001)})
    share = estimate.influence.share.sum(axis=0)[estimate.names.index("J3")]
    assert 0.0 < share < 0.5


def test_a_recording_that_moves_the_estimate_is_named(leg):
    fine, spoilt = (identify(leg, logs(leg, s), TERMS, preparation=PLAIN) for s in (0.0, 0.3))
    assert "alone moves" not in str(fine)
    assert "alone moves" in str(spoilt)
    assert np.abs(spoilt.influence.change[2]).max() > 2.0


def test_a_recording_without_which_nothing_is_left_is_named(leg, tmp_path):
    """Poses cannot tell an inertia: all comes from the recording."""
    rng = np.random.default_rng(0)
    q = rng.uniform(-1.0, 1.0, (60, 3))
    poses = Poses(q, leg.inverse_dynamics(q, 0 * q, 0 * q) + rng.normal(scale=0.1, size=q.shape), leg.joint_names)
    estimate = identify(leg, [logs(leg)[0], poses], TERMS, preparation=PLAIN)
    assert np.isinf(estimate.influence.change[0]).all()
    assert np.isfinite(estimate.influence.change[1]).all()
    assert "not to be identified without array" in str(estimate)
    estimate.save(tmp_path / "e.json")
    assert np.isinf(Estimate.load(tmp_path / "e.json").influence.change[0]).all()
