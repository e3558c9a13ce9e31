"""Torque model of a leg whose drives have unknown constants, linear about a point."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.actuators import Actuators
from exoid.actuators.constants import DriveConstant
from exoid.torques import Motion, TorqueModel


@dataclass(frozen=True, eq=False, repr=False)
class DriveModel(TorqueModel):
    """Both sides of τ(i, κ) = W β + τ_payload, linear in β and in changes δ of the constants κ of drives."""

    # τ(i, κ) is the torque that the drives make of their readings, such as ratio · k_t · i. About a point (β₀, κ₀):
    #
    #     τ(i, κ₀) − τ_payload = W β − s δ,    s = ∂τ/∂κ at the torque W β₀ + τ_payload of the model.
    #
    # The columns s are formed of the torque of the model, not of the measured currents. Noise of the currents therefore
    # stands on the left side only, and attenuates no constant. Where the solution is δ = 0, it solves
    # i = (W β + τ_payload) / (ratio · k_t), with the covariance of the Gauss-Newton method.

    point: FloatArray = field(kw_only=True)  # β₀, (P,)
    constants: tuple[DriveConstant, ...] = field(kw_only=True)  # the constants, K of them, whose changes are parameters
    actuators: Actuators = field(kw_only=True)  # drives with the constants κ₀

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, then of the constants, (P + K,)."""
        return (*super().names, *(each.name for each in self.constants))

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the parameters and of the constants, (P + K,)."""
        return (*super().units, *(each.constant.unit for each in self.constants))

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Which parameters and constants can act on which joint, (n, P + K)."""
        acting = super().acting
        for column, each in enumerate(self.constants, start=len(self.point)):
            acting[each.joint, column] = True
        return acting

    def columns(self, motion: Motion) -> FloatArray:
        """Form the columns W and −s for a motion, or for some rows of one."""
        out = super().columns(motion)
        torque = np.tensordot(self.point, out[: len(self.point)], axes=1)
        if motion.payload is not None:
            torque += motion.payload.T
        for column, each in enumerate(self.constants, start=len(self.point)):
            joint = each.joint
            if motion.computed is not None and motion.computed[joint]:
                drive = self.actuators.drives[self.leg.joint_names[joint]]
                slope = drive.sensitivity(each.constant.symbol, torque[joint], motion.v[:, joint])
                np.negative(slope, out=out[column, joint])
        return out
