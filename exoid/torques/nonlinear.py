"""Settings of terms that are to be found by the fit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import NamedTuple

from exoid.errors import ExoidError

from .term import Term


@dataclass(frozen=True)
class NonlinearParameter:
    """Setting of a term that the fit finds, in place of its number.

    ``Stribeck(velocity=NonlinearParameter(0.1, 0.01, 1.0))`` searches between 0.01 and 1 rad/s.

    Attributes:
        start: Where to begin.
        lower: Smallest value, above zero.
        upper: Largest value.
    """

    start: float
    lower: float
    upper: float

    def __post_init__(self) -> None:
        """Check the order."""
        if not 0.0 < self.lower <= self.start <= self.upper < math.inf or self.lower == self.upper:
            raise ExoidError(
                f"NonlinearParameter(start={self.start}, lower={self.lower}, upper={self.upper})",
                remedy="0 < lower ≤ start ≤ upper, and lower < upper",
            )


def number(value: float | NonlinearParameter) -> float:
    """Return the number of a setting.

    Raises:
        ExoidError: It is still to be found.
    """
    if isinstance(value, NonlinearParameter):
        raise ExoidError(f"a setting is {value}, not yet a number", remedy="identify, which finds it")
    return value


class NonlinearSetting(NamedTuple):
    """A setting to be found, at one joint.

    Attributes:
        name: Symbol and joint, such as delta_knee. Terms at one joint whose settings have one symbol share it.
        unit: Its unit.
        free: Start and bounds.
    """

    name: str
    unit: str
    free: NonlinearParameter


def nonlinear_settings(
    terms: Sequence[Term], names: Sequence[str], labels: Sequence[str]
) -> tuple[NonlinearSetting, ...]:
    """List the settings to be found, each once.

    Args:
        terms: The terms.
        names: Joints of the leg.
        labels: What parameters call them.

    Raises:
        ExoidError: Two terms share a setting at a joint but not its start and bounds.
    """
    found: dict[str, NonlinearSetting] = {}
    for term in terms:
        for _, symbol, unit, free in _free_settings(term):
            for joint in term.joint_indices(names, labels):
                shape = NonlinearSetting(f"{symbol}_{labels[joint]}", unit, free)
                if found.setdefault(shape.name, shape) != shape:
                    raise ExoidError(
                        f"{shape.name} is {found[shape.name].free} in one term and {free} in another",
                        remedy="it is one quantity: give both the same start and bounds",
                    )
    return tuple(found.values())


def with_settings(
    terms: Sequence[Term], names: Sequence[str], labels: Sequence[str], values: Mapping[str, float]
) -> tuple[Term, ...]:
    """Put numbers in place of :class:`NonlinearParameter`; a term that has some becomes one for each joint.

    Args:
        terms: The terms.
        names: Joints of the leg.
        labels: What parameters call them.
        values: Value of each shape by name.
    """
    settled: list[Term] = []
    for term in terms:
        settings = list(_free_settings(term))
        if not settings:
            settled.append(term)
            continue
        for joint in term.joint_indices(names, labels):
            found = {field: values[f"{symbol}_{labels[joint]}"] for field, symbol, _, _ in settings}
            settled.append(replace(term, joints=(names[joint],), **found))
    return tuple(settled)


def _free_settings(term: Term) -> Iterator[tuple[str, str, str, NonlinearParameter]]:
    """Field, symbol, unit and bounds of what is free in a term."""
    for field in fields(term):
        value = getattr(term, field.name)
        if isinstance(value, NonlinearParameter):
            if field.name not in term.shape_symbols:
                raise ExoidError(
                    f"{type(term).__name__}({field.name}={value}): the term has no symbol for this setting",
                    remedy="give a number, or let shape_symbols of the term name symbol and unit of the setting",
                )
            yield (field.name, *term.shape_symbols[field.name], value)
