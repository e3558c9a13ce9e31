"""Groups that do not belong together are refused, with the name of the group and what to do."""

import dataclasses

import numpy as np
import pytest
from outcomes import refused
from sessions import TERMS, Session
from unchecked import identify

import exoid
from exoid.errors import BadArgumentError, NotIdentifiableError, NotSupportedError, UnreadableInputError
from exoid.identification.estimators import JointML
from exoid.torques import LoadFriction

BAD, NI = BadArgumentError, NotIdentifiableError


@pytest.fixture(scope="module")
def two(leg):
    rng = np.random.default_rng(0)
    return {name: Session(leg, seed).recording(rng) for seed, name in enumerate(("a", "b"), 1)}


def still(recording, *joints):
    q = np.array(recording.q)
    q[:, joints] = 0.1
    return dataclasses.replace(recording, q=q, v=None, a=None)


def longer(leg):
    text = leg.description.text.replace("-0.43", "-0.40")
    return exoid.Leg.from_description(exoid.leg.description.describe(text, "longer"), leg.joint_names)


def with_an_arm(leg, two):
    arm = exoid.load_leg("cuhk")
    return identify({"a": leg, "b": arm}, {**two, "b": Session(arm, 1, (0, 0), (1, 1), (1, 1)).recording()}, TERMS)


REFUSALS = {
    "own parameters that do not exist": (lambda leg, two: identify(leg, two, TERMS, own="c1"), BAD),
    "an own parameter of no joint": (lambda leg, two: identify(leg, two, TERMS, own=("offset", "c0_toe")), BAD),
    "an own parameter that is part of another": (lambda leg, two: identify(leg, two, own="Ia_hip"), BAD),
    "a prior of a part": (lambda leg, two: identify(leg, two, prior={"Ia_hip": (0.1, 0.01)}), BAD),
    "legs with other parameters": (with_an_arm, BAD),
    "legs of other lengths": (lambda leg, two: identify({"a": leg, "b": longer(leg)}, two, TERMS), BAD),
    "a recording twice": (lambda leg, two: identify(leg, {**two, "c": [dataclasses.replace(two["a"])]}, TERMS), BAD),
    "other names of legs": (lambda leg, two: identify({"a": leg, "c": leg}, two, TERMS), BAD),
    "two groups of one name": (lambda leg, two: identify(leg, {1: two["a"], "1": two["b"]}, TERMS), BAD),
    "no groups": (lambda leg, two: identify(leg, {}, TERMS), BAD),
    "no recordings": (lambda leg, two: identify(leg, {"a": []}, TERMS), BAD),
    "a prediction by all groups": (lambda leg, two: exoid.validate(identify(leg, two, TERMS), two["a"]), BAD),
    "a group without motion": (lambda leg, two: identify(leg, {**two, "b": still(two["b"], 0, 1, 2)}, TERMS), NI),
    "a joint that moves in no group": (
        lambda leg, two: identify(leg, {name: still(data, 1) for name, data in two.items()}, TERMS, own="offset"),
        NI,
    ),
    "a group that lacks a joint": (
        lambda leg, two: identify(leg, {**two, "b": two["b"].select(("left_hip", "left_knee"))}, TERMS),
        UnreadableInputError,
    ),
    "friction under load": (lambda leg, two: identify(leg, two, (*TERMS, LoadFriction())), NotSupportedError),
    "ml": (lambda leg, two: identify(leg, two, TERMS, JointML()), NotSupportedError),
    "a known parameter of no joint": (lambda leg, two: identify(leg, two, TERMS, known={"c0_toe": 1.0}), BAD),
    "a known parameter of no group": (lambda leg, two: identify(leg, two, TERMS, known={"c0_hip[c]": 1.0}), BAD),
    "known twice": (lambda leg, two: identify(leg, two, TERMS, known={"c0_hip": 1.0, "c0_hip[a]": 2.0}), BAD),
    "known and believed": (
        lambda leg, two: identify(leg, two, TERMS, known={"c0_hip": 1.0}, prior={"c0_hip[b]": (1.0, 0.1)}),
        BAD,
    ),
    "a group that does not exist": (lambda leg, two: identify(leg, two, TERMS, own="offset")["c"], BAD),
    "a comparison of nothing": (lambda leg, two: identify(leg, two, TERMS, own=()).compare("a", "b"), BAD),
}


@pytest.mark.parametrize("case", REFUSALS, ids=lambda name: name.replace(" ", "-"))
def test_groups_that_do_not_belong_together_are_refused(leg, two, case):
    call, kind = REFUSALS[case]
    assert refused(kind, lambda: call(leg, two)).remedy


def test_legs_of_other_lengths_may_share_friction(leg, two):
    legs = {"a": leg, "b": longer(leg)}
    apart = identify(legs, two, TERMS, own=(*leg.parameter_names, "offset"))
    assert apart.shared[0] == "c0_hip"
