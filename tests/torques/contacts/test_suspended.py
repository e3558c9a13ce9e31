"""A machine on a hook, and one in flight: what each determines, and what is refused."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import study_suspended as study

import exoid
from exoid.errors import NotIdentifiableError, UnreadableInputError
from exoid.leg.description import describe
from exoid.torques.contacts.stretches import contact_of, split


@cache
def machine():
    text = study.with_hook(study.urdf())
    return exoid.Leg.from_description(describe(text, "anymal.urdf"), base="floating", contacts={"hook": "point"})


@cache
def logs(support, count=2, seconds=10.0):
    text = machine().description.text
    return [study.simulate(text, support, seconds, np.random.default_rng([7, k])) for k in range(count)]


def short(support):
    """A log from which nothing is identified."""
    return logs(support, 1, 2.0)[0]


@pytest.mark.nightly
def test_a_hook_hides_the_total_mass_and_nothing_else():
    leg = machine()
    mass, truth = leg.parameter_names[0], leg.parameters
    with pytest.raises(NotIdentifiableError) as refused:
        exoid.identify(leg, logs("hook"), terms=(), check=False)
    assert mass in refused.value.parameters
    found = exoid.identify(leg, logs("hook"), terms=(), check=False, known={mass: float(truth[0])})
    assert np.mean(np.abs(found.values - truth)[1:] < 1.96 * found.std[1:]) > 0.9


@pytest.mark.nightly
def test_in_flight_the_total_mass_is_weak_and_its_interval_says_so():
    leg = machine()
    found = exoid.identify(leg, logs("flight"), terms=(), check=False)
    # by noise of the accelerometer alone, it is off by ten of the standard deviations of the fit
    assert 0.01 < found.std[0] / leg.parameters[0] < 0.15
    assert np.mean(np.abs(found.values - leg.parameters) < 1.96 * found.std) > 0.85
    (finding,) = [each for each in found.findings if each.kind == "suspended"]
    assert finding.parameters == leg.parameter_names[:1]


@pytest.mark.parametrize(("load", "down"), [(15.0, False), (25.0, True)])
def test_a_plate_that_reads_little_more_than_noise_is_no_ground(exo, load, down):
    force = load * np.maximum(0.0, np.sin(np.arange(100) * 0.6))
    flags = contact_of(exo, "left_foot", exoid.Wrench(np.outer(force, (0.0, 0.0, 1.0)), np.zeros((100, 3))))
    assert (flags is not None) == down


def test_a_base_that_is_held_does_not_fly():
    hung = replace(short("hook"), contacts={"LF_FOOT": np.zeros(len(short("hook")), dtype=bool)})
    with pytest.raises(UnreadableInputError, match="it is held"):
        exoid.identify(machine(), hung, terms=())
    flight = short("flight")
    biased = replace(flight.base, specific_force=flight.base.specific_force + 0.1)
    assert split(machine(), replace(flight, base=biased)).stretches  # and one with a bias still flies
