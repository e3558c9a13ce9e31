"""Nonlinear parameters: settings of terms that the fit finds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from typing import NamedTuple

from exoid.errors import BadArgumentError

from .term import NonlinearParameter, Term


class NonlinearSetting(NamedTuple):
    """Nonlinear setting at one joint, or at the joints that a term couples."""

    # symbol and joint, such as delta_knee or slack_hip_knee. Terms of one joint share settings with the same
    # symbol
    name: str
    unit: str  # unit of the setting
    free: NonlinearParameter  # start and bounds


def nonlinear_settings(
    terms: Sequence[Term], names: Sequence[str], labels: Sequence[str]
) -> tuple[NonlinearSetting, ...]:
    """List the settings that the fit has to find, each once."""
    found: dict[str, NonlinearSetting] = {}
    for term in terms:
        for _, symbol, unit, free in _free_settings(term):
            for joints in term.places(names, labels):
                setting = NonlinearSetting(f"{symbol}_{term.label(joints, labels)}", unit, free)
                if found.setdefault(setting.name, setting) != setting:
                    raise BadArgumentError(
                        f"{setting.name} is {found[setting.name].free} in one term and {free} in another",
                        remedy="it is one quantity: give both the same start and bounds",
                    )
    return tuple(found.values())


def with_settings(
    terms: Sequence[Term], names: Sequence[str], labels: Sequence[str], values: Mapping[str, float]
) -> tuple[Term, ...]:
    """Replace each :class:`NonlinearParameter` by a value."""
    # A term that has nonlinear parameters becomes one term for each joint, or for the joints that it couples.
    settled: list[Term] = []
    for term in terms:
        settings = list(_free_settings(term))
        if not settings:
            settled.append(term)
            continue
        for joints in term.places(names, labels):
            label = term.label(joints, labels)
            found = {field: values[f"{symbol}_{label}"] for field, symbol, _, _ in settings}
            settled.append(replace(term, joints=tuple(names[joint] for joint in joints), **found))
    return tuple(settled)


def _free_settings(term: Term) -> Iterator[tuple[str, str, str, NonlinearParameter]]:
    """Field, symbol, unit, and start and bounds of each nonlinear parameter of a term."""
    for field in fields(term):
        value = getattr(term, field.name)
        if isinstance(value, NonlinearParameter):
            if field.name not in term.nonlinear_symbols:
                raise BadArgumentError(
                    f"{type(term).__name__}({field.name}={value}): the term has no symbol for this setting",
                    remedy="give a number, or let nonlinear_symbols of the term name symbol and unit of the setting",
                )
            yield (field.name, *term.nonlinear_symbols[field.name], value)
