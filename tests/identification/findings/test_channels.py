"""Faults of single channels and of time stamps are found, named and measured."""

import dataclasses

import numpy as np
import pytest
from logs import clean, kinds, of_kind, with_column

import exoid


@pytest.mark.parametrize("part", [0.9, 0.6])
def test_clipped_torque_is_saturation_with_its_rail(part):
    leg, log = clean()
    limit = part * np.abs(log.tau[:, 1]).max()
    found = exoid.check(leg, with_column(log, "tau", 1, lambda x: np.clip(x, -limit, limit)))
    sides = [finding for finding in found if finding.kind == "saturation"]
    assert sides
    assert {finding.joint for finding in sides} == {leg.joint_names[1]}
    assert all(abs(finding.value) == pytest.approx(limit) for finding in sides)


def test_a_peak_of_a_quantised_signal_is_no_rail():
    leg, log = clean()
    smooth = with_column(log, "tau", 1, lambda x: np.round(10.0 * np.sin(log.time) / 0.05) * 0.05)
    assert "saturation" not in kinds(exoid.check(leg, smooth))


def test_a_frozen_torque_is_named_with_its_times():
    leg, log = clean()
    start = 1000

    def freeze(x):
        x[start : start + 300] = x[start]
        return x

    finding = of_kind(exoid.check(leg, with_column(log, "tau", 1, freeze)), "stuck-channel")
    assert finding.joint == leg.joint_names[1]
    assert finding.value == pytest.approx(3.0, abs=0.03)
    assert f"{log.time[start]:.3f} s" in finding.message


def test_a_frozen_angle_is_found():
    leg, log = clean()
    start = int(np.argmax(np.abs(np.gradient(log.q[500:2000, 1])))) + 500

    def freeze(x):
        x[start : start + 200] = x[start]
        return x

    finding = of_kind(exoid.check(leg, with_column(log, "q", 1, freeze)), "stuck-channel")
    assert finding.joint == leg.joint_names[1]
    assert "angle" in finding.message


def test_a_joint_that_comes_to_rest_is_not_stuck():
    leg, log = clean()

    def rest(x):
        u = np.clip((log.time - log.time[0] - 10.0) / 5.0, 0.0, 1.0)
        return x[1000] + (x - x[1000]) * (1.0 - np.where(u < 1.0, np.sin(np.pi * u) ** 4, 0.0))

    assert "stuck-channel" not in kinds(exoid.check(leg, with_column(log, "q", 1, rest)))


def test_samples_missing_behind_new_stamps_are_found():
    leg, log = clean()
    fast = int(np.argmax(np.abs(np.gradient(log.q, axis=0)).sum(axis=1)[500:2000])) + 500
    keep = np.delete(np.arange(len(log)), np.s_[fast : fast + 4])
    short = dataclasses.replace(log, time=log.time[: len(keep)], q=log.q[keep], tau=log.tau[keep])
    finding = of_kind(exoid.check(leg, short), "missing-samples")
    assert finding.value == pytest.approx(0.04, rel=0.1)
    assert finding.interval[0] < 0.04 < finding.interval[1]


def test_dropouts_to_zero_are_found():
    leg, log = clean()
    lost = np.random.default_rng(1).random(len(log)) < 0.02
    finding = of_kind(exoid.check(leg, with_column(log, "tau", 0, lambda x: np.where(lost, 0.0, x))), "dropout")
    assert finding.joint == leg.joint_names[0]
    assert finding.value == pytest.approx(lost.mean(), abs=0.005)


def test_values_of_a_slower_bus_are_found():
    leg, log = clean()
    held = with_column(log, "tau", 2, lambda x: x[np.arange(len(x)) // 4 * 4])
    finding = of_kind(exoid.check(leg, held), "stale-samples")
    assert finding.joint == leg.joint_names[2]
    assert finding.value == pytest.approx(0.75, abs=0.01)


def test_one_sided_spikes_are_found():
    leg, log = clean()
    hit = np.random.default_rng(1).random(len(log)) < 0.01
    finding = of_kind(exoid.check(leg, with_column(log, "tau", 0, lambda x: x + hit * 3.0 * x.std())), "spikes")
    assert finding.joint == leg.joint_names[0]
    assert "one side" in finding.message


def test_a_late_velocity_is_found_with_its_delay():
    leg, log = clean()
    v = np.gradient(log.q, axis=0) * log.sample_rate
    assert kinds(exoid.check(leg, dataclasses.replace(log, v=v))) == set()
    v[:, 1] = np.interp(log.time - 0.05, log.time, v[:, 1])
    finding = of_kind(exoid.check(leg, dataclasses.replace(log, v=v)), "velocity-delay")
    assert finding.joint == leg.joint_names[1]
    assert finding.value == pytest.approx(0.05, abs=0.005)


def test_an_angle_that_wraps_is_found():
    leg, log = clean()

    def wrap(x):
        x[1500:] += 2.0 * np.pi
        return x

    wide = dataclasses.replace(log, largest_angle=np.inf)
    assert of_kind(exoid.check(leg, with_column(wide, "q", 1, wrap)), "angle-wrap").joint == leg.joint_names[1]


def test_a_dead_torque_channel_is_a_finding_not_an_exception():
    leg, log = clean()
    found = exoid.check(leg, with_column(log, "tau", 1, lambda x: 0.0 * x))
    assert {"stuck-channel", "not-identifiable"} <= kinds(found)
    assert found[0].severity == "error"


def test_a_velocity_at_a_stall_is_no_wrong_velocity():
    """The drive stalls: an observer logs noise of its own, and the encoder hardly a count."""
    leg, log = clean()
    rng, q = np.random.default_rng(5), np.array(log.q)
    q[:, 2] = q[0, 2] + 1e-3 * np.round(rng.standard_normal(len(q)))
    v = np.gradient(log.q, log.time, axis=0)
    v[:, 2] = 0.02 * rng.standard_normal(len(q))
    found = [f for f in exoid.check(leg, dataclasses.replace(log, q=q, v=v)) if f.kind.startswith("velocity")]
    assert "left_ankle" not in {f.joint for f in found}
    scaled = exoid.check(leg, dataclasses.replace(log, q=log.q, v=2.0 * np.gradient(log.q, log.time, axis=0)))
    assert {f.joint for f in scaled if f.kind == "velocity-scale"} == {*leg.joint_names}
