"""Document 2's Lyapunov function along a closed-loop run, and its rate under the actual torque."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.control.law import gains
from exoid.control.model import ControlModel
from exoid.control.tracking import Tracking
from exoid.errors import BadArgumentError
from exoid.rig import Plant

TOLERANCE = 1e-9
"""Tolerance of an increase of V, as a share of its initial value: the accuracy of the rig."""


@dataclass(frozen=True, eq=False, repr=False)
class Lyapunov:
    """V = ½ θ̇ᵀ M(θ) θ̇ + ½ θ̃ᵀ Kp θ̃ with θ̃ = θ_d − θ (doc. 2, eq. (29)) along a run."""

    law: str  # name of the controller
    sample_rate: float  # sampling rate of the controller [Hz]
    time: FloatArray  # time [s], (N,)
    value: FloatArray  # lyapunov function V [J], (N,)
    rate: FloatArray  # rate V̇ by eq. (30) under the torque held until that moment [W], (N,)
    ideal_rate: FloatArray  # rate −θ̇ᵀ Kd θ̇ of eq. (32) [W], (N,)

    @property
    def largest_increase(self) -> float:
        """Largest increase of V from one moment to the next, as a share of its initial value; 0 if there is none."""
        return float(max(0.0, np.diff(self.value).max()) / self._scale)

    @property
    def share_increasing(self) -> float:
        """Share of the moments at which V grows by more than :data:`TOLERANCE`."""
        return float((np.diff(self.value) > TOLERANCE * self._scale).mean())

    def never_increases(self, tolerance: float = TOLERANCE) -> bool:
        """Tell whether V never increases."""
        return self.largest_increase <= tolerance

    def sampled(self) -> Lyapunov:
        """Keep only the sampling instants of the controller."""
        every = (len(self.time) - 1) / (self.time[-1] * self.sample_rate)
        if abs(every - round(every)) > 1e-6 * every or every < 0.5:
            raise BadArgumentError(
                f"a log every {self.time[1] - self.time[0]:g} s does not have the samples of a controller at "
                f"{self.sample_rate:g} Hz",
                remedy="simulate with a log_rate that is a multiple of the controller's rate",
            )
        kept = slice(None, None, round(every))
        arrays = {name: getattr(self, name)[kept] for name in ("time", "value", "rate", "ideal_rate")}
        return replace(self, **arrays)

    @property
    def _scale(self) -> float:
        return float(self.value[0]) if self.value[0] > 0.0 else 1.0

    def __repr__(self) -> str:
        """Name the controller and the course of V."""
        change = f"{self.value[0]:.4g} to {self.value[-1]:.3g} J"
        return f"Lyapunov({self.law}: {change}, rises by at most {self.largest_increase:.1e} of the first)"


def lyapunov(run: Tracking, plant: Plant, kp: ArrayLike, kd: ArrayLike) -> Lyapunov:
    """Evaluate V and its rate along a run.

    With Property 2, eq. (30) is V̇ = θ̇ᵀ (τ − G(θ) − F_r) + θ̃ᵀ Kp (θ̇_d − θ̇), for any controller. It equals eq. (32)
    only if the torque is that of document 2's controller at the same moment, with exact G and F_r. Between two samples,
    or with stiction, it does not.

    Args:
        run: The run.
        plant: The true leg of the run.
        kp: Kp of V [N·m/rad], a number or one for each joint.
        kd: Kd of eq. (32) [N·m·s/rad].

    Returns:
        V and its rates at every moment of the log.

    Raises:
        ExoidError: The plant is not one rig with an upright torso, or a gain is negative.
    """
    if np.any(plant.pitch):
        raise BadArgumentError(
            "the torso of the plant is tilted", remedy="use an upright torso, for which V is defined"
        )
    model, stiffness, damping = ControlModel.of(plant), gains(kp, "kp"), gains(kd, "kd")
    q, v, error = run.q, run.v, run.error
    M = model.leg.mass_matrix(q) + model.rotors(q)
    value = 0.5 * np.einsum("ki,kij,kj->k", v, M, v) + 0.5 * (stiffness * error**2).sum(axis=1)
    torque = run.tau.copy()
    torque[0] = torque[min(1, len(torque) - 1)]  # none was held before the first sample
    net = torque - model.statics(q.T).T - model.friction(q.T, v.T, 0.0).T
    target_v = np.gradient(run.target, run.time, axis=0)
    rate = (v * net).sum(axis=1) + (stiffness * error * (target_v - v)).sum(axis=1)
    return Lyapunov(run.law, run.rate, run.time, value, rate, -(damping * v**2).sum(axis=1))
