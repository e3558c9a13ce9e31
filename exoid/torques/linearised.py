"""A model that is not linear in its parameters, made linear about a point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg import Leg

from .model import JointTerm, LegMotion, Regrouped, TorqueModel
from .nonlinear import NonlinearSetting, nonlinear_settings, with_settings
from .term import Term

STEP = 1e-4
"""Relative step of differences; columns are smooth in their settings."""

NUDGE = 1e-6
"""Step of the load, as a part of its largest value."""


class Slope(NamedTuple):
    """Derivative of the torque by a setting, as a central difference.

    Attributes:
        value: Of the setting.
        step: Half the difference.
        above: Terms with the setting raised.
        below: The same terms with it lowered.
        values: Parameters of each.
    """

    value: float
    step: float
    above: tuple[JointTerm, ...]
    below: tuple[JointTerm, ...]
    values: tuple[FloatArray, ...]


@dataclass(frozen=True, eq=False)
class Linearised(TorqueModel):
    """τ ≈ J x + rest, x = (β, θ) the parameters and those settings θ of terms that are to be found.

    J holds ∂τ/∂β, to which rigid bodies contribute a second time where friction depends on their torque, and ∂τ/∂θ.
    The regressor has one column more than there are names, the rest, which is known. Where the least-squares solution
    for J is the point itself, it solves the nonlinear problem, with the covariance of Gauss and Newton.

    Attributes:
        point: β where it is linear, (P,).
        slopes: Derivatives by the settings, by name.
        shapes: Settings that are to be found.
        known_regrouped: What is regrouped, which does not depend on the point.
    """

    point: FloatArray = field(kw_only=True)
    slopes: Mapping[str, Slope] = field(kw_only=True)
    nonlinear: tuple[NonlinearSetting, ...] = field(kw_only=True)
    known_regrouped: tuple[Regrouped, ...] = field(kw_only=True)

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters, then settings."""
        return (*super().names, *self.slopes)

    @property
    def units(self) -> tuple[str, ...]:
        """Their units."""
        return (*super().units, *(shape.unit for shape in self.nonlinear))

    @cached_property
    def regrouped(self) -> tuple[Regrouped, ...]:
        """As it is at every point."""
        return self.known_regrouped

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Which parameters and settings can act on which joint, (n, P + S)."""
        acting = super().acting
        for column, slope in enumerate(self.slopes.values(), start=len(self.point)):
            acting[slope.above[0].joint, column] = True
        return acting

    @property
    def _known_columns(self) -> int:
        return 1

    @property
    def _remembering(self) -> tuple[JointTerm, ...]:
        moved = (block for slope in self.slopes.values() for block in (*slope.above, *slope.below))
        return (*self.blocks, *moved)

    @cached_property
    def _values(self) -> dict[str, float]:
        return dict(zip(super().names, self.point.tolist(), strict=True))

    def _fill_terms(self, motion: LegMotion, out: FloatArray, names: tuple[str, ...]) -> None:
        """Columns ∂τ/∂β and ∂τ/∂θ, and the torque that they leave over."""
        super()._fill_terms(motion, out, names)
        rest = out[-1]
        for row, slope in enumerate(self.slopes.values(), start=len(self.point)):
            joint = slope.above[0].joint
            for above, below, values in zip(slope.above, slope.below, slope.values, strict=True):
                difference = _torque(above, motion, values) - _torque(below, motion, values)
                out[row, joint] += difference / (2.0 * slope.step)
            rest[joint] -= slope.value * out[row, joint]
        loaded = [block for block in self.blocks if block.term.loaded]
        if loaded:
            by_load = np.zeros_like(motion.load)
            for block in loaded:
                by_load[block.joint] += self._slope_by_load(block, motion)
            rest -= by_load * motion.load
            out[: len(self.leg.parameter_names)] *= 1.0 + by_load

    def _slope_by_load(self, block: JointTerm, motion: LegMotion) -> FloatArray:
        """∂τ/∂τ_rb of one term, (N,)."""
        values = np.array([self._values.get(name, 0.0) for name in block.names])
        nudge = NUDGE * float(np.abs(motion.load[block.joint]).max())
        if nudge == 0.0:
            return np.zeros(motion.load.shape[1])
        above, below = (_torque(block, motion._replace(load=motion.load + step), values) for step in (nudge, -nudge))
        return (above - below) / (2.0 * nudge)


def linearise(
    leg: Leg,
    terms: Sequence[Term],
    values: FloatArray,
    settings: Mapping[str, float],
    *,
    held: Sequence[str] = (),
    regrouped: tuple[Regrouped, ...] | None = None,
) -> Linearised:
    """Linearise a model about a point.

    Args:
        leg: The leg.
        terms: Terms, of which some settings are :class:`exoid.torques.NonlinearParameter`.
        values: β, (P,).
        settings: θ by name.
        held: Settings that are not to be found after all.
        regrouped: What is regrouped, if that is known already.
    """
    names, labels = leg.joint_names, leg.joint_labels
    centre = TorqueModel(leg, with_settings(terms, names, labels, settings), values[: len(leg.parameter_names)])
    regrouped = centre.regrouped if regrouped is None else regrouped
    gone = {m.name for m in regrouped}
    known = dict(zip((n for n in centre.every_name if n not in gone), values.tolist(), strict=True))
    nonlinear = tuple(shape for shape in nonlinear_settings(terms, names, labels) if shape.name not in held)
    slopes = {}
    for shape in nonlinear:
        value = settings[shape.name]
        above, below = (
            TorqueModel(leg, with_settings(terms, names, labels, {**settings, shape.name: value * factor})).blocks
            for factor in (1.0 + STEP, 1.0 - STEP)
        )
        moved = [k for k, block in enumerate(above) if block.term != centre.blocks[k].term]
        parameters = tuple(np.array([known.get(name, 0.0) for name in above[k].names]) for k in moved)
        slopes[shape.name] = Slope(
            value, STEP * value, tuple(above[k] for k in moved), tuple(below[k] for k in moved), parameters
        )
    return Linearised(
        leg, centre.terms, centre.rigid, point=values, slopes=slopes, nonlinear=nonlinear, known_regrouped=regrouped
    )


def _torque(block: JointTerm, motion: LegMotion, values: FloatArray) -> FloatArray:
    """Torque of one term, (N,)."""
    columns = np.zeros((len(values), motion.q.shape[1]))
    block.term.fill(motion.of(block), columns)
    return values @ columns
