"""Mistakes of real logs that look like a wearer are named."""

import dataclasses
import re

import numpy as np
import pytest
from worn import log, push, swing, unworn_estimate

import exoid
from exoid.control.wearer.action import Evidence, too_few_samples
from exoid.estimate.finding import Finding


@pytest.fixture(scope="module")
def estimate(leg):
    return unworn_estimate(leg)


@pytest.fixture(scope="module")
def unworn(leg):
    return log(swing(leg, 7))


def of_kind(found, kind):
    return [finding for finding in found.findings if finding.kind == kind]


def test_a_clean_log_has_no_finding(estimate, leg):
    motion = swing(leg, 1)
    assert exoid.interaction(estimate, log(motion, seed=5)).findings == ()
    assert exoid.interaction(estimate, log(motion, push(motion))).findings == ()


def test_a_sensor_whose_zero_is_off_is_no_wearer(estimate, unworn):
    found = exoid.interaction(estimate, dataclasses.replace(unworn, tau=unworn.tau + np.array([0.0, 1.5, 0.0])))
    (finding,) = of_kind(found, "constant-interaction")
    assert finding.joint == estimate.joint_names[1]
    assert finding.value == pytest.approx(-1.5, abs=0.1)
    assert not found.worn


@pytest.mark.parametrize(("scale", "words"), [(-1.0, "reads -1"), (1e3, "reads 1e+03")])
def test_torques_of_another_sign_or_unit(estimate, unworn, scale, words):
    found = exoid.interaction(estimate, dataclasses.replace(unworn, tau=scale * unworn.tau))
    named = of_kind(found, "sensor-like-interaction")
    assert [each.joint for each in named] == list(estimate.joint_names) == [each.joint for each in found.findings]
    assert words in named[0].message


def test_friction_that_changed_since_the_training(estimate, unworn):
    W, rubbing = estimate.model.regressor(*swing(estimate.leg, 7).motion), estimate.model.friction
    tau = unworn.tau + 1.5 * W[..., rubbing] @ estimate.values[rubbing]
    named = of_kind(exoid.interaction(estimate, dataclasses.replace(unworn, tau=tau)), "friction-like-interaction")
    assert float(re.search(r"is (\S+) times", named[0].message)[1]) == pytest.approx(2.5, rel=0.03)


@pytest.mark.parametrize(("scale", "late", "unit"), [(-1.0, 0, "times"), (1.2, 0, "times"), (1.0, 4, "ms late")])
def test_a_sensor_of_one_joint_that_misleads(estimate, unworn, scale, late, unit):
    tau = unworn.tau.copy()
    tau[:, 1] = scale * np.roll(tau[:, 1], late)
    found = exoid.interaction(estimate, dataclasses.replace(unworn, tau=tau))
    (finding,) = of_kind(found, "sensor-like-interaction")
    assert finding.joint == estimate.joint_names[1]
    (value,) = re.findall(rf"(\S+) {unit}", finding.message)
    assert float(value) == pytest.approx(10.0 * late if late else scale, rel=0.05)


def test_an_estimate_that_was_identified_with_a_wearer_inside(leg, unworn):
    limb = exoid.rig.limb_of(leg, 1.70, 65.0)
    inside = unworn_estimate(leg.with_parameters(leg.parameters + limb.parameters))
    found = exoid.interaction(inside, unworn)
    assert found.worn
    (finding,) = of_kind(found, "body-like-interaction")
    assert "less torque than the estimate says" in finding.message
    assert "unworn" in finding.remedy


def test_an_estimate_that_was_identified_while_a_wearer_pushed(leg, unworn):
    motion = swing(leg, 1)
    pushed = exoid.identify(leg, log(motion, push(motion, size=15.0)), check=False)
    assert of_kind(exoid.interaction(pushed, unworn), "rough-estimate")


def test_an_estimate_with_errors_cannot_tell_that_nothing_acts(estimate, unworn):
    wrong = Finding("torque-sign", estimate.joint_names[0], -1.0, "1", "error", "the other sign fits", "negate it")
    doubtful = dataclasses.replace(estimate, findings=(wrong,))
    found = exoid.interaction(doubtful, unworn)
    assert found.worn is None
    assert found.to_json()["worn"] is None
    assert "before it can be told" in str(found)
    (finding,) = of_kind(found, "rough-estimate")
    assert finding.severity == "error"
    assert "torque-sign" in finding.message
    pushed = dataclasses.replace(unworn, tau=unworn.tau - 5.0 * np.sin(3.0 * unworn.time)[:, None])
    assert exoid.interaction(doubtful, pushed).worn
    stuck = dataclasses.replace(unworn, tau=np.where(unworn.time[:, None] > 15.0, unworn.tau[1500], unworn.tau))
    assert exoid.interaction(estimate, stuck).worn is None  # the log has an error
    fast = dataclasses.replace(unworn, v=1.5 * np.gradient(unworn.q, unworn.time, axis=0))
    assert {one.kind for one in exoid.interaction(estimate, fast).findings} == {"velocity-scale"}
    with pytest.warns(UserWarning, match=f"errors.*torque-sign {estimate.joint_names[0]}"):
        exoid.control.gravity_support(doubtful)


def test_a_torque_outside_the_band_that_is_not_significant_is_neither_worn_nor_not_worn(estimate, unworn):
    estimate = dataclasses.replace(estimate, covariance=1e3 * estimate.covariance)
    least = exoid.interaction(estimate, unworn).actions[1].least
    push = np.array([0.0, 0.9 * np.sqrt(2.0) * least, 0.0]) * np.sin(3.0 * unworn.time)[:, None]
    found = exoid.interaction(estimate, dataclasses.replace(unworn, tau=unworn.tau - push))
    assert found.unclear == estimate.joint_names[1:2]
    assert found.worn is None is found.to_json()["worn"]
    assert "below the least" in str(found)


def test_another_leg(leg, estimate):
    found = exoid.interaction(estimate, log(swing(leg.with_parameters(1.3 * leg.parameters), 7)))
    (finding,) = of_kind(found, "body-like-interaction")
    assert finding.value > 0.9
    assert "more torque" in finding.message


def test_a_short_log_is_said_to_be_short(estimate, unworn):
    found = exoid.interaction(estimate, unworn.between(unworn.time[0], unworn.time[0] + 1.0))
    assert of_kind(found, "short-recording")


def test_a_joint_whose_friction_was_not_trained_is_not_tested(leg, unworn):
    training = log(swing(leg, 1))
    tau = training.tau.copy()
    tau[:, 2] = np.nan
    estimate = exoid.identify(leg, dataclasses.replace(training, tau=tau))
    found = exoid.interaction(estimate, unworn)
    assert np.isnan(found.actions[2].p_value)
    assert "not tested" in str(found)
    assert not found.worn
    assert of_kind(found, "unmeasured-torque")
    some = Evidence(*np.ones((4, 3)), effective=np.array([12.0, 15.0, 9.0]), trained=np.ones(3))
    (short,) = too_few_samples(estimate, some._replace(power=np.array([1.0, 1.0, np.nan])))
    assert (short.joint, short.value) == (estimate.joint_names[0], 12.0)
