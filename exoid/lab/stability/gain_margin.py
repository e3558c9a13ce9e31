"""Gain margins of a sampled controller: eigenvalues of the linearised leg with a hold and a delay."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from exoid._typing import ArrayLike, FloatArray
from exoid.control.law import AnyLaw, refuse_rate
from exoid.control.lqr import discretise, linearise
from exoid.control.model import ControlModel
from exoid.rig import Plant
from exoid.tools.json_values import attributes
from exoid.tools.tables import make_table, to_text
from exoid.view.colours import GUIDE, SHADES
from exoid.view.style import decorate

from .worn.linear_law import linear_law, loop_matrices
from .worn.worn_leg import HeldLeg

SCALES = np.geomspace(1e-2, 1e4, 121)
"""Scales of the gains among which the search finds the first unstable one."""

LawOf = Callable[[float, float], AnyLaw]
"""Function that makes a controller from a scale of the gains and a rate [Hz]."""


@dataclass(frozen=True, eq=False, repr=False)
class GainMargins:
    """Factors by which the gains may grow before the sampled loop becomes unstable; prints itself."""

    rates: tuple[float, ...]  # sampling rates [Hz], (R,)
    delays: tuple[int, ...]  # delays in sampling periods, (D,)
    margins: FloatArray  # largest stable scale of the gains, (R, D); 0 if none is stable, inf if all scales tried are

    def __repr__(self) -> str:
        """Name the rates."""
        return f"GainMargins({self.rates[0]:g} to {self.rates[-1]:g} Hz)"

    def __str__(self) -> str:
        """Print as a table."""
        headers = ("rate [Hz]", *(f"gains × (delay {delay})" for delay in self.delays))
        rows = [(f"{r:g}", *(f"{m:.3g}" for m in row)) for r, row in zip(self.rates, self.margins, strict=True)]
        return to_text(make_table(headers, rows), "Linearised without Coulomb friction; delay in sampling periods.")

    def to_json(self) -> dict[str, Any]:
        """Convert to JSON types."""
        return {"rates_hz": list(self.rates), **attributes(self, "delays", "margins")}


def gain_margins(
    plant: Plant,
    law: LawOf,
    q: ArrayLike,
    *,
    rates: Sequence[float] = (10.0, 20.0, 30.0, 50.0, 100.0, 200.0, 500.0, 1000.0),
    delays: Sequence[int] = (0, 1),
) -> GainMargins:
    """Find the largest gains at which a leg is stable about a pose, for each rate and delay.

    Coulomb friction of the leg and its compensation are left out: friction hides small oscillations and does not stop
    large ones.

    Args:
        plant: The true leg, one rig.
        law: Function that makes the controller from a scale of the gains and a rate.
        q: Pose, which is also the target [rad], (n,).
        rates: Sampling rates [Hz].
        delays: Delays of the readings, in sampling periods.

    Returns:
        Margins by rate and delay.

    Raises:
        ExoidError: A rate or delay is invalid, or the controller has no derivatives.

    Example:
        >>> from exoid.control import pd
        >>> from exoid.rig import Plant
        >>> plant = Plant.build(exoid.load_leg("cuhk"))
        >>> def law(scale, rate):
        ...     return pd(22.0 * scale, 2.2 * scale, rate=rate)
        >>> found = gain_margins(plant, law, [0.2, 0.7], rates=[30.0, 100.0])
        >>> bool(found.margins[1, 0] > found.margins[0, 0])
        True
    """
    pose = np.array(q, dtype=np.float64).reshape(-1)
    margins = [[_margin(plant, law, pose, rate, delay) for delay in delays] for rate in rates]
    return GainMargins(tuple(map(float, rates)), tuple(delays), np.array(margins))


def plot_gain_margins(ax: Axes, margins: GainMargins) -> Axes:
    """Plot the largest stable scale of the gains over the control rate, one line for each delay.

    Args:
        ax: Axes to draw on.
        margins: Gain margins by rate and delay.

    Returns:
        The axes.
    """
    for delay, column, colour in zip(margins.delays, margins.margins.T, reversed(SHADES), strict=False):
        label = f"delay of {delay} period{'' if delay == 1 else 's'}" if delay else "no delay"
        ax.loglog(margins.rates, column, marker="o", ms=3, color=colour, label=label)
    ax.axhline(1.0, color=GUIDE, lw=1.2, zorder=0)
    return decorate(ax, "rate of the law [Hz]", "largest stable scale of gains")


def held_leg(plant: Plant, q: FloatArray, rate: float) -> HeldLeg:
    """Linearise a leg at rest without Coulomb friction, and integrate it exactly over one period of constant torque."""
    refuse_rate(rate)
    still = np.zeros_like(q)
    A, B = discretise(linearise(ControlModel.of(plant), q, still, still), 1.0 / rate)
    return HeldLeg(A[None], B[None], np.eye(3 * len(q), 2 * len(q)))


def spectral_radius(leg: HeldLeg, law: AnyLaw, q: FloatArray, delay: int = 0) -> float:
    """Compute the spectral radius of one period of the closed loop, which is stable below 1."""
    loop = loop_matrices(leg, linear_law(law, q).without_last(), delay)
    return float(np.abs(np.linalg.eigvals(loop)).max())


def _margin(plant: Plant, law: LawOf, q: FloatArray, rate: float, delay: int) -> float:
    """Find the first stable scale, then the first unstable one above it, then bisect."""
    held = held_leg(plant, q, rate)

    def stable(scale: float) -> bool:
        """Whether the loop is stable with scaled gains."""
        return spectral_radius(held, law(scale, rate), q, delay) < 1.0

    below = 0.0
    for scale in SCALES:
        if stable(scale):
            below = scale
        elif below > 0.0:
            break
    else:
        return float("inf") if below > 0.0 else 0.0
    above = scale
    while above - below > 1e-6 * below:
        middle = float(np.sqrt(below * above))
        below, above = (middle, above) if stable(middle) else (below, middle)
    return float(below)
