"""Audit of a simulated machine: energy and momentum."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray


class Audit(NamedTuple):
    """Balance of energy and of linear momentum of a run.

    Energy: work + holding = gain + friction + contact. Momentum: ground + holder + weight = momentum. Both hold up to
    the error of the integration.

    Attributes:
        work: Work of the actuators [J].
        holding: Work of the rail or the spring on the machine [J].
        gain: Gain of mechanical energy, rotors and springs of the joints included [J].
        friction: Energy that friction of the joints dissipates [J].
        contact: Energy that the ground dissipates [J].
        turnover: ∫ |power| dt of the actuators [J], the scale of errors.
        ground: Impulse of the ground [N·s], (3,).
        holder: Impulse of rail or spring [N·s], (3,).
        weight: Impulse of gravity [N·s], (3,).
        momentum: Gain of linear momentum [N·s], (3,).
    """

    work: float
    holding: float
    gain: float
    friction: float
    contact: float
    turnover: float
    ground: FloatArray
    holder: FloatArray
    weight: FloatArray
    momentum: FloatArray

    @property
    def energy_error(self) -> float:
        """Residual of the energy balance over the turnover."""
        return abs(self.work + self.holding - self.gain - self.friction - self.contact) / self.turnover

    @property
    def momentum_error(self) -> float:
        """Residual of the momentum balance over the impulse of gravity."""
        residual = self.ground + self.holder + self.weight - self.momentum
        return float(np.abs(residual).max() / np.abs(self.weight).max())

    def __repr__(self) -> str:
        """Write the balance in one line."""
        return (
            f"Audit(work {self.work:.4g} J, holding {self.holding:.4g} J, gain {self.gain:.4g} J, friction "
            f"{self.friction:.4g} J, contact {self.contact:.4g} J; relative errors of energy {self.energy_error:.1g}, "
            f"of momentum {self.momentum_error:.1g})"
        )
