"""Colours of figures and scenes: one colour for one meaning, distinct for most colour-blind readers."""

MEASURED, PREDICTED = "#222222", "#9A4FE0"
"""Colours of measured data, and of torque, motion or force that a model predicts or fits."""

IDENTIFIED, CAD = "#0072B2", "#D55E00"
"""Colours of identified and of CAD parameters, and of each of two models that are compared."""

WEARER = "#780068"
"""Colour of the torque of the wearer."""

WEIGHT = "#6B5B4B"
"""Colour of weights."""

RESIDUAL, GUIDE = "#777777", "#cccccc"
"""Colours of residuals and limits, and of guide lines."""

JOINT_COLOURS = ("#009E73", "#CC79A7", "#E69F00", "#33BBEE", "#A3C644", "#882255", "#5D2E00")
"""Colours of hip, knee, ankle, and the further joints of an arm; none of them has another meaning."""

SHADES = ("#B8C0CC", "#8492A6", "#56657A", "#2E3B4E")
"""Colours of several data sets of one kind, from light to dark."""

LAW_COLOURS = ("#555555", "#332288", "#2E9484", "#858526", "#661100", "#3C93C2", "#C08A00", "#D94F70")
"""Colours of control laws, in the order in which they are drawn."""


def joint_colour(joint: int) -> str:
    """Return the colour of a joint, by its index; it is the same in every figure."""
    return JOINT_COLOURS[joint % len(JOINT_COLOURS)]
