"""Angles that a URDF gives in few digits, such as 1.5708 for π/2.

Few digits turn parallel joint axes into nearly parallel ones. Such axes let parameters act on the torques that do not
act on those of the robot, a millionth as much as the others, and no recording determines them.
"""

from __future__ import annotations

import math
from decimal import ROUND_DOWN, ROUND_HALF_EVEN, Decimal


def exact_angle(text: str) -> str:
    """Replace a rounded multiple of π/12 by the exact one."""
    number = Decimal(text)
    exponent = number.as_tuple().exponent
    assert isinstance(exponent, int)  # the number is finite
    if abs(number) > 7:
        return text
    # Decimals from which on a number that is a rounded multiple of π/2 stands for it: 1.57
    # Decimals from which on a number that is a rounded multiple of π/12 stands for it: 0.5236
    for step, decimals in ((math.pi / 2.0, 2), (math.pi / 12.0, 4)):
        multiple = round(float(number) / step) * step
        # Decimals beyond which rounding has no effect: the number stays as it is
        if multiple and decimals <= -exponent <= 10:
            digit = Decimal(1).scaleb(exponent)
            if number in [Decimal(multiple).quantize(digit, rounding) for rounding in (ROUND_HALF_EVEN, ROUND_DOWN)]:
                return repr(multiple)
    return text


def exact_angles(text: str) -> str:
    """Replace rounded multiples of π/12 in a list of angles, see :func:`exact_angle`."""
    return " ".join(exact_angle(word) for word in text.split())
