"""Validation: figures over all samples and of each recording, cut-off, share inside the band, findings and verdict."""

from dataclasses import replace

import numpy as np
import pytest
from made_estimates import from_file

import exoid


def kinds(validation):
    return {(finding.kind, finding.joint) for finding in validation.findings}


def test_several_recordings_are_judged_over_all_samples_and_one_by_one(data, estimate):
    logs = [data.test, data.train]
    alone = [exoid.validate(estimate, log) for log in logs]
    both = exoid.validate(estimate, logs)
    residual = np.concatenate([one.measured - one.predicted for one in alone])
    measured = np.concatenate([one.measured for one in alone])
    np.testing.assert_allclose(both.rmse, np.sqrt((residual**2).mean(axis=0)), rtol=1e-12)
    np.testing.assert_allclose(both.nrmse, both.rmse / measured.std(axis=0), rtol=1e-12)
    total = ((measured - measured.mean(axis=0)) ** 2).sum(axis=0)
    np.testing.assert_allclose(both.r2, 1.0 - (residual**2).sum(axis=0) / total, rtol=1e-12)
    inside = np.concatenate([np.abs(one.residual) <= one.half_width for one in alone])
    np.testing.assert_allclose(both.coverage, inside.mean(axis=0), rtol=1e-12)
    for part, one in zip(both.parts, alone, strict=True):
        np.testing.assert_array_equal(part.rmse, one.rmse)
        assert part.source in str(both)
    data = both.to_json()
    assert data["samples"] == sum(part["samples"] for part in data["recordings"])
    assert [part["rmse"] for part in data["recordings"]] == [one.rmse.tolist() for one in alone]


def test_a_given_cut_off_puts_estimates_with_other_filters_on_equal_terms(data, estimate):
    """The measured torque is the same to the last bit; behind their own filters it is not."""
    slow = exoid.identify(data.leg, data.train, cutoff=3.0)
    one, other = (exoid.validate(each, data.test, cutoff=6.0) for each in (estimate, slow))
    np.testing.assert_array_equal(one.measured, other.measured)
    assert len(exoid.validate(estimate, data.test).time) != len(exoid.validate(slow, data.test).time)


@pytest.mark.parametrize("cutoff", [None, 4.0])
def test_a_good_estimate_predicts_and_its_band_contains_95_percent(data, estimate, cutoff):
    found = exoid.validate(estimate, data.test, cutoff=cutoff)
    assert found.verdict == "predicts"
    assert not found.findings
    assert ((found.coverage > 0.9) & (found.coverage < 0.99)).all()
    assert str(found).rstrip().endswith("verdict: predicts")
    assert found.to_json()["verdict"] == "predicts"
    assert found.to_json()["coverage_95"] == found.coverage.tolist()
    assert f"{100.0 * found.coverage[0]:.1f} %" in found._repr_html_()


def test_a_torque_of_the_other_sign_is_not_predicted(data, estimate):
    found = exoid.validate(estimate, replace(data.test, tau=-data.test.tau))
    assert found.verdict == "does not predict"
    assert (found.nrmse > 1.0).all()
    assert found.findings[0].severity == "error"
    assert found.to_json()["findings"][0]["kind"] == "large-residual"
    assert "verdict: does not predict (large-residual at left_hip, left_knee, left_ankle" in str(found)


def test_the_worst_recording_decides(data, estimate):
    wrong = replace(data.test, tau=-data.test.tau)
    assert exoid.validate(estimate, [data.test, data.train]).verdict == "predicts"
    assert exoid.validate(estimate, [data.test, wrong]).verdict == "does not predict"


def test_a_leg_that_has_become_heavier_is_predicted_poorly(data, estimate):
    """NRMSE stays below 0.5, but the residual is far larger than that of the training, and leaves the band."""
    found = exoid.validate(estimate, replace(data.test, tau=1.2 * data.test.tau))
    assert (found.nrmse < 0.35).all()
    assert found.verdict == "predicts poorly"
    assert {("large-residual", "left_hip"), ("narrow-band", "left_hip"), ("narrow-band", "left_knee")} <= kinds(found)
    assert not any(kind == "torque-delay" for kind, _ in kinds(found))


def test_a_late_torque_is_named_with_its_delay(data, estimate):
    samples = 3
    tau = np.vstack([np.repeat(data.test.tau[:1], samples, axis=0), data.test.tau[:-samples]])
    found = exoid.validate(estimate, replace(data.test, tau=tau))
    delays = {finding.joint: finding.value for finding in found.findings if finding.kind == "torque-delay"}
    assert found.verdict == "predicts poorly"
    for joint in data.leg.joint_names:
        assert delays[joint] == pytest.approx(samples / data.test.sample_rate, rel=0.1)


