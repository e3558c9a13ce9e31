"""Whether groups have the same value of a parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.parameters import ParameterLayout

from .comparison import holm, hotelling


class Equality(NamedTuple):
    """Wald test of each parameter: is it the same in all groups?"""

    names: tuple[str, ...]  # the parameters
    p_values: FloatArray  # probability of larger differences if it were, (P,)
    adjusted: FloatArray  # p-values adjusted for the number of tests (Holm), (P,)

    def below(self, level: float) -> tuple[str, ...]:
        """Parameters that differ, if in so many of all comparisons of equal groups any may be said to."""
        return tuple(name for name, p in zip(self.names, self.adjusted, strict=True) if p < level)


def equality_of(
    places: Mapping[str, Sequence[int]], values: FloatArray, covariance: FloatArray, dof: FloatArray
) -> Equality:
    """Compare the values that groups found for each of some parameters."""
    # With d the differences to the first group, and C their covariance, dᵀ C⁻¹ d is Hotelling's T², with the smallest
    # degrees of freedom of the groups.
    p_values = np.ones(len(places))
    for k, several in enumerate(places.values()):
        contrast = np.column_stack([-np.ones(len(several) - 1), np.eye(len(several) - 1)])
        difference = contrast @ values[several]
        spread = contrast @ covariance[np.ix_(several, several)] @ contrast.T
        p_values[k] = hotelling(difference, spread, float(dof[several].min()))[1] if spread.any() else 1.0
    return Equality(tuple(places), p_values, holm(p_values))


def own_equality(layout: ParameterLayout, values: FloatArray, covariance: FloatArray, dofs: FloatArray) -> Equality:
    """Test whether own parameters are the same in all groups, with their joint covariance."""
    groups = range(len(layout.groups))
    places = {name: [layout.place(name, group) for group in groups] for name in layout.own}
    return equality_of(places, values, covariance, dofs)
