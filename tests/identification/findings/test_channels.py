"""Faults of single channels and of time stamps are found, named and measured."""

import dataclasses

import numpy as np
import pytest
from logs import clean, kinds, with_column

import exoid
from exoid.identification.findings.timing import angle_jumps, missing_samples


@pytest.mark.parametrize("part", [0.9, 0.6])
def test_clipped_torque_is_saturation_with_its_rail(part):
    leg, log = clean()
    limit = part * np.abs(log.tau[:, 1]).max()
    found = exoid.check(leg, with_column(log, "tau", 1, lambda x: np.clip(x, -limit, limit)))
    sides = [finding for finding in found if finding.kind == "saturation"]
    assert {finding.joint for finding in sides} == {leg.joint_names[1]}
    assert all(abs(finding.value) == pytest.approx(limit) for finding in sides)


def test_a_quantised_signal_has_no_rail_at_its_peak_and_is_not_stuck():
    leg, log = clean()
    smooth = with_column(log, "tau", 1, lambda x: np.round(10.0 * np.sin(log.time) / 0.05) * 0.05)
    assert "saturation" not in kinds(exoid.check(leg, smooth))
    for levels in (2.0, 4.0, 7.0, 13.0):  # and the leg moves
        coarse = with_column(log, "tau", 1, lambda x, levels=levels: np.round(levels * x / np.ptp(x)))
        assert "stuck-channel" not in kinds(exoid.check(leg, coarse))
    frozen = with_column(coarse, "tau", 1, lambda x: np.where(abs(log.time - log.time[1000]) < 2.0, x[1000], x))
    assert "stuck-channel" in kinds(exoid.check(leg, frozen))


def test_peaks_of_a_joint_that_rings_are_no_spikes():
    leg, log = clean()
    size, t = 8.0 * log.tau[:, 1].std(), log.time[:, None] - log.time[200:-200:300]
    jerks = size * (np.exp(-15.0 * np.abs(t)) * np.cos(60.0 * t)).sum(axis=1)
    assert "spikes" not in kinds(exoid.check(leg, with_column(log, "tau", 1, lambda x: x + jerks)))


@pytest.mark.parametrize(("every", "named"), [(100, {"dropout"}), (600, set())])
def test_lost_messages_are_no_spikes_and_a_few_are_not_named(every, named):
    leg, log = clean()
    lost = np.arange(len(log)) % every == every // 2  # more than four
    far = with_column(log, "tau", 1, lambda x: np.where(lost, 0.0, x + 3.0 * x.std()))
    assert kinds(exoid.check(leg, far)) & {"dropout", "spikes"} == named


def test_four_spikes_of_a_short_log_are_named_and_three_are_not():
    leg, log = clean()
    for count, part in ((4, log.slice(0, 1900)), (3, log.slice(0, 1500))):
        far = (np.arange(len(part)) % 500 == 250) * 9.0 * part.tau[:, 1].std()
        assert ("spikes" in kinds(exoid.check(leg, with_column(part, "tau", 1, far.__add__)))) == (count == 4)


def test_angles_of_a_slower_bus_repeat_and_those_of_a_coarse_encoder_do_not():
    leg, log = clean()
    held = dataclasses.replace(log, q=np.repeat(log.q[::4], 4, axis=0)[: len(log)])
    found = [one for one in exoid.check(leg, held) if one.kind == "stale-samples"]
    assert [one.joint for one in found] == list(leg.joint_names)
    assert all(one.value == pytest.approx(0.75, abs=0.03) for one in found)
    count = 2.0 * np.pi / 2**10  # hardly a count from sample to sample
    assert "stale-samples" not in kinds(exoid.check(leg, dataclasses.replace(log, q=count * np.round(log.q / count))))


def test_torques_that_do_not_count_may_be_anything():
    leg, log = clean()
    counts = (np.arange(len(log)) < 1000) | (np.arange(len(log)) > 1500)
    assert exoid.check(leg, dataclasses.replace(log, mask=counts, tau=np.where(counts[:, None], log.tau, 0.0))) == ()


def test_a_joint_that_comes_to_rest_is_not_stuck():
    leg, log = clean()
    u = np.clip((log.time - log.time[0] - 10.0) / 5.0, 0.0, 1.0)
    moves = 1.0 - np.where(u < 1.0, np.sin(np.pi * u) ** 4, 0.0)
    still = with_column(log, "q", 1, lambda x: x[1000] + (x - x[1000]) * moves)
    assert "stuck-channel" not in kinds(exoid.check(leg, still))


def test_a_dead_torque_channel_is_a_finding_not_an_exception():
    leg, log = clean()
    worst, *others = exoid.check(leg, with_column(log, "tau", 1, lambda x: 0.0 * x))
    assert (worst.severity, {"stuck-channel", "not-identifiable"} <= kinds([worst, *others])) == ("error", True)