def test_a_late_velocity_is_named_and_not_used(data, estimate):
    q, time = data.test.q, data.test.time
    shifted = [np.interp(time - 0.02, time, x) for x in np.gradient(q, time, axis=0).T]
    good, late = (replace(data.test, v=v, a=None) for v in (None, np.column_stack(shifted)))
    found, plain = exoid.validate(estimate, late), exoid.validate(estimate, good)
    np.testing.assert_array_equal(found.predicted, plain.predicted)
    assert {f.joint for f in found.findings if f.kind == "velocity-delay"} == {*late.joint_names}
    assert found.verdict == plain.verdict
    assert "velocity-delay" not in {kind for kind, _ in kinds(plain)}


def test_few_effective_samples_do_not_make_a_band_narrow(data, estimate):
    """Half a second of one residual says little, however often it is sampled."""
    few = tuple(replace(one, effective_samples=2.0) for one in estimate.noise)
    rare = replace(estimate, evidence=replace(estimate.evidence, noise=few))
    late = replace(data.test, tau=1.2 * data.test.tau)
    assert any(kind == "narrow-band" for kind, _ in kinds(exoid.validate(estimate, late)))
    assert not any(kind == "narrow-band" for kind, _ in kinds(exoid.validate(rare, late)))


def test_the_fit_of_an_estimate_is_its_validation_on_the_recording_of_the_fit(data, estimate, tmp_path):
    again = exoid.validate(estimate, data.train)
    np.testing.assert_allclose(estimate.nrmse, again.nrmse, rtol=0.01)
    np.testing.assert_allclose(estimate.r2, again.r2, rtol=1e-4)
    np.testing.assert_array_equal(from_file(estimate, tmp_path).nrmse, estimate.nrmse)


def pushed_by(leg, log, size):
    """The log with a force on the foot that is measured, and the torque that it takes off the joints."""
    force = size * np.outer(np.sin(log.time), [4.0, 0.0, 9.0])
    push = np.einsum("ncj,nc->nj", leg.frame_jacobian(log.q, "left_foot"), np.hstack([force, 0.0 * force]))
    return replace(log, tau=log.tau - push, wrenches={"left_foot": exoid.Wrench(force, 0.0 * force)}), push


def test_a_measured_force_belongs_to_the_prediction(data, estimate):
    """The measured torque stays that of the log, whatever pushes on the foot; the residual is that without the push."""
    test = data.test
    pushed, push = pushed_by(data.leg, test, 10.0)
    plain, found = exoid.validate(estimate, test), exoid.validate(estimate, pushed)
    np.testing.assert_allclose(found.residual, plain.residual, atol=2e-3)  # the angles are filtered, too
    # Friction of another form may grow with the load, of which the push is a part; the rest of the band is the same
    certain = replace(estimate, model_error=None)
    bands = [exoid.validate(certain, each).half_width for each in (test, pushed)]
    np.testing.assert_allclose(*bands, rtol=1e-3)
    rows = np.searchsorted(test.time, found.time - 1e-6)
    apart = (found.measured - plain.measured + push[rows])[50:-50]  # at the ends, a filter is one-sided
    assert np.abs(apart).max() < 0.02 * np.abs(push).max()
    assert np.ptp(push[:, :2], axis=0).min() > 10.0


def test_a_leg_is_judged_on_what_measured_forces_leave(data, estimate):
    """A force that carries nearly all of the torque hides a leg that is wrong; the error over the rest shows it."""
    wrong = replace(data.test, tau=0.3 * data.test.tau)
    pushed, _ = pushed_by(data.leg, wrong, 100.0)
    plain, found = exoid.validate(estimate, wrong), exoid.validate(estimate, pushed)
    np.testing.assert_allclose(plain.leg_nrmse, plain.nrmse, rtol=1e-12)
    np.testing.assert_allclose(found.leg_nrmse, plain.nrmse, rtol=0.02)
    assert (found.nrmse[:2] < 0.5).all()
    assert (found.leg_nrmse > 1.0).all()
    assert plain.verdict == found.verdict == "does not predict"
    assert f"(leg {found.leg_nrmse[0]:.4f})" in str(found)
    assert "(leg" not in str(plain)
    assert found.to_json()["leg_nrmse"] == found.leg_nrmse.tolist()


def test_a_band_as_wide_as_the_torque_is_no_prediction(data, estimate):
    """Parameters that hardly anything determines: every torque is inside, and nothing is said."""
    found = exoid.validate(replace(estimate, covariance=2000.0 * estimate.covariance), data.test)
    assert (found.coverage == 1.0).any()
    assert {kind for kind, _ in kinds(found)} == {"wide-band"}
    assert found.verdict == "predicts poorly"
    assert "verdict: predicts poorly (wide-band at" in str(found)
    assert not exoid.validate(estimate, data.test).findings
