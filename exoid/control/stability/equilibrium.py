"""Where a leg comes to rest under a law, and how far from there stiction may hold it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.control.law import Law, State
from exoid.control.model import ControlModel
from exoid.errors import ExoidError
from exoid.rig import Plant, Target

STEP = 1e-6
"""Of numerical derivatives [rad]."""


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Rest of a leg under a law that holds a constant target.

    Without friction it rests where the law's torque is the static one. With it, wherever the two differ by no more
    than static friction at each joint: |τ(θ, 0) − G(θ)| ≤ c0, for exact gravity compensation |θ_d − θ| ≤ c0 / Kp.

    Attributes:
        plant: The truth.
        law: The law.
        target: θ_d [rad], (n,).
        q: Rest without friction [rad], (n,).
        stiffness: −∂(τ − G)/∂θ there [N·m/rad], (n, n); Kp where gravity is compensated exactly.
    """

    plant: Plant
    law: Law
    target: FloatArray
    q: FloatArray
    stiffness: FloatArray

    @property
    def error(self) -> FloatArray:
        """θ_d − θ without friction [rad], (n,): zero where gravity is compensated exactly."""
        return self.target - self.q

    @property
    def band(self) -> FloatArray:
        """How far from :attr:`q` stiction may hold each joint, whatever the others do, to first order [rad], (n,)."""
        return np.asarray(np.abs(np.linalg.inv(self.stiffness)) @ self.plant.static[:, 0])

    def imbalance(self, q: ArrayLike) -> FloatArray:
        """Torque that friction must take at rest at q [N·m], (n,)."""
        return _imbalance(ControlModel.of(self.plant), self.law, self.target, np.asarray(q, dtype=np.float64))

    def holds(self, q: ArrayLike, tolerance: float = 1e-6) -> bool:
        """Whether stiction can hold the leg at q [rad], (n,); exact, not to first order.

        Args:
            q: Where.
            tolerance: Of the torque, a share of static friction.
        """
        return bool((np.abs(self.imbalance(q)) <= (1.0 + tolerance) * self.plant.static[:, 0] + tolerance).all())


def find_equilibrium(plant: Plant, law: Law, target: ArrayLike) -> Equilibrium:
    """Find where a leg without friction rests under a law.

    Args:
        plant: The truth, of one rig.
        law: Any law; its last torque is taken to be none.
        target: Constant θ_d [rad], (n,).

    Raises:
        ExoidError: There is no rest near the target, or it is unstable.
    """
    model, aim = ControlModel.of(plant), np.array(target, dtype=np.float64).reshape(-1)
    if aim.shape != (model.n,) or not np.isfinite(aim).all():
        raise ExoidError(f"a target of shape {np.shape(target)}", remedy=f"give {model.n} angles in rad")

    def imbalance(q: FloatArray) -> FloatArray:
        return _imbalance(model, law, aim, q)

    found = scipy.optimize.root(imbalance, aim, tol=1e-12)
    if not found.success and np.abs(found.fun).max() > 1e-9 * max(1.0, float(np.abs(model.statics(aim)).max())):
        raise ExoidError(
            f"no rest near {np.rad2deg(aim).round(1)} deg: the law's torque nowhere balances gravity and springs",
            remedy="raise Kp, or compensate gravity",
        )
    q = np.asarray(found.x)
    columns = [
        _imbalance(model, law, aim, q - STEP * unit) - _imbalance(model, law, aim, q + STEP * unit)
        for unit in np.eye(model.n)
    ]
    stiffness = np.array(columns).T / (2.0 * STEP)
    if np.linalg.eigvalsh(0.5 * (stiffness + stiffness.T))[0] <= 0.0:
        raise ExoidError(
            f"the rest at {np.rad2deg(q).round(1)} deg is unstable: gravity outgrows Kp",
            remedy="raise Kp, or compensate gravity",
        )
    return Equilibrium(plant, law, aim, q, stiffness)


def _imbalance(model: ControlModel, law: Law, target: FloatArray, q: FloatArray) -> FloatArray:
    still = np.zeros_like(q)
    return np.asarray(law.torque(State(q, still), Target(target, still, still)) - model.statics(q))
