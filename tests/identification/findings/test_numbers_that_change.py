"""Numbers that change while data are recorded: an encoder that slips, a sensor that is set again, a payload."""

import dataclasses

import numpy as np
import one_joint
import pytest
from logs import clean, kinds, of_kind, with_column
from proving_ground.machine import draw
from swings import Swing, with_payloads

import exoid

CHANGES = {  # what is logged of the knee after the middle, and how the finding says so
    "an encoder slips": ("q", lambda x: x + 0.01, 0.01, "rad"),
    "a torque sensor is set again": ("tau", lambda x: x + 1.0, 1.0, "N·m"),
    "an amplifier changes its range": ("tau", lambda x: 1.05 * x, 0.05, "1"),
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_change_within_a_log_is_named_with_its_time_joint_and_size(what):
    leg, log = clean("cuhk")
    column, change, value, unit = CHANGES[what]
    later = log.time > log.time.mean()
    finding = of_kind(exoid.check(leg, with_column(log, column, 1, lambda x: np.where(later, change(x), x))), "change")
    assert (finding.joint, finding.unit) == (leg.joint_names[1], unit)
    assert finding.value == pytest.approx(value, rel=0.05)
    assert float(finding.message.split()[1]) == pytest.approx(log.time.mean(), abs=1.0)


def test_a_change_at_one_of_six_joints_is_named():
    """It explains half of the squared residuals of that joint, and a tenth of all: it was friction that drifts."""
    leg = draw(3).leg()
    swing = Swing(leg, seconds=30.0, smoothing=0.015)
    noise = 0.01 * swing.torque.std(axis=0) * np.random.default_rng(1).standard_normal(swing.torque.shape)
    log = swing.recording(v=None, a=None, tau=swing.torque + noise)
    later = log.time > log.time.mean()
    found = of_kind(exoid.check(leg, with_column(log, "tau", 3, lambda x: x * (1.0 + 0.007 * later))), "change")
    assert (found.joint, found.value) == (leg.joint_names[3], pytest.approx(0.007, rel=0.1))


def test_friction_that_changes_at_one_joint_hides_no_change_of_another():
    """It explains more, and is no fault of the log: nothing else was tried."""
    leg, log = clean("cuhk")
    later, sign = log.time > log.time.mean(), np.tanh(np.gradient(log.q[:, 0], log.time) / 0.015)
    worn = with_column(log, "tau", 0, lambda x: x + 3.0 * later * sign)
    found = exoid.check(leg, with_column(worn, "q", 1, lambda x: x + 0.005 * later))
    assert of_kind(found, "change").joint == leg.joint_names[1]


def test_a_change_between_logs_moves_parameters_which_are_doubtful():
    leg, log = clean("cuhk")
    other = with_column(clean("cuhk", seed=2)[1], "q", 1, lambda x: x + 0.02)
    estimate = exoid.identify(leg, [log, other])
    finding = of_kind(estimate.findings, "change")
    assert finding.value == pytest.approx(0.02, rel=0.1)
    assert finding.message.startswith("from recording 2 on, the offset of the angle")
    errors = {
        name: abs(estimate[name].value - value) / estimate[name].std
        for name, value in zip(leg.parameter_names, leg.parameters, strict=True)
    }
    assert max(errors.values()) > 2.5
    assert {name for name, z in errors.items() if z > 2.5} <= set(finding.parameters)


def test_one_log_of_several_differs_alone():
    leg, _ = clean("cuhk")
    logs = [clean("cuhk", seed=seed)[1] for seed in (1, 2, 3)]
    logs[1] = with_column(logs[1], "tau", 0, lambda x: x + 2.0)
    finding = of_kind(exoid.check(leg, logs), "change")
    assert finding.message.startswith("in recording 2, offset")
    assert finding.value == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize("joints", [(1,), (0, 1)])
def test_torques_of_one_log_that_are_late_are_not_a_mean_delay_of_all(joints):
    """Nor does `delay="auto"` shift the logs that are on time."""
    leg, _ = clean("cuhk")
    logs = [clean("cuhk", seed=seed)[1] for seed in (1, 2, 3)]
    for joint in joints:
        logs[1] = with_column(logs[1], "tau", joint, lambda x: np.interp(logs[1].time - 0.02, logs[1].time, x))
    estimate = exoid.identify(leg, logs, delay="auto")
    finding = of_kind(estimate.findings, "change")
    what = "the torque of left_knee" if joints == (1,) else "all torques"
    assert finding.message.startswith(f"in recording 2, the delay of {what} differs by")
    assert (finding.value, finding.unit) == (pytest.approx(0.02, rel=0.05), "s")
    assert kinds(estimate.findings) <= {"change", "large-residual"}
    assert not estimate.torque_delays.any()


def test_a_payload_that_is_not_given_is_another_load_of_its_segment():
    leg, log = clean("cuhk")
    loaded = with_payloads(leg, [exoid.Payload(leg.joint_names[1], 1.0, (0.0, 0.0, -0.2))])
    other = Swing(loaded, seconds=30.0, seed=2, smoothing=0.015).recording(v=None, a=None)
    found = of_kind(exoid.check(leg, [log, other]), "wrong-load")
    assert (found.joint, found.value) == (leg.joint_names[1], pytest.approx(0.2, rel=0.05))
    assert "+1 kg" in found.message
    off = dataclasses.replace(other, payloads=(exoid.Payload(leg.joint_names[1], 1.0, (0.0, 0.0, -0.15)),))
    found = of_kind(exoid.check(leg, [log, off]), "wrong-load")  # 5 cm off its place
    assert (found.joint, found.value) == (leg.joint_names[1], pytest.approx(0.05, rel=0.1))


def test_a_load_has_no_moment_along_a_turned_axis(tmp_path):
    """Rounding of a turn by π/2 made one of 4e11 kg·m."""
    turned = one_joint.URDF.replace('"0 1 0"/>', '"0 0 1"/><origin rpy="-1.5707963267948966 0 0"/>')
    (tmp_path / "turned.urdf").write_text(turned, encoding="utf-8")
    leg = exoid.Leg.from_urdf(tmp_path / "turned.urdf")
    loaded = with_payloads(leg, [exoid.Payload("hip", 1.0, (0.0, 0.2, 0.1))])
    swings = [Swing(one, seconds=30.0, seed=k, smoothing=0.015) for k, one in enumerate((leg, loaded))]
    found = of_kind(exoid.check(leg, [one.recording(v=None, a=None) for one in swings]), "wrong-load")
    assert found.value == pytest.approx(0.2, rel=0.1)


def test_a_payload_before_its_place_may_be_another_zero():
    """It turns gravity as the knee's zero does: both are said, and the fault of the log is not told as another one."""
    leg, log = clean("cuhk")
    loaded = with_payloads(leg, [exoid.Payload(leg.joint_names[1], 2.0, (0.0, 0.0, -0.25))])
    other = Swing(loaded, seconds=30.0, seed=2, smoothing=0.015).recording(v=None, a=None)
    off = dataclasses.replace(other, payloads=(exoid.Payload(leg.joint_names[1], 2.0, (0.05, 0.0, -0.25)),))
    found = [one for one in exoid.check(leg, [log, off]) if one.severity == "error"]
    assert "wrong-load" in {one.kind for one in found} <= {"change", "wrong-load"}


def test_steady_logs_of_other_motions_have_no_change():
    leg, log = clean("cuhk")
    slow = Swing(leg, seconds=40.0, seed=3, base=0.05, smoothing=0.015).recording(v=None, a=None)
    assert kinds(exoid.check(leg, [log, clean("cuhk", seed=4)[1], slow])) == set()
