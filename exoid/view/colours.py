"""Colours of figures and scenes, which a colour-blind reader tells apart."""

MEASURED, IDENTIFIED, CAD, LEFT_OVER, GUIDE = "#222222", "#0072B2", "#D55E00", "#999999", "#cccccc"
"""Of what was measured, what an identified model says, what CAD says, residuals, and lines that guide the eye."""

JOINT_COLOURS = ("#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#0072B2", "#D55E00", "#7F7F7F")
"""Hip, knee, ankle, and the further joints of an arm."""

SHADES = ("#9ecae1", "#4292c6", "#08519c", "#08306b")
"""Of several sets of the same, from light to dark."""


def joint_colour(joint: int) -> str:
    """Colour of a joint, the same in every figure."""
    return JOINT_COLOURS[joint % len(JOINT_COLOURS)]
