"""Limb of a wearer within the leg: X, Y, J of the worn machine less those of the machine alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.estimate import EstimateData, compare
from exoid.leg.leg import Leg
from exoid.leg.payload import Payload
from exoid.rig import limb_of
from exoid.tools.json_values import json_value
from exoid.tools.read_only import ReadOnly
from exoid.tools.tables import DataTable, Report, make_table, with_error
from exoid.torques.payloads import payload_parameters

from .cuffs import Cuffs

HEADERS = ("parameter", "limb", "± std", "95 % from", "to", "unit")
"""Columns of :meth:`LimbComparison.rows`; that of expected values follows if there are any."""


@dataclass(frozen=True, eq=False, repr=False)
class LimbComparison(ReadOnly, Report):
    """Rigid-body parameters of a limb within the leg, beside what anthropometry or scales say; prints itself.

    Attributes:
        names: Rigid-body parameters of the leg, (P,).
        units: Their units.
        values: Worn less alone, (P,).
        std: Standard deviations, (P,).
        interval: 95 % intervals, (P, 2).
        expected: Values by anthropometry or of weighed bodies, (P,); not a number where there are none.
        notes: What intervals do not contain.
        cuffs: Cuffs as estimated, or as stated where they are known; None for a body that is fixed to the leg.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: FloatArray
    std: FloatArray
    interval: FloatArray
    expected: FloatArray
    notes: tuple[str, ...] = ()
    cuffs: Cuffs | None = None

    @property
    def inside(self) -> tuple[bool, ...]:
        """Whether each interval contains the expected value, (P,); False where there is none."""
        low, high = self.interval.T
        return tuple(((low <= self.expected) & (self.expected <= high)).tolist())

    def to_json(self) -> dict[str, Any]:
        """Value, standard deviation, interval, unit and expected value of each parameter, by name, for JSON."""
        keys = ("value", "std", "interval", "unit", "expected")
        columns = zip(self.names, self.values, self.std, self.interval, self.units, self.expected, strict=True)
        return {name: json_value(dict(zip(keys, each, strict=True))) for name, *each in columns}

    def __repr__(self) -> str:
        """Write the values."""
        values = ", ".join(f"{name} {value:.3g}" for name, value in zip(self.names, self.values, strict=True))
        return f"LimbComparison({values})"

    def rows(self) -> list[tuple[str, ...]]:
        """Write each parameter as a row of a table."""
        columns = (self.names, self.values, self.std, self.interval, self.units, self.expected)
        without = np.isnan(self.expected).all()
        return [
            (name, *with_error(value, std, low, high), unit, *(() if without else (f"{beside:.4g}",)))
            for name, value, std, (low, high), unit, beside in zip(*columns, strict=True)
        ]

    def _report(self) -> list[DataTable | str]:
        """Title and table."""
        headers = HEADERS if np.isnan(self.expected).all() else (*HEADERS, "expected")
        of_cuffs = ("cuff", "stiffness [N·m/rad]", "± std", "damping [N·m·s/rad]", "± std")
        cuffs = [] if self.cuffs is None else [make_table(of_cuffs, self.cuffs.rows())]
        notes = (f"note: {note}" for note in self.notes)
        return ["Limb within the leg: worn less alone", make_table(headers, self.rows()), *cuffs, *notes]


def limb_parameters(
    leg: Leg, height: float = 1.75, mass: float = 70.0, *, bodies: Sequence[Payload] | None = None
) -> dict[str, float]:
    """Compute what a limb that is fixed to the leg adds to its X, Y and J.

    Thigh, shank and foot are those of :func:`exoid.rig.limb_of` (Winter 2009). Tables differ: de Leva's thigh is 42 %
    heavier.

    Args:
        leg: The leg.
        height: Height of the wearer [m].
        mass: Mass of the wearer [kg].
        bodies: Weighed bodies instead, such as sandbags.

    Returns:
        Change of each rigid-body parameter, by name.

    Raises:
        ExoidError: Height or mass are not those of a person, or the leg has no such joint.

    Example:
        >>> round(limb_parameters(exoid.load_leg("cuhk"), height=1.70, mass=65.0)["X1"], 3)
        2.824
    """
    added = limb_of(leg, height, mass).parameters if bodies is None else payload_parameters(leg, bodies)
    return dict(zip(leg.parameter_names, added.tolist(), strict=True))


def compare_limb(
    alone: EstimateData, worn: EstimateData, expected: Mapping[str, float] | None = None
) -> LimbComparison:
    """Take the rigid-body parameters of a leg alone from those of the leg with a passive limb or sandbags.

    A limb in cuffs is no rigid body: with stiffness k of the cuff and inertia J of the limb it resonates at √(k/J), and
    a motion at ω sees an inertia that is too large by (ω √(J/k))². Gravity
    bends the cuffs too, by X g / k. :func:`.identify_limb` takes both into account.

    Args:
        alone: Estimate of the leg alone.
        worn: Estimate of the leg with the limb.
        expected: Values to compare with, as of :func:`limb_parameters`.

    Returns:
        Differences with 95 % intervals, by :func:`exoid.compare`.

    Raises:
        ExoidError: The estimates have no rigid-body parameter in common, or units differ.
    """
    compared = compare(alone, worn)
    rigid = {*alone.model.leg.parameter_names} & {*compared.names}
    if not rigid:
        raise BadArgumentError(
            f"no rigid-body parameter is in both estimates: {', '.join(compared.names)}",
            remedy="identify the same leg alone and worn",
        )
    places = [k for k, name in enumerate(compared.names) if name in rigid]
    names = tuple(compared.names[k] for k in places)
    beside = np.array([(expected or {}).get(name, np.nan) for name in names], dtype=np.float64)
    units = tuple(compared.units[k] for k in places)
    interval = compared.interval()[places]
    notes = late_torque_notes(alone, worn)
    return LimbComparison(names, units, compared.difference[places], compared.std[places], interval, beside, notes)


def late_torque_notes(*estimates: EstimateData) -> tuple[str, ...]:
    """Say that torques of a log are late, an error of parameters that intervals do not contain."""
    # Half a millisecond is enough, as of a torque that is held over a control period of 1 ms: errors of X and Y of the
    # leg alone are then two to four times their standard deviations.
    findings = [finding for estimate in estimates for finding in estimate.findings]
    late = [each.value for each in findings if each.kind == "torque-delay" and each.severity != "info"]
    if not late:
        return ()
    return (
        f"torques come up to {1e3 * max(late, key=abs):.2g} ms after the motion, an error that the intervals do not "
        'contain: correct the time stamps, or identify with delay="auto"',
    )
