"""Which parameters can be determined on which contacts, before any motion is planned."""

from __future__ import annotations

import numpy as np
import pytest
from public_robots import urdf_of

import exoid
from exoid.experiments.excitation import determined_on

pytestmark = pytest.mark.slow

FEET = ("LF_FOOT", "RF_FOOT", "LH_FOOT", "RH_FOOT")


def open_on(found, label):
    return {
        name for name, seen in zip(found.names, found.determined[found.labels.index(label)], strict=True) if not seen
    }


def test_flat_feet_determine_what_the_docs_say():
    """The table of docs/plan.md; the torso held hides its own parameters, and nothing is hidden in the air."""
    exo = exoid.load_exo("bleex", base="floating")
    found = determined_on(exo, [["left_foot"], ["right_foot"], ["left_foot", "right_foot"], ["torso"], []])
    of_left = {f"{symbol}_left" for symbol in ("X1", "J1", "X2", "J2", "X3", "Y3", "J3")}
    assert open_on(found, "left_foot") == {"M", "J0", *of_left}
    assert {"X0", "Y0"}.isdisjoint(open_on(found, "left_foot + right_foot"))
    assert {"M", "J0", "X1_left", "J3_right"} < open_on(found, "left_foot + right_foot")
    assert open_on(found, "torso") == {"M", "X0", "Y0", "J0"}
    assert not open_on(found, "air")
    assert not open_on(determined_on(exo, [["left_foot"], ["right_foot"]]), "all of these")
    assert "13 of 22" in str(found)
    assert found.to_json()["left_foot"]["X0"] is True


def test_a_hook_hides_the_weight_that_hangs_in_it_and_each_point_foot_one_direction():
    """A mass at the point that rests changes no row: parameters that it is part of are open."""
    contacts = {**dict.fromkeys(FEET, "point"), "base": "point"}
    dog = exoid.Leg.from_urdf(urdf_of("anymal"), base="floating", contacts=contacts)
    found = determined_on(dog, [["base"], ["LF_FOOT"], FEET])
    assert {name[:8] for name in open_on(found, "base")} == {"m_base +"}
    of_one = open_on(found, "LF_FOOT")
    assert len(of_one) < len(open_on(found, " + ".join(FEET)))
    assert all("base" in name or "LF" in name for name in of_one)


def test_on_a_rail_the_foot_has_to_leave_the_ground():
    bleex = exoid.load_leg("bleex").description
    hopper = exoid.Leg.from_description(bleex, ("left_hip", "left_knee"), base="z", contacts={"left_foot": "point"})
    found = determined_on(hopper, [["left_foot"], []])
    assert np.array_equal(found.determined.sum(axis=1), [2, 7, 7])


def test_a_link_that_is_not_there_is_named_and_one_that_holds_all_joints():
    with pytest.raises(exoid.ExoidError, match="left_fot"):
        determined_on(exoid.load_exo("bleex", base="floating"), [["left_fot"]])
    with pytest.raises(exoid.ExoidError, match="left_foot hold all joints"):
        determined_on(exoid.load_leg("bleex"), [[], ["left_foot"]])
