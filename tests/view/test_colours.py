"""Colours have one meaning each, and readers can tell them apart."""

from importlib.resources import files
from itertools import combinations

import numpy as np
import pytest

from exoid.view.colours import (
    CAD,
    IDENTIFIED,
    JOINT_COLOURS,
    LAW_COLOURS,
    MEASURED,
    PREDICTED,
    RESIDUAL,
    WEARER,
    WEIGHT,
    joint_colour,
)

MEANINGS = {"measured": MEASURED, "predicted": PREDICTED, "identified": IDENTIFIED, "CAD": CAD, "wearer": WEARER}

DEUTERANOPIA = np.array(
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
)
"""Linear RGB as readers without green cones see it (Machado, Oliveira and Fernandes 2009, severity 1)."""

PROTANOPIA = np.array(
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
)
"""The same without red cones."""

INVERT, TURN = 0.92, np.array([[-0.574, 1.430, 0.144], [0.426, 0.430, 0.144], [0.426, 1.430, -0.856]])
"""CSS's filter of figures in the dark: invert(0.92), and hue-rotate(180deg) as the matrix of its specification."""

DARK = "#16181b"
"""Background of a report in the dark."""

XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
"""XYZ from linear sRGB (IEC 61966-2-1)."""


def linear(colour):
    """Linear RGB of "#rrggbb", (3,)."""
    rgb = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def distance(first, second, seen=None):
    """Distance ΔE of CIE 1976 between two colours; 2.3 is just noticeable."""

    def lab(colour):
        rgb = linear(colour) if seen is None else np.clip(seen @ linear(colour), 0.0, 1.0)
        f = np.cbrt(XYZ @ rgb / [0.9505, 1.0, 1.089])
        return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])

    return np.linalg.norm(lab(first) - lab(second))


@pytest.mark.parametrize("meaning", MEANINGS)
def test_joints_have_none_of_the_colours_with_a_meaning(meaning):
    for colour in (*JOINT_COLOURS, WEIGHT):
        assert distance(colour, MEANINGS[meaning]) > 20.0, colour


def luminance(colour):
    """Relative luminance of "#rrggbb" (WCAG)."""
    return float((XYZ @ linear(colour))[1])


def test_figures_in_the_dark_have_colours_that_are_seen():
    style = files("exoid.view.report").joinpath("page.html.jinja").read_text(encoding="utf-8")
    assert f"invert({INVERT}) hue-rotate(180deg)" in style
    assert f"--paper: {DARK}" in style
    for colour in (*MEANINGS.values(), *JOINT_COLOURS[:3], *LAW_COLOURS, RESIDUAL, "#000000"):
        rgb = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
        turned = np.clip(TURN @ (INVERT + (1.0 - 2.0 * INVERT) * rgb), 0.0, 1.0)
        seen = "#" + "".join(f"{round(255 * part):02x}" for part in turned)
        assert (luminance(seen) + 0.05) / (luminance(DARK) + 0.05) > 3.0, (colour, seen)


def test_thin_lines_are_seen_on_white():
    for colour in (*MEANINGS.values(), *LAW_COLOURS, RESIDUAL):
        assert 1.05 / (luminance(colour) + 0.05) > 3.0, colour


def test_a_residual_is_seen_on_the_band():
    band = 0.3 * np.array([int(PREDICTED[k : k + 2], 16) for k in (1, 3, 5)]) + 0.7 * 255.0
    shown = "#" + "".join(f"{round(part):02x}" for part in band)
    assert (luminance(shown) + 0.05) / (luminance(RESIDUAL) + 0.05) > 2.5


@pytest.mark.parametrize("seen", [None, DEUTERANOPIA, PROTANOPIA], ids=["full colour", "deuteranopia", "protanopia"])
def test_colours_with_a_meaning_are_distinct(seen):
    for first, second in combinations(MEANINGS.values(), 2):
        assert distance(first, second, seen) > 15.0, (first, second)


def test_hip_knee_and_ankle_are_distinct():
    for first, second in combinations(JOINT_COLOURS[:3], 2):
        assert distance(first, second, DEUTERANOPIA) > 15.0


def test_an_eighth_joint_has_the_colour_of_the_first():
    assert joint_colour(len(JOINT_COLOURS)) == JOINT_COLOURS[0]
