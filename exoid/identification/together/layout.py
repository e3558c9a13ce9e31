"""Which parameters groups of recordings share, and where all of them stand in one vector."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid.errors import ExoidError
from exoid.regression.prior_knowledge import Assumed, Prior
from exoid.torques import TorqueModel


class Layout(NamedTuple):
    """β = (shared, own of the first group, own of the second, …).

    Attributes:
        groups: Their names.
        names: Of all parameters; own ones say whose they are, as in ``c0_hip[left]``, (P,).
        units: Their units.
        shared: How many are shared; they are the first.
        own: Names of parameters that every group has of its own, without the group.
        places: Where the parameters of each group's model stand, in the model's order.
    """

    groups: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    shared: int
    own: tuple[str, ...]
    places: tuple[NDArray[np.intp], ...]

    @staticmethod
    def of(models: Mapping[str, TorqueModel], own: Sequence[str] | None) -> Layout:
        """Lay out the parameters of groups whose models have parameters of the same names.

        Args:
            models: One for each group.
            own: Symbols such as "c0", or names such as "c0_hip" or "J1"; None for all but those of the rigid bodies.

        Raises:
            ExoidError: Names of the groups' parameters differ, or there is no such symbol or name.
        """
        model = next(iter(models.values()))
        _refuse_other_names(models)
        own_names = _own_names(model, own)
        groups, named = tuple(models), dict(zip(model.names, model.units, strict=True))
        places = {name: k for k, name in enumerate(name for name in model.names if name not in own_names)}
        shared = len(places)
        names = (*places, *(own_name(name, group) for group in groups for name in own_names))
        units = (*(named[name] for name in places), *(named[name] for _ in groups for name in own_names))
        of_groups = []
        for k in range(len(groups)):
            places |= {name: shared + k * len(own_names) + i for i, name in enumerate(own_names)}
            of_groups.append(np.array([places[name] for name in model.names], dtype=np.intp))
        return Layout(groups, names, units, shared, own_names, tuple(of_groups))

    def place(self, name: str, group: int) -> int:
        """Place of one of the own parameters of a group."""
        return self.names.index(own_name(name, self.groups[group]))

    def spread(self, assumed: Assumed) -> Assumed:
        """Say of every group what is assumed of a parameter without saying whose.

        Raises:
            ExoidError: There is no such parameter, or it is assumed twice.
        """
        known = [(name, value) for given, value in assumed.known.items() for name in self._meant(given)]
        prior = [(name, pair) for given, pair in assumed.prior.values.items() for name in self._meant(given)]
        names = [name for name, _ in (*known, *prior)]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ExoidError(f"{', '.join(twice)} is known or has a prior twice", remedy="say it once")
        return Assumed(dict(known), Prior(dict(prior)), assumed.nonnegative)

    def assumed_by(self, group: int, spread: Assumed) -> Assumed:
        """Say what is assumed of the parameters of one group, by the names that they have there."""
        names = self.names_of(group)
        known = {names[name]: value for name, value in spread.known.items() if name in names}
        prior = {names[name]: pair for name, pair in spread.prior.values.items() if name in names}
        return Assumed(known, Prior(prior), spread.nonnegative)

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


def _own_names(model: TorqueModel, own: Sequence[str] | None) -> tuple[str, ...]:
    """Names of the parameters that were asked for, in the model's order."""
    rigid = model.leg.parameter_names
    if own is None:
        return tuple(name for name in model.names if name not in rigid)
    asked = (own,) if isinstance(own, str) else tuple(own)
    symbols: dict[str, set[str]] = {}
    for block in model.blocks:
        for symbol, name in zip(block.term.symbols, block.names, strict=True):
            symbols.setdefault(symbol, set()).add(name)
    for name in asked:
        if name not in symbols and name not in model.every_name:
            known = ", ".join((*symbols, *model.every_name))
            raise ExoidError(f"no parameter {name!r} to be each group's own", remedy=f"name some of {known}")
    for merged in model.merged:
        if merged.name in asked:
            raise ExoidError(f"{merged}", remedy=f"name {' and '.join(merged.into)} as own instead")
    wanted = {name for given in asked for name in symbols.get(given, {given})}
    return tuple(name for name in model.names if name in wanted)


def _refuse_other_names(models: Mapping[str, TorqueModel]) -> None:
    """Refuse groups whose models do not have the same parameters."""
    (first, model), *others = models.items()
    for group, other in others:
        if other.names != model.names or other.units != model.units:
            raise ExoidError(
                f"parameters of {first} are {', '.join(model.names)}, those of {group} {', '.join(other.names)}",
                remedy="identify legs of one design, with the same joints, together",
            )
