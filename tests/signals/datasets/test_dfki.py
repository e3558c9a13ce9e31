"""A real machine: the DFKI double pendulum, 48 s to identify from and 25 s that the estimate has not seen."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import exoid
from exoid.signals import ZeroPhase

PUBLISHED = {
    "1.0": {
        "m": (0.608, 0.630),
        "l": (0.3, 0.2),
        "r": (0.275, 0.166),
        "I": (0.05472, 0.02522),
        "Ir": 0.000060719,
        "b": (0.081, 0.0),
        "cf": (0.093, 0.186),
    },
    "2.0": {
        "m": (0.5593806151425046, 0.6043459469186889),
        "l": (0.3, 0.2),
        "r": (0.3, 0.18377686083653508),
        "I": (0.053470810264216295, 0.02392374528789766),
        "Ir": 7.659297952841183e-05,
        "b": (0.001, 0.001),
        "cf": (0.093, 0.078),
    },
}
"""The models that the recording's authors identified, as published beside it; gear ratio 6."""

PUBLISHED_NRMSE = {"1.0": (0.091, 0.279), "2.0": (0.099, 0.177)}
"""Shoulder and elbow, of their models on the test part."""


@pytest.fixture(scope="module")
def data():
    return exoid.datasets.dfki_double_pendulum()


@pytest.fixture(scope="module")
def estimate(data):
    return exoid.identify(data.leg, data.train)


def shown_in_readme(text):
    """Whether the README shows a figure; true beside an installed package, where there is none."""
    readme = Path(__file__).resolve().parents[3] / "README.md"
    return not readme.is_file() or text in readme.read_text(encoding="utf-8")


def published_nrmse(data, model):
    """NRMSE of a published model on the test part, both torques through the default filter."""
    p, preparation, rate = PUBLISHED[model], ZeroPhase(), data.test.sample_rate
    (m1, m2), (l1, _), (r1, r2), (I1, I2) = p["m"], p["l"], p["r"], p["I"]
    parameters = np.array([m1 * r1 + m2 * l1, 0.0, I1 + m2 * l1**2 + I2, m2 * r2, 0.0, I2])
    assert data.leg.parameter_names == ("X1", "Y1", "J1", "X2", "Y2", "J2")
    q, v, a, valid = preparation.kinematics(data.test)
    torque = data.leg.regressor(q, v, a) @ parameters + 36.0 * p["Ir"] * a
    torque += np.array(p["b"]) * v + np.array(p["cf"]) * np.arctan(100.0 * v)
    predicted, measured = (preparation.filter(x, rate)[valid] for x in (torque, data.test.tau))
    return np.sqrt(((measured - predicted) ** 2).mean(axis=0)) / measured.std(axis=0)


@pytest.mark.real_data("dfki_double_pendulum")
def test_the_estimate_predicts_the_unseen_part(data, estimate):
    """As the README says; 0.48 s from the ends, as far as they were left out before, 0.0650 and 0.1435."""
    found = exoid.validate(estimate, data.test)
    shoulder, elbow = found.nrmse
    assert shoulder <= 0.0667
    assert elbow <= 0.1478
    assert shown_in_readme(f"The NRMSE is {shoulder:.4f} at the shoulder and {elbow:.4f} at the elbow")
    assert shown_in_readme(f"{found.coverage.mean():.1%} of the samples lie in".replace("%", " %"))
    inner = (found.time >= data.test.time[0] + 0.48) & (found.time <= data.test.time[-1] - 0.48)
    error = np.sqrt((found.residual[inner] ** 2).mean(axis=0)) / found.measured[inner].std(axis=0)
    assert error[0] <= 0.0653
    assert error[1] <= 0.1442


@pytest.mark.real_data("dfki_double_pendulum")
def test_the_estimate_predicts_with_a_band_that_holds(data, estimate):
    """Share inside the 95 % band 0.950 and 0.950; by parameters and noise alone 0.929 and 0.891.

    The band is 0.96 and 1.07 times as wide. The log begins at rest, where presliding begins undeflected.
    """
    found = exoid.validate(estimate, data.test)
    bare = exoid.validate(dataclasses.replace(estimate, model_error=None), data.test)
    assert found.verdict == "predicts"
    assert found.coverage[0] > 0.94
    assert found.coverage[1] > 0.94
    assert (found.coverage > bare.coverage).all()
    assert (found.half_width.mean(axis=0) < 1.08 * bare.half_width.mean(axis=0)).all()


@pytest.mark.real_data("dfki_double_pendulum")
def test_an_estimate_of_slow_motion_has_a_band_that_holds_in_faster_motion(data):
    slow = exoid.identify(data.leg, data.train.between(0.0, 21.0))
    for start, stop in ((21.0, 33.0), (36.0, 48.0)):
        found = exoid.validate(slow, data.train.between(start, stop))
        kinds = {(f.kind, f.joint) for f in found.findings}
        assert kinds - {("large-residual", "shoulder")} == {("extrapolation", j) for j in data.leg.joint_names}
        assert (found.coverage > 0.95).all()
        assert found.verdict == ("predicts poorly" if ("large-residual", "shoulder") in kinds else "predicts")


@pytest.mark.real_data("dfki_double_pendulum")
@pytest.mark.parametrize("model", PUBLISHED)
def test_the_estimate_is_better_than_the_published_models(data, estimate, model):
    """Their models under the same filter reach their published figures, and the estimate beats them."""
    theirs = published_nrmse(data, model)
    print(f"published model {model}:", theirs.round(3))
    assert shown_in_readme(" / ".join(f"{error:.3f}" for error in theirs))
    np.testing.assert_allclose(theirs, PUBLISHED_NRMSE[model], rtol=0.01)
    assert (exoid.validate(estimate, data.test).nrmse < theirs).all()


@pytest.mark.real_data("dfki_double_pendulum")
def test_the_estimate_is_a_leg_that_could_exist(estimate):
    """Masses, inertias and dry friction are positive, and near what the authors found by other means."""
    for name in ("X1", "J1", "X2", "J2", "Ia_elbow", "c0_shoulder", "c0_elbow"):
        low, _ = estimate.interval()[estimate.names.index(name)]
        assert low > 0.0, name
    p = PUBLISHED["1.0"]
    assert estimate.value("X1") == pytest.approx(p["m"][0] * p["r"][0] + p["m"][1] * p["l"][0], rel=0.15)
    assert estimate.value("X2") == pytest.approx(p["m"][1] * p["r"][1], rel=0.15)
