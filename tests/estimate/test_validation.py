"""Validation of one recording and of several: figures are those of all samples, and of each recording."""

import numpy as np
import pytest

import exoid
from exoid import ExoidError


@pytest.fixture(scope="module")
def swing():
    return exoid.datasets.bleex_swing()


@pytest.fixture(scope="module")
def estimate(swing):
    return exoid.identify(swing.leg, swing.train)


def test_several_recordings_are_judged_over_all_samples_and_one_by_one(swing, estimate):
    logs = [swing.test, swing.train]
    alone = [exoid.validate(estimate, log) for log in logs]
    both = exoid.validate(estimate, logs)
    residual = np.concatenate([one.residual for one in alone])
    measured = np.concatenate([one.measured for one in alone])
    np.testing.assert_allclose(both.rmse, np.sqrt((residual**2).mean(axis=0)), rtol=1e-12)
    np.testing.assert_allclose(both.nrmse, both.rmse / measured.std(axis=0), rtol=1e-12)
    for part, one in zip(both.parts, alone, strict=True):
        np.testing.assert_array_equal(part.rmse, one.rmse)
        assert part.source in str(both)
    data = both.to_json()
    assert data["samples"] == sum(part["samples"] for part in data["recordings"])
    assert [part["rmse"] for part in data["recordings"]] == [one.rmse.tolist() for one in alone]


def test_one_recording_in_a_list_is_that_recording(swing, estimate):
    one, listed = exoid.validate(estimate, swing.test), exoid.validate(estimate, [swing.test])
    assert str(one) == str(listed)
    assert not listed.parts
    assert "recordings" not in listed.to_json()


@pytest.mark.parametrize(("given", "match"), [([], "no recordings"), (["log.csv"], "'log.csv' is no recording")])
def test_what_is_no_recording_is_refused(estimate, given, match):
    with pytest.raises(ExoidError, match=match):
        exoid.validate(estimate, given)
