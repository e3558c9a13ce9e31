"""Angles that a URDF gives in few digits, such as 1.5708 for π/2.

Few digits turn parallel joint axes into nearly parallel ones. Such axes let parameters act on the torques that do not
act on those of the robot, a millionth as much as the others, and no recording determines them.
"""

from __future__ import annotations

import math
from decimal import ROUND_DOWN, ROUND_HALF_EVEN, Decimal

RIGHT_ANGLE_DECIMALS = 2
"""Decimals from which on a number that is a rounded multiple of π/2 stands for it: 1.57."""

OTHER_ANGLE_DECIMALS = 4
"""Decimals from which on a number that is a rounded multiple of π/12 stands for it: 0.5236."""

MOST_DECIMALS = 10
"""Decimals beyond which rounding has no effect: the number stays as it is."""


def exact_angle(text: str) -> str:
    """Replace a rounded multiple of π/12 by the exact one.

    Args:
        text: Decimal number [rad] as the URDF has it.

    Returns:
        All digits of a multiple of π/2 or π/12 other than zero and up to 2π, if the number is that multiple rounded or
        cut off to its decimals; else the text.

    Example:
        >>> exact_angle("1.5708"), exact_angle("-3.1415"), exact_angle("1.58")
        ('1.5707963267948966', '-3.141592653589793', '1.58')
    """
    number = Decimal(text)
    exponent = number.as_tuple().exponent
    assert isinstance(exponent, int)  # the number is finite
    if abs(number) > 7:
        return text
    for step, decimals in ((math.pi / 2.0, RIGHT_ANGLE_DECIMALS), (math.pi / 12.0, OTHER_ANGLE_DECIMALS)):
        multiple = round(float(number) / step) * step
        if multiple and decimals <= -exponent <= MOST_DECIMALS:
            digit = Decimal(1).scaleb(exponent)
            if number in [Decimal(multiple).quantize(digit, rounding) for rounding in (ROUND_HALF_EVEN, ROUND_DOWN)]:
                return repr(multiple)
    return text


def exact_angles(text: str) -> str:
    """Replace rounded multiples of π/12 in a list of angles, see :func:`exact_angle`.

    Args:
        text: Decimal numbers [rad], separated by spaces.

    Returns:
        The numbers.
    """
    return " ".join(exact_angle(word) for word in text.split())
