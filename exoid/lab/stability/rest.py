"""Where a leg under a controller ends: at rest, within a band in which stiction may hold it, or in a limit cycle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, FloatArray
from exoid.control.law import Law, State
from exoid.control.model import ControlModel
from exoid.control.tracking import Tracking
from exoid.errors import BadArgumentError
from exoid.rig import Plant, Target

from .worn.linear_law import STEP


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Rest position of a leg under a controller with a constant target."""

    # Without friction, the leg rests at the pose at which the controller's torque equals the static torque. With
    # friction, it can rest at any pose with |τ(θ, 0) − G(θ)| ≤ c0 at each joint. For exact gravity compensation this is
    # |θ_d − θ| ≤ c0 / Kp.

    plant: Plant  # the true leg
    law: Law  # the controller
    target: FloatArray  # target θ_d [rad], (n,)
    q: FloatArray  # rest position without friction [rad], (n,)
    stiffness: FloatArray  # stiffness −∂(τ − G)/∂θ at `q` [N·m/rad], (n, n); Kp for exact gravity compensation

    @property
    def error(self) -> FloatArray:
        """Error θ_d − θ without friction [rad], (n,): zero for exact gravity compensation."""
        return self.target - self.q

    @property
    def band(self) -> FloatArray:
        """Distance from :attr:`q` at which stiction may hold each joint, to first order [rad], (n,)."""
        return np.asarray(np.abs(np.linalg.inv(self.stiffness)) @ self.plant.static[:, 0])

    def imbalance(self, q: ArrayLike) -> FloatArray:
        """Compute the torque that friction must balance at rest."""
        return _imbalance(ControlModel.of(self.plant), self.law, self.target, np.asarray(q, dtype=np.float64))

    def holds(self, q: ArrayLike) -> bool:
        """Tell whether stiction can hold the leg at a pose; exact, not to first order."""
        return bool((np.abs(self.imbalance(q)) <= (1.0 + 1e-6) * self.plant.static[:, 0] + 1e-6).all())


def find_equilibrium(plant: Plant, law: Law, target: ArrayLike) -> Equilibrium:
    """Find the rest position of a leg without friction under a controller.

    Args:
        plant: The true leg, one rig.
        law: Any controller; it receives no last torque.
        target: Constant target θ_d [rad], (n,).

    Returns:
        Rest position with its stiffness.

    Raises:
        ExoidError: There is no rest position near the target, or it is unstable.
    """
    model, aim = ControlModel.of(plant), np.array(target, dtype=np.float64).reshape(-1)
    if aim.shape != (model.n,) or not np.isfinite(aim).all():
        raise BadArgumentError(f"a target of shape {np.shape(target)}", remedy=f"give {model.n} angles in rad")

    def imbalance(q: FloatArray) -> FloatArray:
        """Torque that is left at angles (n,) [N·m]."""
        return _imbalance(model, law, aim, q)

    found = scipy.optimize.root(imbalance, aim, tol=1e-12)
    if not found.success and np.abs(found.fun).max() > 1e-9 * max(1.0, float(np.abs(model.statics(aim)).max())):
        raise BadArgumentError(
            f"no rest near {np.rad2deg(aim).round(1)} deg: the controller cannot balance gravity and springs there",
            remedy="raise Kp, or compensate gravity",
        )
    q = np.asarray(found.x)
    columns = [
        _imbalance(model, law, aim, q - STEP * unit) - _imbalance(model, law, aim, q + STEP * unit)
        for unit in np.eye(model.n)
    ]
    stiffness = np.array(columns).T / (2.0 * STEP)
    if np.linalg.eigvalsh(0.5 * (stiffness + stiffness.T))[0] <= 0.0:
        raise BadArgumentError(
            f"the rest at {np.rad2deg(q).round(1)} deg is unstable: gravity exceeds the stiffness Kp",
            remedy="raise Kp, or compensate gravity",
        )
    return Equilibrium(plant, law, aim, q, stiffness)


def _imbalance(model: ControlModel, law: Law, target: FloatArray, q: FloatArray) -> FloatArray:
    still = np.zeros_like(q)
    return np.asarray(law.torque(State(q, still), Target(target, still, still)) - model.statics(q))


class LimitCycle(NamedTuple):
    """Oscillation of the error of each joint in the last part of a run."""

    peak_to_peak: FloatArray  # peak-to-peak amplitude [rad], (n,)
    period: FloatArray  # mean time between upward crossings of the middle [s], (n,); NaN with fewer than two crossings
    lasting: FloatArray  # whether the oscillation of each joint does not decay, (n,)

    @property
    def peak_to_peak_deg(self) -> FloatArray:
        """Peak-to-peak amplitude [deg], (n,)."""
        return np.asarray(np.rad2deg(self.peak_to_peak))

    @property
    def exists(self) -> bool:
        """Whether the oscillation of any joint lasts."""
        return bool(self.lasting.any())


def find_limit_cycle(run: Tracking, last: float = 0.5) -> LimitCycle:
    """Find oscillations in the last part of a run towards a constant target, or along a periodic one.

    Args:
        run: The run.
        last: Share of the run to search, at its end; it should contain two periods of the oscillation.

    Returns:
        Amplitude and period of each joint.

    Raises:
        ExoidError: The share is not between 0 and 1, or leaves too few samples.
    """
    if not 0.0 < last <= 1.0:
        raise BadArgumentError(f"the last {last:g} of a run", remedy="give a share between 0 and 1")
    begin = int((1.0 - last) * len(run.time))
    time, error = run.time[begin:], run.error[begin:]
    if len(time) < 8:
        raise BadArgumentError(
            f"{len(time)} samples are too few for an oscillation", remedy="run longer, or log more often"
        )
    early, late = (np.ptp(half, axis=0) for half in np.array_split(error, 2))
    # Peak-to-peak amplitude below which a joint counts as at rest [rad].
    # Smallest ratio of the second half of an oscillation to the first for which it lasts.
    lasting = (late > np.deg2rad(0.05)) & (late >= 0.9 * early)
    middle = error - 0.5 * (error.max(axis=0) + error.min(axis=0))
    upward = (middle[:-1] < 0.0) & (middle[1:] >= 0.0)
    crossings = [time[1:][of_joint] for of_joint in upward.T]
    periods = np.array([np.diff(at).mean() if len(at) > 1 else np.nan for at in crossings])
    return LimitCycle(np.ptp(error, axis=0), periods, lasting)
