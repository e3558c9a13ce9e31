"""Contacts from a force, and contacts that contradict a force."""

import numpy as np
import pytest

from exoid import ExoidError, Recording, Wrench
from exoid.signals import contacts_from_wrench
from exoid.signals.external import refuse_contradictions

TIME = np.arange(14700) / 1000.0
STEPS = np.maximum(0.0, np.sin(2.0 * np.pi * 0.9 * TIME))
"""Load of a foot, from 0 to 1: in the air every other half period."""


def foot(load, noise=0.0, up=(0.0, 0.0, 1.0), seed=0):
    rng = np.random.default_rng(seed)
    force = np.outer(load, up) + noise * rng.standard_normal((len(load), 3))
    return Wrench(force, np.zeros_like(force))


def changes(contact):
    return np.count_nonzero(np.diff(contact))


@pytest.mark.parametrize("seed", range(5))
def test_hysteresis_finds_each_step_once_in_noise(seed):
    """Noise of 10 N around one threshold of 10 % (80 N) switches a contact many times; two thresholds do not."""
    load = 800.0 * STEPS
    contact = contacts_from_wrench(foot(load, noise=10.0, seed=seed))
    steps = changes(load > 0.0)
    assert changes(contact) == steps
    assert changes(foot(load, 10.0, seed=seed).force[:, 2] > 80.0) > steps
    assert load[contact].min() > 0.05 * 800.0 - 50.0
    assert load[~contact].max() < 0.1 * 800.0 + 50.0


def test_an_impact_does_not_raise_the_thresholds():
    hit = 800.0 * STEPS
    hit[200:210] = 8000.0
    assert np.array_equal(contacts_from_wrench(foot(hit)), contacts_from_wrench(foot(800.0 * STEPS)))


@pytest.mark.parametrize(
    ("force", "contact", "message"),
    [
        (800.0 * STEPS, np.zeros_like(STEPS), "never 1, and its wrench exceeds 50 N for"),
        (800.0 * STEPS, STEPS == 0.0, "is inverted: its wrench has 0 N .* where it is 1, and"),
        (35.0 * STEPS, STEPS == 0.0, "is inverted"),  # of a light hopper
        (0.8 * STEPS, STEPS > 0.0, "looks like kN"),
    ],
)
def test_contacts_that_contradict_the_force_are_refused(force, contact, message, tmp_path):
    log = Recording(
        TIME,
        STEPS[:, None],
        joint_names=("knee",),
        wrenches={"left_foot": foot(force)},
        contacts={"left_foot": contact},
    )
    with pytest.raises(ExoidError, match=message) as error:
        refuse_contradictions(log.time, log.wrenches, log.contacts)
    assert error.value.remedy
    log.to_csv(tmp_path / "log.csv")
    with pytest.raises(ExoidError, match=message) as error:
        Recording.from_csv(tmp_path / "log.csv")
    assert str(tmp_path / "log.csv") in error.value.where