def test_a_velocity_at_a_stall_is_no_wrong_velocity():
    """The drive stalls: an observer logs noise of its own, and the encoder hardly a count."""
    leg, log = clean()
    rng, q = np.random.default_rng(5), np.array(log.q)
    q[:, 2] = q[0, 2] + 1e-3 * np.round(rng.standard_normal(len(q)))
    v = np.gradient(log.q, log.time, axis=0)
    v[:, 2] = 0.02 * rng.standard_normal(len(q))
    found = [f for f in exoid.check(leg, dataclasses.replace(log, q=q, v=v)) if f.kind.startswith("velocity")]
    assert "left_ankle" not in {f.joint for f in found}


@pytest.mark.parametrize(("gain", "severity"), [(2.0, "error"), (1.02, "warning"), (1.003, None)])
def test_a_velocity_out_of_scale_is_named_and_not_used(gain, severity):
    """Of 2 percent, inertias would be off by 2 percent, too."""
    leg, log = clean()
    scaled = dataclasses.replace(log, v=gain * np.gradient(log.q, log.time, axis=0))
    estimate = exoid.identify(leg, scaled)
    found = {f.joint: f.severity for f in estimate.findings if f.kind == "velocity-scale"}
    assert found == ({} if severity is None else dict.fromkeys(leg.joint_names, severity))
    if severity is not None:
        assert estimate.values == pytest.approx(exoid.identify(leg, log).values, rel=1e-9)


def test_an_angle_that_jumps_and_stays_is_named_and_spikes_stops_and_lost_samples_are_not():
    leg, log = clean("cuhk")
    later = np.arange(len(log)) > 1234

    def jumps(change):
        found = exoid.check(leg, with_column(log, "q", 1, change))
        return [(f.joint, f.value) for f in found if f.kind == "angle-jump"]

    ((joint, value),) = jumps(lambda x: x + 0.03 * later)
    assert (joint, value) == (leg.joint_names[1], pytest.approx(0.03, rel=0.1))
    assert jumps(lambda x: x + 0.03 * (np.arange(len(x)) == 1234)) == []  # a spike
    assert jumps(lambda x: np.where(later, 2.0 * x[1234] - x, x)) == []  # an impact turns the motion round
    shaken = with_column(log, "q", 0, lambda x: x + 0.03 * (np.arange(len(x)) > 1236))  # an impact shakes all joints
    assert "angle-jump" not in kinds(exoid.check(leg, with_column(shaken, "q", 1, lambda x: x + 0.03 * later)))
    kept = np.setdiff1d(np.arange(len(log)), np.arange(1234, 1240))
    lost = dataclasses.replace(log.slice(0, len(kept)), q=log.q[kept], tau=log.tau[kept])
    assert "angle-jump" not in kinds(exoid.check(leg, lost))
    t = np.arange(4000) / 333.0
    q = 2e-4 * np.rint(np.sin(np.outer(2.0 * t + 1.0, [1.0, 1.3])) / 4e-4)
    rounded = exoid.Recording(np.round(t, 3), q, tau=q, joint_names=("hip", "knee"))
    assert not [*angle_jumps(rounded.resampled())]  # a count, between samples


@pytest.mark.parametrize("lost", [(300,), (300, 700)])
def test_gaps_are_added_where_samples_are_missing(lost):
    kept = np.setdiff1d(np.arange(1200), [k + j for k in lost for j in range(6)])
    q = 0.5 * np.sin(2.0 * kept / 100.0)[:, None]
    log = exoid.Recording(np.arange(len(kept)) / 100.0, q, tau=q, joint_names=("hip",))
    (finding,) = missing_samples(log)
    assert finding.value == pytest.approx(0.06 * len(lost), rel=0.05)
    assert (finding.interval is None) == (len(lost) > 1)


def test_a_joint_at_rest_does_not_hide_lost_samples_and_a_frozen_one_or_a_bounce_is_none():
    """Encoders of 13 bits; the knee stands while the hip moves."""
    t, count = np.arange(1200) / 500.0, 2.0 * np.pi / 2**13
    q = np.rint(np.column_stack([0.5 * np.sin(4.0 * t), 0.0 * t + 0.3]) / count) * count
    kept = np.setdiff1d(np.arange(len(t)), np.arange(700, 730))
    log = exoid.Recording(t[: len(kept)], q[kept], tau=q[kept], joint_names=("hip", "knee"))
    (finding,) = missing_samples(log)
    assert finding.value == pytest.approx(0.06, rel=0.1)
    held = q.copy()
    held[700:730, 0] = held[700, 0]  # and jumps to where it should be
    assert not [*missing_samples(dataclasses.replace(log, time=t, q=held, tau=held))]
    wrapped = q + 2.0 * np.pi * np.outer(t >= t[700], [1.0, 0.0])  # passes the encoder's zero, while the knee stands
    assert not [*missing_samples(dataclasses.replace(log, time=t, q=wrapped, tau=wrapped, largest_angle=np.inf))]
    bounces = np.abs(np.sin(4.0 * t + 1.0))[:, None] * [1.0, -0.5] + np.random.default_rng(0).normal(0.0, 3e-5, q.shape)
    assert not [*missing_samples(dataclasses.replace(log, time=t, q=bounces, tau=bounces))]
