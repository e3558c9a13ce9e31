"""Gain margins of a sampled controller: eigenvalues of the linearised leg with a hold and a delay."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.control.law import Law, State, refuse_rate
from exoid.control.lqr import Linear, discretise, linearise
from exoid.control.model import ControlModel
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.rig import Plant, Target
from exoid.tools.json_values import attributes
from exoid.tools.tables import make_table, to_text

SCALES = np.geomspace(1e-2, 1e4, 121)
"""Scales of the gains among which the search finds the first unstable one."""

STEP = 1e-6
"""Step of numerical derivatives of controllers, relative to numbers above 1 [rad, rad/s]."""

SMOOTH = 1e-3
"""Largest relative difference of derivatives by one and two steps; a controller with more counts as not smooth."""

LawOf = Callable[[float, float], Law]
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

    Coulomb friction is left out: it hides small oscillations and does not stop large ones.

    Args:
        plant: The true leg, one rig.
        law: Function that makes the controller from a scale of the gains and a rate.
        q: Pose, which is also the target [rad], (n,).
        rates: Sampling rates [Hz].
        delays: Delays of the readings, in sampling periods.

    Returns:
        Margins by rate and delay.

    Raises:
        ExoidError: A rate or delay is invalid, or the controller has no derivatives at rest.

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


def spectral_radius(plant: Plant, law: Law, q: ArrayLike, delay: int = 0) -> float:
    """Compute the spectral radius of one period of the linearised closed loop, which is stable below 1."""
    pose = np.array(q, dtype=np.float64).reshape(-1)
    return _radius(_hold(plant, pose, law.rate), _feedback(law, pose), delay)


def _margin(plant: Plant, law: LawOf, q: FloatArray, rate: float, delay: int) -> float:
    """Find the first stable scale, then the first unstable one above it, then bisect."""
    held = _hold(plant, q, rate)

    def stable(scale: float) -> bool:
        """Whether the loop is stable with scaled gains."""
        return _radius(held, _feedback(law(scale, rate), q), delay) < 1.0

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


def _hold(plant: Plant, q: FloatArray, rate: float) -> Linear:
    """Linearise the leg at rest, and integrate it exactly over one period of constant torque."""
    refuse_rate(rate)
    still = np.zeros_like(q)
    return discretise(linearise(ControlModel.of(plant), q, still, still), 1.0 / rate)


def _feedback(law: Law, q: FloatArray) -> FloatArray:
    """Derivatives of a controller's torque by angle and velocity at rest on the target, (n, 2 n)."""
    refusal = NotSupportedError(
        f"{type(law).__name__} has no derivatives at rest: its friction compensation is too sharp",
        remedy="leave out friction compensation, or use a smooth one",
    )
    return smooth_derivatives(partial(_derivatives, law, q), refusal)


def smooth_derivatives(of_step: Callable[[float], FloatArray], refusal: NotSupportedError) -> FloatArray:
    """Take the derivatives of a controller by differences of one step, if those of twice the step are alike."""
    first, second = of_step(STEP), of_step(2.0 * STEP)
    if np.abs(first - second).max() > SMOOTH * np.abs(first).max():
        raise refusal
    return first


def _derivatives(law: Law, q: FloatArray, step: float) -> FloatArray:
    still = np.zeros_like(q)
    target = Target(q, still, still)
    columns = []
    for unit in step * np.eye(len(q)):
        columns.append(law.torque(State(q + unit, still), target) - law.torque(State(q - unit, still), target))
    for unit in step * np.eye(len(q)):
        columns.append(law.torque(State(q, unit), target) - law.torque(State(q, -unit), target))
    return np.array(columns).T / (2.0 * step)


def _radius(held: Linear, feedback: FloatArray, delay: int) -> float:
    """Spectral radius for the state with its past, (x_k, x_{k−1}, …, x_{k−d})."""
    if delay < 0 or delay != int(delay):
        raise BadArgumentError(f"a delay of {delay} periods", remedy="give a whole number")
    size = len(held.A)
    loop = np.zeros(((delay + 1) * size,) * 2)
    loop[:size, :size] = held.A
    loop[:size, delay * size :] += held.B @ feedback
    loop[size:, :-size] = np.eye(delay * size)
    return float(np.abs(np.linalg.eigvals(loop)).max())
