"""Linearisation of a torque model that is not linear in its parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.leg import Leg

from .model import TorqueModel
from .motion import LoadedMotion
from .nonlinear import NonlinearSetting, nonlinear_settings, with_settings
from .regrouping import Regrouped, regroup
from .term import Term, TermBlock, term_blocks

STEP = 1e-4
"""Relative step of the differences by a setting."""


class Slope(NamedTuple):
    """Derivative of the torque by a setting, as a central difference."""

    value: float  # value of the setting
    step: float  # half the difference
    above: tuple[TermBlock, ...]  # terms with the setting raised
    below: tuple[TermBlock, ...]  # the same terms with the setting lowered
    values: tuple[FloatArray, ...]  # parameters of each of these terms


@dataclass(frozen=True, eq=False, repr=False)
class Linearised(TorqueModel):
    """τ ≈ J x + rest, with x = (β, θ) the parameters and the nonlinear settings θ of terms."""

    # J holds ∂τ/∂β and ∂τ/∂θ. Rigid bodies contribute to ∂τ/∂β a second time where friction depends on their
    # torque. The regressor has one column more than there are names: the rest, which is known. Where the
    # least-squares solution for J is the point itself, it solves the nonlinear problem with the covariance of
    # the Gauss-Newton method.

    point: FloatArray = field(kw_only=True)  # β at which the model is linearised, (P,)
    slopes: Mapping[str, Slope] = field(kw_only=True)  # derivatives by the settings, by name
    nonlinear: tuple[NonlinearSetting, ...] = field(kw_only=True)  # nonlinear settings that are fitted

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, then of the settings, (P + S,)."""
        return (*super().names, *self.slopes)

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the parameters and of the settings, (P + S,)."""
        return (*super().units, *(setting.unit for setting in self.nonlinear))

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Which parameters and settings can act on which joint, (n, P + S)."""
        acting = super().acting
        for column, slope in enumerate(self.slopes.values(), start=len(self.point)):
            acting[list(slope.above[0].joints), column] = True
        return acting

    @property
    def _known_columns(self) -> int:
        return 1

    @property
    def _stateful(self) -> tuple[TermBlock, ...]:
        moved = (block for slope in self.slopes.values() for block in (*slope.above, *slope.below))
        return (*self.blocks, *moved)

    @cached_property
    def _values(self) -> dict[str, float]:
        return dict(zip(super().names, self.point.tolist(), strict=True))

    def _fill_terms(self, motion: LoadedMotion, out: FloatArray) -> None:
        """Write the columns ∂τ/∂β and ∂τ/∂θ, and the rest of the torque."""
        super()._fill_terms(motion, out)
        rest = out[-1]
        for row, slope in enumerate(self.slopes.values(), start=len(self.point)):
            joints = list(slope.above[0].joints)
            for above, below, values in zip(slope.above, slope.below, slope.values, strict=True):
                difference = _torque(above, motion, values) - _torque(below, motion, values)
                out[row, joints] += difference / (2.0 * slope.step)
            rest[joints] -= slope.value * out[row, joints]
        loaded = [block for block in self.blocks if block.term.loaded]
        if loaded:
            by_load = np.zeros_like(motion.load)
            for block in loaded:
                by_load[block.joints[0]] += self._slope_by_load(block, motion)
            rest -= by_load * (motion.load - motion.payload)
            out[: len(self.leg.parameter_names)] *= 1.0 + by_load

    def _slope_by_load(self, block: TermBlock, motion: LoadedMotion) -> FloatArray:
        """∂τ/∂τ_rb of one term, (N,)."""
        values = np.array([self._values.get(name, 0.0) for name in block.names])
        # Step of the differences by the load, relative to its largest value
        step = 1e-6 * float(np.abs(motion.load[block.joints[0]]).max())
        if step == 0.0:
            return np.zeros(motion.load.shape[1])
        above, below = (_torque(block, motion._replace(load=motion.load + each), values) for each in (step, -step))
        return np.asarray((above - below)[0] / (2.0 * step))


def linearise(
    leg: Leg,
    terms: Sequence[Term],
    values: FloatArray,
    settings: Mapping[str, float],
    *,
    held: Sequence[str] = (),
    regrouped: tuple[Regrouped, ...] | None = None,
) -> Linearised:
    """Linearise a model about a point."""
    names, labels = leg.joint_names, leg.joint_labels

    def blocks_at(settings: Mapping[str, float]) -> tuple[TermBlock, ...]:
        """Blocks of the terms with these settings."""
        return term_blocks(leg, with_settings(terms, names, labels, settings))

    rigid = values[: len(leg.parameter_names)]
    blocks = blocks_at(settings)
    if regrouped is None:
        regrouped = regroup(leg, blocks, rigid)
    gone = {one.name for one in regrouped}
    every = (*leg.parameter_names, *(name for block in blocks for name in block.names))
    known = dict(zip((name for name in every if name not in gone), values.tolist(), strict=True))
    nonlinear = tuple(each for each in nonlinear_settings(terms, names, labels) if each.name not in held)
    slopes = {}
    for setting in nonlinear:
        value = settings[setting.name]
        above, below = (blocks_at({**settings, setting.name: value * factor}) for factor in (1.0 + STEP, 1.0 - STEP))
        moved = [k for k, block in enumerate(above) if block.term != blocks[k].term]
        parameters = tuple(np.array([known.get(name, 0.0) for name in above[k].names]) for k in moved)
        slopes[setting.name] = Slope(
            value, STEP * value, tuple(above[k] for k in moved), tuple(below[k] for k in moved), parameters
        )
    settled = with_settings(terms, names, labels, settings)
    return Linearised(leg, settled, rigid, regrouped, point=values, slopes=slopes, nonlinear=nonlinear)


def _torque(block: TermBlock, motion: LoadedMotion, values: FloatArray) -> FloatArray:
    """Torque of one term at its m joints [N·m], (m, N)."""
    return np.asarray(np.tensordot(values, block.columns(motion), axes=1))
