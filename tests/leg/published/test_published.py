"""The published tables against numbers typed from the documents a second time, apart from the TOML files."""

import pytest

from exoid import published
from exoid.leg.published.document import Quantity

PRINTED = [  # document, table, name, digits, unit
    ("bleex", "I", "left.b23", "0.3129", "N·m/rad²"),
    ("bleex", "I", "right.b03", "4.5771", "N·m"),
    ("bleex", "II", "left.Y1", "-0.4083", "kg·m"),
    ("bleex", "III", "left.J1", "2.380", "kg·m²"),
    ("bleex", "III", "right.J3", "0.05243", "kg·m²"),
    ("bleex", "IV", "left.c03", "-0.2646", "N·m"),
    ("bleex", "V", "Y2", "0.05778", "kg·m"),
    ("cuhk", "II", "no2.pairs", "40", "1"),
    ("cuhk", "II", "no4.knee_omega", "0.1", "π rad/s"),
    ("cuhk", "III", "hip.Y1", "-1.5967", "kg·m"),
    ("cuhk", "III", "hip.sign_coefficient", "-1.445", "N·m"),
    ("cuhk", "III", "hip.viscous", "-0.03776", "N·m per unit of θ̇"),
    ("cuhk", "III", "hip.offset", "-16.39", "N·m"),
    ("cuhk", "III", "knee.stiffness", "0.039", "N·m per unit of θ"),
]

PARAMETERS = {  # X1, Y1, J1, X2, Y2, J2, X3, Y3, J3
    "cad": (3.783, -0.1601, 2.497, 2.055, 0.05778, 0.8939, 0.2793, 0.1546, 0.05628),
    "left": (3.9819, -0.4083, 2.38, 1.9628, 0.0031, 0.7833, 0.2552, 0.1313, 0.04528),
    "right": (4.0474, -0.499, 2.598, 1.9532, -0.0386, 0.7897, 0.2554, 0.1279, 0.05243),
}

DOCUMENTS = {"bleex": published.bleex, "cuhk": published.cuhk}


@pytest.mark.parametrize(("document", "table", "name", "digits", "unit"), PRINTED)
def test_a_table_holds_the_printed_digits_and_unit(document, table, name, digits, unit):
    quantity = DOCUMENTS[document]().tables[table].values[name]
    assert quantity == Quantity(float(digits), unit, digits)


@pytest.mark.parametrize("which", PARAMETERS)
def test_bleex_parameters_come_from_the_right_tables_in_the_librarys_order(which):
    parameters = published.bleex_parameters(which)
    assert tuple(parameters) == ("X1", "Y1", "J1", "X2", "Y2", "J2", "X3", "Y3", "J3")
    assert tuple(parameters.values()) == PARAMETERS[which]


def test_the_assumed_cad_of_cuhk_errs_as_that_of_bleex_does():
    """Mass moments and inertias in the ratio of Table V to the mean of Tables II and III; Y as an angle."""
    cad, true = published.cuhk_cad_parameters(), published.cuhk_parameters()
    assert tuple(cad) == tuple(true)
    assert cad["X1"] / true["X1"] == pytest.approx(3.783 / 4.01465)
    assert cad["X2"] / true["X2"] == pytest.approx(2.055 / 1.958)
    assert cad["J1"] / true["J1"] == pytest.approx((2.497 - 0.8939) / (2.489 - 0.7865))
    assert cad["J2"] / true["J2"] == pytest.approx(0.8939 / 0.7865)
    assert (cad["Y1"] - true["Y1"]) / true["X1"] == pytest.approx((0.45365 - 0.1601) / 4.01465)
    assert (cad["Y2"] - true["Y2"]) / true["X2"] == pytest.approx((0.05778 + 0.01775) / 1.958)


def test_bleex_resistances_have_the_opposite_sign_of_the_printed_torques():
    assert published.bleex_resistances("left") == {
        "b2_knee": -0.6263,
        "b1_knee": -1.9334,
        "b0_knee": -0.5,
        "c0_knee": 0.5291,
        "b2_ankle": -0.3129,
        "b1_ankle": -0.1557,
        "b0_ankle": 0.5829,
        "c0_ankle": 0.2646,
    }
    right = published.bleex_resistances("right")
    assert (right["b0_ankle"], right["c0_knee"], right["b2_ankle"]) == (-4.5771, 0.4081, 1.5341)


def test_the_cuhk_plant_has_the_magnitudes_of_table_iii_as_resistances():
    table, plant = published.cuhk().tables["III"], published.cuhk_resistances()
    for joint in ("hip", "knee"):
        printed = table.column(joint)
        assert plant[f"c0_{joint}"] == pytest.approx(-printed["sign_coefficient"].value, abs=5e-4)
        assert plant[f"d_{joint}"] == pytest.approx(-printed["viscous"].value, abs=5e-4)
    assert plant["b1_knee"] == 0.5
