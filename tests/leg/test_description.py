"""Hostile and broken URDFs: each ends in one line that says what is wrong, where, and what to do."""

import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from outcomes import outcome
from planar_chains import random_chain
from small_urdfs import URDF, replaced

from exoid import ExoidError, Leg
from exoid.errors import UnreadableInputError
from exoid.leg.description import LARGEST_URDF, describe, read_description


def test_a_file_that_is_too_large_is_not_read_to_its_end(tmp_path):
    path = tmp_path / "huge.urdf"
    with path.open("wb") as file:
        file.truncate(50 * LARGEST_URDF)
    tracemalloc.start()
    try:
        with pytest.raises(UnreadableInputError, match="20 MB"):
            read_description(path)
        assert tracemalloc.get_traced_memory()[1] < 3 * LARGEST_URDF
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_a_file_that_is_not_utf_8_is_refused(tmp_path, encoding):
    path = tmp_path / "leg.urdf"
    path.write_bytes(URDF.replace('name="leg"', 'name="jambe pliée"').encode(encoding))
    with pytest.raises(UnreadableInputError) as refused:
        read_description(path)
    assert refused.value.file == str(path)


def test_a_byte_order_mark_and_names_in_any_script_are_read(tmp_path):
    path = tmp_path / "leg.urdf"
    path.write_bytes(b"\xef\xbb\xbf" + URDF.replace("knee", "колено").encode())
    assert Leg.from_urdf(path).joint_names == ("hip", "колено")


def test_a_wrong_encoding_declaration_does_not_change_the_names():
    """The text is UTF-8 whatever it says of itself."""
    text = URDF.replace('version="1.0"', 'version="1.0" encoding="iso-8859-1"').replace("shank", "jambe_pliée")
    assert describe(text).child_links["knee"] == "jambe_pliée"


@pytest.mark.parametrize("gap", ["\n", "\t", "\n      ", "   ", "&#10;", "\u00a0"])
def test_numbers_may_be_parted_and_surrounded_by_any_blank(gap):
    """Pinocchio's own parser knows single spaces only, and would drop the <inertial>."""
    text = URDF.replace('xyz="0 0 -0.2"', f'xyz="0{gap}0{gap}-0.2"').replace('value="2"', f'value="{gap}2{gap}"')
    np.testing.assert_array_equal(
        Leg.from_description(describe(text)).parameters, Leg.from_description(describe(URDF)).parameters
    )


def test_what_does_not_move_or_is_only_large_is_read():
    """An axis of a fixed joint, a link without inertia behind a locked joint, a joint of six freedoms aside."""
    still = replaced('<axis xyz="0 -1 0"/>', '<axis xyz="0 0 0"/>').replace('type="revolute"', 'type="fixed"', 1)
    assert Leg.from_description(describe(still)).joint_names == ("knee",)
    assert Leg.from_description(describe(replaced('type="revolute"', 'type="floating"'))).joint_names == ("knee",)
    largest = Leg.from_description(describe(replaced('xyz="0 0 -0.2"', 'xyz="99 0 0"')))
    assert np.isfinite(largest.parameters).all()


PARTS = {1 / 2: ("1.5708", "1.57", "1.571", "157.08e-2"), -1 / 2: ("-1.5707",), 1: ("3.1416",), -1: ("-3.14",)}
PARTS |= {1 / 4: ("0.7854",), 1 / 3: ("1.0472",), 2: ("6.2832",)}
EXACT = [(text, part * math.pi) for part, texts in PARTS.items() for text in texts]
OTHERS = "1.56", "1.58", "1.6", "3", "0.79", "0.785", "0.0001", "0", "-0.01", "15.71"


@pytest.mark.parametrize(("text", "exact"), [*EXACT, *((text, float(text)) for text in OTHERS)])
def test_angles_of_few_digits_that_stand_for_parts_of_pi_are_exact_in_the_model(text, exact):
    turned = describe(replaced('<origin xyz="0 0 1"/>', f'<origin xyz="0 0 1" rpy="0 {text} 0"/>'))
    placement = Leg.from_description(turned).model.jointPlacements[1]
    np.testing.assert_allclose(placement.rotation[0, 2], math.sin(exact), rtol=0, atol=1e-15)


def test_a_leg_whose_joints_are_turned_by_rounded_right_angles_is_planar():
    """Hip about y turned to x by 1.5708 and back: X, Y and J as of the leg with exact axes."""
    turned = URDF.replace('<origin xyz="0 0 -0.4"/>', '<origin xyz="0 0 -0.4" rpy="0 0 1.5708"/>').replace(
        '<child link="shank"/><axis xyz="0 -1 0"/>', '<child link="shank"/><axis xyz="-1 0 0"/>'
    )
    leg = Leg.from_description(describe(turned))
    assert leg.parameter_names == ("X1", "Y1", "J1", "X2", "Y2", "J2")


@given(seed=st.integers(0, 2**32 - 1), data=st.data())
def test_a_good_urdf_with_a_piece_missing_or_repeated_is_a_leg_or_an_exoid_error(seed, data):
    text = random_chain(np.random.default_rng(seed), 2).text
    start = data.draw(st.integers(0, len(text)))
    stop = data.draw(st.integers(start, min(len(text), start + 200)))
    cut, doubled = text[:start] + text[stop:], text[:stop] + text[start:]
    assert isinstance(outcome(lambda: Leg.from_description(describe(cut))), Leg | ExoidError)
    assert isinstance(outcome(lambda: Leg.from_description(describe(doubled))), Leg | ExoidError)
