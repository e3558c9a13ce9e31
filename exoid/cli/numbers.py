"""Texts of the command line as names, numbers, and values by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from exoid.errors import BadArgumentError

if TYPE_CHECKING:
    from exoid._typing import FloatArray

Value = TypeVar("Value")


def split_names(text: str | None) -> tuple[str, ...] | None:
    """Turn "hip,knee" into names."""
    return None if text is None else tuple(name.strip() for name in text.split(","))


def parse_numbers(text: str | None, option: str) -> tuple[float, ...] | None:
    """Turn "0.3,0.2" into numbers."""
    if text is None:
        return None
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise BadArgumentError(f"{option} {text}", remedy="write numbers, separated by commas, e.g. 0.3,0.2") from None


def joint_values(text: str, option: str, joints: Sequence[str]) -> FloatArray:
    """Turn "22,55" into one number for each joint; one number stands for all."""
    import numpy as np  # noqa: PLC0415 - help needs no arrays

    values = np.array(parse_numbers(text, option))
    if len(values) not in (1, len(joints)) or not np.isfinite(values).all():
        each = f"give one number for each of {', '.join(joints)}: A,B,…, or one for all"
        raise BadArgumentError(f"{option} {text}", remedy=each)
    return np.broadcast_to(values, (len(joints),)).copy()


def parse_gains(
    kp: str | None, kd: str | None, joints: Sequence[str], default: tuple[FloatArray, FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Parse Kp [N·m/rad] and Kd [N·m·s/rad]; beside a given Kp the default of Kd is 0.1 s · Kp."""
    stiffness, damping = default
    if kp is not None:
        stiffness = joint_values(kp, "--kp", joints)
        damping = 0.1 * stiffness
    return stiffness, damping if kd is None else joint_values(kd, "--kd", joints)


def values_by_name(
    pairs: Sequence[str] | None, option: str, parse: Callable[[str], Value], form: str
) -> dict[str, Value]:
    """Turn "NAME=TEXT" into what ``parse`` makes of each text by name; ``form`` says what to write."""
    found: dict[str, Value] = {}
    for pair in pairs or ():
        name, _, text = (part.strip() for part in pair.partition("="))
        if name in found:
            raise BadArgumentError(f"{option} gives {name} twice", remedy="give each once", parameters=(name,))
        try:
            if not name or not text:
                raise ValueError
            found[name] = parse(text)
        except ValueError:
            raise BadArgumentError(f"{option} {pair}", remedy=f"write {form}") from None
    return found


def parse_known(pairs: Sequence[str] | None) -> dict[str, float]:
    """Turn "X1=4.25" into a value by name."""
    return values_by_name(pairs, "--known", float, "numbers, such as --known X1=4.25")


def parse_prior(pairs: Sequence[str] | None) -> dict[str, tuple[float, float]]:
    """Turn "J3=0.05:0.01" or "J3=0.05±0.01" into a value and its standard deviation by name."""

    def two(text: str) -> tuple[float, float]:
        value, _, std = text.replace("±", ":").partition(":")
        return float(value), float(std)

    return values_by_name(pairs, "--prior", two, "numbers, such as --prior J3=0.05:0.01")


def parse_contacts(pairs: Sequence[str] | None) -> dict[str, Any]:
    """Turn "LF_FOOT=point" into a kind by link, "LF_FOOT=0.02" into a radius, "foot_heel=-0.1,0,-0.1" into a place."""

    def kind(text: str) -> str | float | tuple[float, ...]:
        """Kind of a contact, its radius, or its place."""
        numbers = () if text.isalpha() else tuple(map(float, text.split(",")))
        return text if not numbers else numbers[0] if len(numbers) == 1 else numbers

    form = "LINK=KIND, LINK=RADIUS or FOOT_heel=X,Y,Z, e.g. --contact LF_FOOT=point or --contact foot_toe=0.1,0,-0.1"
    return values_by_name(pairs, "--contact", kind, form)


def parse_roles(pairs: Sequence[str] | None) -> dict[str, str]:
    """Turn "HFE=hip" into a role by joint."""
    return values_by_name(pairs, "--role", str, "JOINT=ROLE, e.g. --role HFE=hip --role KFE=knee")
