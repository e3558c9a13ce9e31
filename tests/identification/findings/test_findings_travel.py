"""Findings are part of an estimate: its classes, text, file, and validation."""

import dataclasses
import json

import numpy as np
import pytest
from logs import clean, of_kind, with_column
from made_estimates import from_file
from swings import late

import exoid
from exoid.estimate.finding import Finding, ordered
from exoid.tools.json_values import json_value, records


@pytest.fixture(scope="module")
def late_estimate():
    leg, log = clean()
    return exoid.identify(leg, late(log, 0.02, range(3)))


def test_a_doubtful_parameter_is_at_best_weakly_determined(late_estimate):
    doubtful = of_kind(late_estimate.findings, "torque-delay").parameters
    assert "J3" in doubtful
    assert late_estimate.doubtful >= set(doubtful)
    assert all(late_estimate[name].identifiability != "well" for name in doubtful)
    leg, log = clean()
    assert set(exoid.identify(leg, log).identifiability) == {"well"}


def test_checks_do_not_change_the_values():
    leg, log = clean()
    np.testing.assert_array_equal(exoid.identify(leg, log).values, exoid.identify(leg, log, check=False).values)


def test_findings_stand_in_the_text_and_the_file(late_estimate, tmp_path):
    assert "torque-delay" in str(late_estimate)
    loaded = from_file(late_estimate, tmp_path)
    assert loaded.findings == late_estimate.findings
    np.testing.assert_array_equal(loaded.evidence.ranges.speed, late_estimate.evidence.ranges.speed)
    assert loaded.identifiability == late_estimate.identifiability


def test_findings_of_groups_keep_their_group():
    leg, log = clean()
    both = exoid.identify(leg, {"good": log, "bad": late(log, 0.02, range(3))}, own="c0")
    assert "c0_hip[bad]" in both.names
    assert of_kind(both["bad"].findings, "torque-delay")
    assert both.findings == (*both["good"].findings, *both["bad"].findings)


def test_validation_shifts_torques_by_the_delay_of_the_training(tmp_path):
    leg, log = clean()
    bad = late(log, 0.02, range(3))
    mended = exoid.identify(leg, bad, delay="auto")
    assert mended.torque_delays == pytest.approx([0.02] * 3, abs=0.001)
    loaded = from_file(mended, tmp_path)
    np.testing.assert_array_equal(loaded.torque_delays, mended.torque_delays)
    validation = exoid.validate(loaded, bad)
    right = exoid.validate(exoid.identify(leg, log), log).nrmse
    assert (validation.nrmse < 1.1 * right).all()
    assert (exoid.validate(exoid.identify(leg, bad), bad).nrmse > 1.2 * right).any()
    shifts = [finding for finding in validation.findings if finding.kind == "torque-delay"]
    assert [finding.value for finding in shifts] == mended.torque_delays.tolist()
    assert validation.verdict == "predicts"
    assert str(validation).rstrip().endswith("verdict: predicts")
    assert exoid.validate(exoid.identify(leg, log), log).findings == ()


def test_a_faster_motion_than_that_of_the_training_is_an_extrapolation():
    leg, log = clean()
    estimate = exoid.identify(leg, log)
    assert exoid.validate(estimate, log).findings == ()
    found = exoid.validate(estimate, dataclasses.replace(log, time=log.time / 1.5)).findings
    assert {finding.kind for finding in found} >= {"extrapolation"}
    speeds = [f.value for f in found if f.kind == "extrapolation" and "speed" in f.message]
    assert speeds == pytest.approx([1.5] * 3, rel=0.1)


def test_findings_survive_json_and_are_ordered():
    info = Finding("angle-offset", "knee", 2.0, "1", "info", "m", "r")
    error = Finding("dropout", "hip", 0.1, "1", "error", "m", "r", (0.0, 0.2), ("X1",), "a.csv")
    assert records(Finding, json.loads(json.dumps(json_value((info, error))))) == (info, error)
    assert ordered((info, error)) == (error, info)
    assert str(error) == "error: dropout at hip in a.csv: m; r"


@pytest.mark.parametrize(("quantity", "all_joints"), [("tau", False), ("q", True)])
def test_a_frozen_channel_leaves_no_parameter_well_that_it_acts_on(quantity, all_joints):
    leg, log = clean()
    fastest = int(np.abs(np.diff(log.q[500:-500, 1])).argmax()) + 500

    def freeze(x):
        x[fastest : fastest + 100] = x[fastest]
        return x

    estimate = exoid.identify(leg, with_column(log, quantity, 1, freeze))
    stuck = of_kind(estimate.findings, "stuck-channel")
    acting = np.array(estimate.names)[estimate.model.acting[1]]
    assert {*acting} <= {*stuck.parameters}
    assert ({*estimate.names} == {*stuck.parameters}) == all_joints
    assert "well" not in {estimate[name].identifiability for name in stuck.parameters}
