"""Groups that do not belong together are refused, with the name of the group and what to do."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from sessions import TERMS, Session

import exoid
from exoid import ExoidError, identify
from exoid.identification.estimators import JointML
from exoid.torques import LoadFriction, NonlinearParameter, Stribeck


@pytest.fixture(scope="module")
def leg():
    return exoid.load_leg("bleex")


@pytest.fixture(scope="module")
def two(leg):
    rng = np.random.default_rng(0)
    return {name: Session(leg, seed).recording(rng) for seed, name in enumerate(("a", "b"), 1)}


@pytest.mark.parametrize(
    ("own", "match"),
    [
        ("c1", r"no parameter 'c1' to be each group's own.*name some of c0, d, offset, X1"),
        (("offset", "c0_toe"), "no parameter 'c0_toe'"),
    ],
)
def test_own_parameters_that_do_not_exist(leg, two, own, match):
    with pytest.raises(ExoidError, match=match):
        identify(leg, two, TERMS, own=own)


def test_an_own_parameter_that_is_part_of_another(leg, two):
    with pytest.raises(ExoidError, match=r"Ia_hip is regrouped into J1.*name J1 as own instead"):
        identify(leg, two, own="Ia_hip")


def test_legs_with_other_parameters(leg, two):
    arm = exoid.load_leg("cuhk")
    legs, groups = {"a": leg, "b": arm}, {"a": two["a"], "b": Session(arm, 1, (0, 0), (1, 1), (1, 1)).recording()}
    with pytest.raises(ExoidError, match=r"parameters of a are X1.*those of b X1.*legs of one design"):
        identify(legs, groups, TERMS)


def test_legs_of_other_lengths(leg, two):
    text = leg.description.text.replace("-0.43", "-0.40")
    assert text != leg.description.text
    longer = exoid.Leg.from_description(exoid.leg.description.describe(text, "longer"), leg.joint_names)
    with pytest.raises(ExoidError, match="legs of a and b are not of one design"):
        identify({"a": leg, "b": longer}, two, TERMS)
    apart = identify({"a": leg, "b": longer}, two, TERMS, own=(*leg.parameter_names, "offset"))
    assert apart.shared[0] == "c0_hip"  # friction may be shared all the same


def test_the_same_recording_twice(leg, two):
    again = dataclasses.replace(two["a"])
    with pytest.raises(ExoidError, match="the same recording is in a and in c"):
        identify(leg, {**two, "c": [again]}, TERMS)


def test_two_files_of_one_name(leg, two, tmp_path):
    paths = [tmp_path / day / "log.csv" for day in ("monday", "tuesday")]
    for path, recording in zip(paths, two.values(), strict=True):
        path.parent.mkdir()
        recording.to_csv(path)
    with pytest.raises(ExoidError, match=r"two recordings are called log.csv.*name them"):
        identify(leg, [exoid.Recording.from_csv(path) for path in paths], TERMS, own="offset")


def test_names_of_legs_and_recordings_that_differ(leg, two):
    with pytest.raises(ExoidError, match="legs are of a, c, recordings of a, b"):
        identify({"a": leg, "c": leg}, two, TERMS)


def test_two_groups_of_one_name(leg, two):
    with pytest.raises(ExoidError, match="two groups have the same name"):
        identify(leg, {1: two["a"], "1": two["b"]}, TERMS)


@pytest.mark.parametrize("groups", [{}, [], {"a": []}])
def test_no_recordings(leg, groups):
    with pytest.raises(ExoidError, match="no recordings"):
        identify(leg, groups, TERMS)


def still(recording, joint):
    q = np.array(recording.q)
    q[:, joint] = 0.1
    return dataclasses.replace(recording, q=q, v=None, a=None)


def test_a_group_without_motion(leg, two):
    rest = still(still(still(two["b"], 0), 1), 2)
    with pytest.raises(ExoidError, match="b: joint left_hip stands still"):
        identify(leg, {"a": two["a"], "b": rest}, TERMS)


def test_a_joint_that_moves_in_no_group(leg, two):
    with pytest.raises(ExoidError, match="a: joint left_knee stands still"):
        identify(leg, {name: still(data, 1) for name, data in two.items()}, TERMS, own="offset")


def test_a_group_that_lacks_a_joint(leg, two):
    part = two["b"].select(("left_hip", "left_knee"))
    with pytest.raises(ExoidError, match="b: the leg's left_ankle not in the recording"):
        identify(leg, {"a": two["a"], "b": part}, TERMS)


@pytest.mark.parametrize("term", [LoadFriction(), Stribeck(velocity=NonlinearParameter(0.1, 0.01, 1.0))])
def test_terms_in_which_torque_is_not_linear(leg, two, term):
    with pytest.raises(ExoidError, match="fitted together only where torque is linear"):
        identify(leg, two, (*TERMS, term))


@pytest.mark.parametrize("estimator", ["ml", JointML(), "output-error"])
def test_estimators_of_one_leg_alone(leg, two, estimator):
    with pytest.raises(ExoidError, match=r"is for one leg alone.*use one of gls, huber, ols, wls"):
        identify(leg, two, TERMS, estimator)


@pytest.mark.parametrize(
    ("known", "prior", "match"),
    [
        ({"c0_toe": 1.0}, {}, "no parameter 'c0_toe'"),
        ({"c0_hip[c]": 1.0}, {}, r"no parameter 'c0_hip\[c\]'.*c0_hip\[a\]"),
        ({"c0_hip": 1.0, "c0_hip[a]": 2.0}, {}, r"c0_hip\[a\] is known or has a prior twice"),
        ({"c0_hip": 1.0}, {"c0_hip[b]": (1.0, 0.1)}, r"c0_hip\[b\] is known or has a prior twice"),
    ],
)
def test_assumptions_about_what_does_not_exist_or_twice(leg, two, known, prior, match):
    with pytest.raises(ExoidError, match=match):
        identify(leg, two, TERMS, known=known, prior=prior)


def test_a_prior_of_a_parameter_that_is_part_of_another(leg, two):
    with pytest.raises(ExoidError, match=r"Ia_hip is regrouped into J1.*say what is known of J1 instead"):
        identify(leg, two, prior={"Ia_hip": (0.1, 0.01)})


def test_groups_and_comparisons_that_do_not_exist(leg, two):
    together = identify(leg, two, TERMS, own="offset")
    with pytest.raises(ExoidError, match=r"no group 'c'.*groups are a, b"):
        together["c"]
    with pytest.raises(ExoidError, match="nothing to compare: a twice"):
        together.compare("a", "a")
    with pytest.raises(ExoidError, match="a and b share every parameter"):
        identify(leg, two, TERMS, own=()).compare("a", "b")
