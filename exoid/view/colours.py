"""Colours of figures and scenes that colour-blind readers can distinguish."""

MEASURED, IDENTIFIED, CAD, RESIDUAL, GUIDE = "#222222", "#0072B2", "#D55E00", "#999999", "#cccccc"
"""Colours of measured data, identified models, CAD models, residuals, and guide lines."""

WEARER = "#B04A9B"
"""Colour of the torque of the wearer."""

JOINT_COLOURS = ("#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#0072B2", "#D55E00", "#7F7F7F")
"""Colours of hip, knee, ankle, and the further joints of an arm."""

SHADES = ("#9ecae1", "#4292c6", "#08519c", "#08306b")
"""Colours of several data sets of one kind, from light to dark."""


def joint_colour(joint: int) -> str:
    """Return the colour of a joint, by its index; it is the same in every figure."""
    return JOINT_COLOURS[joint % len(JOINT_COLOURS)]
