"""Motion of the root link at every step of a simulation, of which an IMU reads means."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.base_kinematics import BaseKinematics


@dataclass(frozen=True, eq=False, repr=False)
class BaseSteps:
    """Motion of the root link at every step, and which steps are samples of the log."""

    # motion at M steps. Its velocity is that of half a step before, as v⁺ = v + dt a and q⁺ = q + dt v⁺
    motion: BaseKinematics
    samples: NDArray[np.intp]  # step of each sample of the log, (N,)
    dt: float  # step [s]

    def averaged(self, window: float) -> BaseKinematics:
        """Compute means over a window about each sample, as a sensor of limited bandwidth reads them."""
        # With h = n dt the window, acceleration and specific force are means over its n + 1 steps, of which
        # the first and the last count half. The angular velocity is the mean over the n that lie between
        # them, so that it is of the same time as the angles. The ends of the run are continued by their
        # values.
        half = max(1, round(0.5 * window / self.dt))
        between = np.append(0.0, np.ones(2 * half))  # v of step k is of half a step before it
        around = np.convolve(np.ones(2 * half), (0.5, 0.5))
        velocity = self._mean(self.motion.angular_velocity, between)
        turning, force = (self._mean(x, around) for x in (self.motion.angular_acceleration, self.motion.specific_force))
        return BaseKinematics(velocity, turning, force)

    def _mean(self, x: FloatArray, weights: FloatArray) -> FloatArray:
        """Weighted mean about each sample, (N, 3)."""
        means = scipy.ndimage.correlate1d(x, weights / weights.sum(), axis=0, mode="nearest")
        return np.asarray(means[self.samples])
