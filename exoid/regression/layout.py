"""Parameter layout: which parameters groups of recordings share, and where all of them stand in one vector."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid.errors import ExoidError

from .prior_knowledge import Prior, PriorKnowledge


class ParameterLayout(NamedTuple):
    """β = (shared, own of the first group, own of the second, …); one group without own parameters is the usual case.

    Attributes:
        groups: Names of the groups.
        names: Names of all parameters, (P,); own ones say whose they are, as in ``c0_hip[left]``.
        units: Units of all parameters.
        shared: Number of shared parameters; they are the first.
        own: Names of parameters that every group has of its own, without the group.
        places: Indices of the parameters of each group's model, in the model's order.
    """

    groups: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    shared: int
    own: tuple[str, ...]
    places: tuple[NDArray[np.intp], ...]

    @classmethod
    def of(
        cls, groups: Sequence[str], names: Sequence[str], units: Sequence[str], own: Sequence[str] = ()
    ) -> ParameterLayout:
        """Lay out the parameters of groups whose models have parameters of the same names.

        Args:
            groups: Names of the groups.
            names: Names of one model's parameters.
            units: Units of one model's parameters.
            own: Names of those that each group has of its own.

        Returns:
            The layout.
        """
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

    @property
    def identity(self) -> bool:
        """Whether the one group's parameters are all, in the model's order."""
        return len(self.places) == 1 and np.array_equal(self.places[0], np.arange(len(self.names)))

    def place(self, name: str, group: int) -> int:
        """Index of one of the own parameters of a group."""
        return self.names.index(own_name(name, self.groups[group]))

    def spread(self, knowledge: PriorKnowledge) -> PriorKnowledge:
        """Apply to every group what is known of a parameter without saying whose.

        Raises:
            ExoidError: There is no such parameter, or two things are known of it.
        """
        known = [(name, value) for given, value in knowledge.known.items() for name in self._meant(given)]
        prior = [(name, pair) for given, pair in knowledge.prior.values.items() for name in self._meant(given)]
        names = [name for name, _ in (*known, *prior)]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ExoidError(f"{', '.join(twice)} is known or has a prior twice", remedy="say it once")
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
        raise ExoidError(f"no parameter {given!r}", remedy=f"names are {', '.join((*self.names, *self.own))}")


def own_name(name: str, group: str) -> str:
    """Name of a parameter that says whose it is."""
    return f"{name}[{group}]"
