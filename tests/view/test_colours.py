"""Colours have one meaning each, and readers can tell them apart."""

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


def luminance(colour):
    """Relative luminance of "#rrggbb" (WCAG)."""
    return float((XYZ @ linear(colour))[1])


def test_thin_lines_are_seen_on_white():
    for colour in (*MEANINGS.values(), *LAW_COLOURS, RESIDUAL):
        assert 1.05 / (luminance(colour) + 0.05) > 3.0, colour


@pytest.mark.parametrize("seen", [None, DEUTERANOPIA, PROTANOPIA], ids=["full colour", "deuteranopia", "protanopia"])
def test_colours_with_a_meaning_are_distinct(seen):
    for first, second in combinations(MEANINGS.values(), 2):
        assert distance(first, second, seen) > 15.0, (first, second)


def test_hip_knee_and_ankle_are_distinct():
    for first, second in combinations(JOINT_COLOURS[:3], 2):
        assert distance(first, second, DEUTERANOPIA) > 15.0
