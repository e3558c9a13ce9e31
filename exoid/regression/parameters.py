"""Parameters: what is known of them beside the recordings, and where those of several groups stand in one vector."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError

from .model import RegressorModel, Regrouping

SMALL = 0.1
"""Values below this part of the largest of their unit share its uncertainty in :meth:`Prior.from_leg`."""


class HasParameters(Protocol):
    """Named values with units, such as those of :class:`exoid.Leg`."""

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names, (p,)."""

    @property
    def parameter_units(self) -> tuple[str, ...]:
        """Units, (p,)."""

    @property
    def parameters(self) -> FloatArray:
        """Values, (p,)."""


@dataclass(frozen=True)
class Prior:
    """Values that parameters are believed to have, and standard deviations: measurements of another kind.

    Attributes:
        values: Value and standard deviation by name.

    Example:
        >>> prior = Prior({"J3": (0.05, 0.01)})
    """

    values: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check that values are numbers and standard deviations positive."""
        try:
            pairs = {str(name): (float(value), float(std)) for name, (value, std) in self.values.items()}
        except (TypeError, ValueError, AttributeError) as error:
            raise BadArgumentError(
                f"a prior needs a value and a standard deviation ({error})", remedy='write {"J3": (0.05, 0.01)}'
            ) from error
        wrong = [name for name, (value, std) in pairs.items() if not (np.isfinite(value) and 0.0 < std < np.inf)]
        if wrong:
            what = f"the prior of {', '.join(wrong)} is not a finite value with a positive standard deviation"
            raise BadArgumentError(what, remedy="pass what is exact as known=")
        object.__setattr__(self, "values", MappingProxyType(pairs))

    @classmethod
    def from_leg(cls, leg: HasParameters, relative_std: float = 0.2) -> Prior:
        """Take a leg's own parameters, such as those of its CAD, for right to so many parts.

        A value near zero, as Y of a symmetric segment, has a tenth of the uncertainty of the largest of its unit.

        Args:
            leg: The leg with the values that are believed.
            relative_std: Standard deviation over value.

        Returns:
            The prior.
        """
        units, sizes = np.array(leg.parameter_units), np.abs(leg.parameters)
        pairs = {}
        for name, unit, value in zip(leg.parameter_names, units, leg.parameters, strict=True):
            size = max(abs(value), SMALL * float(sizes[units == unit].max()))
            pairs[name] = (float(value), relative_std * size)
        return cls(pairs)


@dataclass(frozen=True)
class PriorKnowledge:
    """All that enters an identification beside recordings; arrays follow the model's parameters."""

    known: Mapping[str, float] = field(default_factory=dict)  # values of parameters that are held fixed
    prior: Prior = field(default_factory=Prior)  # values that others are believed to have
    nonnegative: bool = False  # whether friction and rotor inertia are kept from falling below zero

    def __post_init__(self) -> None:
        """Check that what is known is a number."""
        try:
            known = {str(name): float(value) for name, value in self.known.items()}
        except (TypeError, ValueError, AttributeError) as error:
            raise BadArgumentError(
                f"a known parameter needs a number ({error})", remedy='write {"X1": 4.25}'
            ) from error
        wrong = [name for name, value in known.items() if not np.isfinite(value)]
        if wrong:
            raise BadArgumentError(f"the known {', '.join(wrong)} is not finite", remedy="pass a number")
        both = [name for name in known if name in self.prior.values]
        if both:
            raise BadArgumentError(f"{', '.join(both)} is known and has a prior", remedy="use one of the two")
        object.__setattr__(self, "known", MappingProxyType(known))

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters that something is known of beside the recordings."""
        return (*self.known, *self.prior.values)

    def check(self, model: RegressorModel) -> None:
        """Check that all names are those of a model."""
        self.check_regrouped(model.regrouped)
        for name in self.names:
            if name not in model.names:
                raise BadArgumentError(f"no parameter {name!r}", remedy=f"names are {', '.join(model.names)}")

    def check_regrouped(self, parameters: Sequence[Regrouping]) -> None:
        """Check that no name is that of a parameter that is part of others."""
        for regrouped in parameters:
            if regrouped.name in self.names:
                into = " and ".join(regrouped.into)
                raise BadArgumentError(f"{regrouped}", remedy=f"say what is known of {into} instead")

    def fixed_values(self, names: Sequence[str]) -> FloatArray:
        """Known values, not a number for parameters that are free, (P,)."""
        return np.array([self.known.get(name, np.nan) for name in names])

    def pseudo_rows(self, names: Sequence[str]) -> FloatArray:
        """Rows (1/σ) β = p/σ of the priors, as [W τ] of unit variance, (K, P + 1)."""
        rows = np.zeros((len(self.prior.values), len(names) + 1))
        for row, (name, (value, std)) in zip(rows, self.prior.values.items(), strict=True):
            row[list(names).index(name)], row[-1] = 1.0 / std, value / std
        return rows


NO_PRIOR_KNOWLEDGE = PriorKnowledge()
"""The recordings speak for themselves."""


class ParameterLayout(NamedTuple):
    """β = (shared, own of the first group, own of the second, …); usually one group without own parameters."""

    groups: tuple[str, ...]  # names of the groups
    names: tuple[str, ...]  # names of all parameters, (P,); own ones say whose they are, as in `c0_hip[left]`
    units: tuple[str, ...]  # units of all parameters
    shared: int  # number of shared parameters; they are the first
    own: tuple[str, ...]  # names of parameters that every group has of its own, without the group
    places: tuple[NDArray[np.intp], ...]  # indices of the parameters of each group's model, in the model's order

    @classmethod
    def of(
        cls, groups: Sequence[str], names: Sequence[str], units: Sequence[str], own: Sequence[str] = ()
    ) -> ParameterLayout:
        """Lay out the parameters of groups whose models have parameters of the same names."""
        named = dict(zip(names, units, strict=True))
        places = {name: k for k, name in enumerate(name for name in names if name not in own)}
        shared, own_names = len(places), tuple(name for name in names if name in own)
        every = (*places, *(own_name(name, group) for group in groups for name in own_names))
        every_unit = (*(named[name] for name in places), *(named[name] for _ in groups for name in own_names))
        of_groups = []
        for k in range(len(groups)):
            places |= {name: shared + k * len(own_names) + i for i, name in enumerate(own_names)}
            of_groups.append(np.array([places[name] for name in names], dtype=np.intp))
        return cls(tuple(groups), every, every_unit, shared, own_names, tuple(of_groups))

    def place(self, name: str, group: int) -> int:
        """Index of one of the own parameters of a group."""
        return self.names.index(own_name(name, self.groups[group]))

    def spread(self, knowledge: PriorKnowledge) -> PriorKnowledge:
        """Apply to every group what is known of a parameter without saying whose."""
        known = [(name, value) for given, value in knowledge.known.items() for name in self._meant(given)]
        prior = [(name, pair) for given, pair in knowledge.prior.values.items() for name in self._meant(given)]
        names = [name for name, _ in (*known, *prior)]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise BadArgumentError(f"{', '.join(twice)} is known or has a prior twice", remedy="say it once")
        return PriorKnowledge(dict(known), Prior(dict(prior)), knowledge.nonnegative)

    def known_by(self, group: int, spread: PriorKnowledge) -> PriorKnowledge:
        """Select what is known of the parameters of one group, by the names that they have there."""
        names = self.names_of(group)
        known = {names[name]: value for name, value in spread.known.items() if name in names}
        prior = {names[name]: pair for name, pair in spread.prior.values.items() if name in names}
        return PriorKnowledge(known, Prior(prior), spread.nonnegative)

    def names_of(self, group: int) -> dict[str, str]:
        """Names in the model of one group, by those here."""
        own = {own_name(name, self.groups[group]): name for name in self.own}
        return {**{name: name for name in self.names[: self.shared]}, **own}

    def _meant(self, given: str) -> list[str]:
        """Parameters that a name stands for."""
        if given in self.own:
            return [own_name(given, group) for group in self.groups]
        if given in self.names:
            return [given]
        raise BadArgumentError(f"no parameter {given!r}", remedy=f"names are {', '.join((*self.names, *self.own))}")


def own_name(name: str, group: str) -> str:
    """Name of a parameter that says whose it is."""
    return f"{name}[{group}]"
