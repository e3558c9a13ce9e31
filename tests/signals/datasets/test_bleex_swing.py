"""The example that comes along: made by its script, and good enough to find the published parameters in."""

import dataclasses

import make_bleex_swing as script
import numpy as np
import pytest

import exoid
from exoid import published

THREE_STD = 0.9973
"""Part of a normal distribution within three standard deviations."""


@pytest.mark.parametrize(("part", "seed"), [("train", 1), ("test", 2)])
def test_the_files_begin_as_the_script_makes_them(data, part, seed, monkeypatch):
    """The first second and a half, without the noise, which depends on how many samples are drawn."""
    monkeypatch.setattr(script, "TORQUE_NOISE", np.zeros(3))
    again, recording = script.record(seed, 1.5), getattr(data, part)
    np.testing.assert_allclose(again.q, recording.q[: len(again)], atol=2.0 * script.ENCODER_COUNT)
    error = again.tau - recording.tau[: len(again)]
    np.testing.assert_allclose(error.std(axis=0), [0.3, 0.2, 0.1], rtol=0.2)
    assert (np.abs(error.mean(axis=0)) < 4.0 * np.array([0.3, 0.2, 0.1]) / np.sqrt(len(again))).all()


def test_intervals_of_three_standard_deviations_contain_the_published_parameters(estimate):
    """Tables II and III of the left leg, though the leg that was passed has those of Table V."""
    intervals = dict(zip(estimate.names, estimate.interval(THREE_STD), strict=True))
    for name, value in published.bleex_parameters("left").items():
        lower, upper = intervals[name]
        assert lower < value < upper, name


def test_the_other_swing_is_predicted_and_the_cad_model_must_do_worse(estimate, data):
    """The ankle's torque is hardly larger than its noise. With the friction, the CAD inertias err several times."""
    values = estimate.values.copy()
    values[:9] = data.leg.parameters
    cad = exoid.validate(dataclasses.replace(estimate, values=values), data.test)
    found = exoid.validate(estimate, data.test)
    assert (found.nrmse <= [0.02, 0.02, 0.07]).all()
    assert (cad.nrmse[:2] > 3.0 * found.nrmse[:2]).all()
