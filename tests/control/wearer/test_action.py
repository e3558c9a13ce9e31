"""The test whether anything acts keeps its level under correlated noise, and notices what it says it notices."""

import numpy as np
import pytest
import scipy

from exoid.control.wearer import action
from exoid.control.wearer.action import LEVEL, Evidence, judge

SAMPLES, TRAINED, JOINTS = 400, 300, 3


def noise(rng, correlation, samples, count):
    """AR(1) noise of unit variance, (count, samples)."""
    white = rng.standard_normal((count, samples + 200)) * np.sqrt(1.0 - correlation**2)
    return scipy.signal.lfilter([1.0], [1.0, -correlation], white, axis=1)[:, 200:]


def effective(correlation, samples):
    """Independent samples that say as much on the power: N γ_0² / Σ γ_k² = N (1 − φ²) / (1 + φ²)."""
    return samples * (1.0 - correlation**2) / (1.0 + correlation**2)


def evidence_of(x, trained, correlation, systematic=0.0):
    """What residuals (n, N) and those of the training (n, M) say."""
    joints = len(x)
    return Evidence(
        x.var(axis=1),
        x.mean(axis=1),
        trained.var(axis=1),
        np.full(joints, systematic),
        np.full(joints, effective(correlation, x.shape[1])),
        np.full(joints, effective(correlation, trained.shape[1])),
    )


@pytest.mark.slow
@pytest.mark.parametrize("correlation", [0.0, 0.6, 0.9])
def test_without_allowance_false_alarms_come_at_the_stated_level(monkeypatch, correlation):
    monkeypatch.setattr(action, "ALLOWANCE", 1.0)
    rng, runs, level = np.random.default_rng(5), 2000, 0.05
    x, trained = (
        noise(rng, correlation, samples, runs * JOINTS).reshape(runs, JOINTS, samples) for samples in (SAMPLES, TRAINED)
    )
    alarms = np.mean(
        [
            any(each.acts for each in judge(evidence_of(now, before, correlation), level))
            for now, before in zip(x, trained, strict=True)
        ]
    )
    assert 0.5 * level < alarms < 1.6 * level


def test_with_its_allowance_there_is_no_false_alarm_though_residuals_grow_by_a_third():
    rng, runs = np.random.default_rng(7), 1000
    x, trained = 1.3 * noise(rng, 0.6, SAMPLES, runs), noise(rng, 0.6, TRAINED, runs)
    acts = [judge(evidence_of(now[None], before[None], 0.6))[0].acts for now, before in zip(x, trained, strict=True)]
    assert np.mean(acts) <= LEVEL


def test_a_torque_as_small_as_the_least_is_noticed_half_of_the_time():
    rng, runs = np.random.default_rng(8), 400
    wave = np.sqrt(2.0) * np.sin(0.3 * np.arange(SAMPLES))
    noticed = []
    for now, before in zip(noise(rng, 0.6, SAMPLES, runs), noise(rng, 0.6, TRAINED, runs), strict=True):
        least = judge(evidence_of(now[None], before[None], 0.6))[0].least
        noticed.append(judge(evidence_of((now + least * wave)[None], before[None], 0.6))[0].acts)
    assert 0.35 < np.mean(noticed) < 0.65


def test_a_constant_torque_does_not_act_but_is_said_to_be_there():
    rng = np.random.default_rng(9)
    now, before = noise(rng, 0.6, SAMPLES, 2), noise(rng, 0.6, TRAINED, 2)
    offset = judge(evidence_of(now + np.array([[2.0], [0.0]]), before, 0.6))
    assert [each.acts for each in offset] == [False, False]
    assert [each.steady for each in offset] == [True, False]
