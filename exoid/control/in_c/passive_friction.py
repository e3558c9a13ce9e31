"""Friction compensation that never drives, in C."""

from __future__ import annotations

from exoid.control.friction import FrictionCompensation
from exoid.control.passive_friction import PassiveFriction


def friction_of(friction: PassiveFriction | None) -> FrictionCompensation | None:
    """Make the compensation before it is cut off where it would drive."""
    return None if friction is None else FrictionCompensation("measured", friction.width, friction.share)


def passive(friction: PassiveFriction | None, velocity: str) -> str:
    """Write the statements that compensate friction."""
    if friction is None:
        return "    for (j = 0; j < {{N}}; ++j) {\n        friction[j] = {{number(0)}};\n    }"
    return (
        f"    {{{{p}}}}_friction({velocity}, friction);\n"
        "    for (j = 0; j < {{N}}; ++j) { /* never drives */\n"
        f"        friction[j] = friction[j] * {velocity}[j] > {{{{number(0)}}}} ? friction[j] : {{{{number(0)}}}};\n"
        "    }"
    )


def passive_in_words(friction: PassiveFriction | None, velocity: str) -> str:
    """Write the friction compensation for an equation in a comment."""
    return "" if friction is None else f" + {friction.share:g} F({velocity}), never driving"
