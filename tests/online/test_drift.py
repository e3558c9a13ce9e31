"""Slow changes: estimates of epochs are calibrated, false alarms are as rare as stated, and a drift is named."""

from __future__ import annotations

import numpy as np
import pytest
from swings import harmonics

import exoid
from exoid.online import RecursiveEstimator
from exoid.torques import TorqueModel

LEG = exoid.load_leg("cuhk")
TERMS = (exoid.Coulomb(), exoid.Viscous())
FRICTION = np.array([1.5, 1.0, 0.3, 0.2])
NOISE = np.array([0.5, 0.3])
RATE, EPOCH = 100.0, 5.0
MODEL = TorqueModel(LEG, TERMS)


def swing(seconds, seed=0):
    """Exact motion, (N, 2) each."""
    rng = np.random.default_rng(seed)
    omega = 2.0 * np.pi * np.array([[0.9, 1.3], [0.7, 1.9]])
    size, phase = np.array([[0.4, 0.15], [0.5, 0.2]]), rng.uniform(0.0, 6.0, (2, 2))
    return harmonics(np.arange(round(seconds * RATE)) / RATE, size, omega, phase)


def torque(motion, friction, seed=0):
    """Torque of friction that may vary, (4,) or (N, 4), with white noise."""
    W = MODEL.regressor(*motion)
    beta = np.hstack([np.tile(LEG.parameters, (len(W), 1)), np.broadcast_to(friction, (len(W), 4))])
    return np.einsum("knp,kp->kn", W, beta) + NOISE * np.random.default_rng(seed).standard_normal(motion[0].shape)


def estimator(**settings):
    plain = {"cutoff": None, "reversal_speed": 0.0, "epoch": EPOCH, "false_alarms": 1.0}
    return RecursiveEstimator(LEG, TERMS, rate=RATE, **(plain | settings))


@pytest.mark.slow
def test_without_a_change_false_alarms_are_as_rare_as_stated():
    """144 false alarms an hour, five times 160 s: at most 32 are expected, and some, or the threshold were too high."""
    motion, alarms = swing(160.0), []
    for seed in range(5):
        online = estimator(false_alarms=144.0)
        online.update(*motion, torque(motion, FRICTION, seed))
        alarms.append(len(online.drifts))
        assert not online.changes
    assert 1 <= sum(alarms) <= 32


def test_friction_that_wears_off_is_named_alone():
    """The knee loses 30 % of its Coulomb friction in two minutes, and nothing else changes."""
    motion = swing(160.0, 3)
    share = 1.0 - 0.3 * np.clip(np.arange(len(motion[0])) / RATE / 120.0, 0.0, 1.0)
    worn = np.tile(FRICTION, (len(share), 1))
    worn[:, 1] *= share
    online = estimator()
    online.update(*motion, torque(motion, worn))
    first = online.drifts[0]
    assert {one.parameter for one in online.drifts} == {"c0_knee"}
    assert first.joint == LEG.joint_names[1]
    assert first.time < 90.0
    at = round(first.time * RATE)
    assert first.after - worn[at - 750, 1] == pytest.approx(0.0, abs=4.0 * first.std)
    assert first.before > first.after
    assert not online.changes
    kinds = [finding.kind for finding in online.findings]
    assert "changed-slowly" in kinds
    assert "c0_knee drifted from" in str(first)


def test_rest_is_no_epoch():
    """No rows, no time: minutes of rest behind a motion change nothing, not even the epochs."""
    motion = swing(30.0, 5)
    online = estimator(reversal_speed=0.05)
    online.update(*motion, torque(motion, FRICTION))
    before = online.state.epochs
    still = np.zeros((round(40.0 * RATE), 2))
    for _ in range(3):
        online.update(still + motion[0][-1], still, still, 5.0 * np.ones_like(still))
    assert online.state.epochs.number == before.number
    assert online.state.epochs.time <= before.time + 1.0
    assert not online.drifts


def test_without_detection_there_are_no_epochs():
    motion = swing(10.0)
    for settings in ({"false_alarms": 0.0}, {"memory": np.inf}):
        online = estimator(**settings)
        online.update(*motion, torque(motion, FRICTION))
        assert online.state.epochs.number == 0
