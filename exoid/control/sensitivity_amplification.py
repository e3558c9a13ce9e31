"""Sensitivity amplification: the wearer feels a fraction of the leg's inertia, and none of its weight."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

from .law import State, spread
from .model import ControlModel, ModelSource
from .motion_filter import FilteredMotion, MotionFilter
from .passive_friction import PassiveFriction, wearer_friction

BANDWIDTH = 20.0
"""Default bandwidth of the motion filter [Hz]."""

RATE = 500.0
"""Default sampling rate [Hz]."""

WHOLE = PassiveFriction(share=1.0)
"""All of the model's friction, of which the controller takes the share 1 − 1/α."""


@dataclass(frozen=True, eq=False)
class SensitivityAmplification:
    """τ = Ĝ(q) + ŝ(q) + (1 − 1/α) [M̂ q̈ + Ĉ q̇ + F̂] (Kazerooni et al. 2005), a :class:`exoid.control.StatefulLaw`."""

    # With an exact model the wearer's torque is (1/α) (M q̈ + C q̇ + F): the leg feels lighter by α and has no
    # weight. No sensor between wearer and leg is needed. M̂, Ĉ and F̂ are evaluated at the angles, velocities
    # and accelerations of a `exoid.control.MotionFilter`, all late by the same time; weight Ĝ and springs ŝ at
    # the angles as measured.
    #
    # The inertia in the loop is M − (1 − 1/α) M̂, so M̂ must not be too large: by 1/(α − 1) it becomes zero.
    # The larger α, the better the model must be.

    model: ControlModel  # model of the leg
    amplification: FloatArray  # amplification α ≥ 1, a number or (n,)
    filter: MotionFilter  # motion filter
    friction: PassiveFriction | None = WHOLE  # friction compensation, which never drives; None for none

    def __post_init__(self) -> None:
        """Check the amplification."""
        array = np.array(self.amplification, dtype=np.float64)
        if array.ndim > 1 or not ((array >= 1.0) & np.isfinite(array)).all():
            raise ExoidError(
                f"an amplification of {self.amplification!r}",
                remedy="give finite numbers ≥ 1, one or one for each joint; 1 compensates the weight alone",
            )
        array.flags.writeable = False
        object.__setattr__(self, "amplification", array)

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.filter.rate

    @cached_property
    def share(self) -> FloatArray:
        """Share 1 − 1/α of inertia and friction that the actuators make, () or (n,)."""
        return np.asarray(1.0 - 1.0 / self.amplification)

    def begin(self, state: State) -> FilteredMotion:
        """Compute the memory before the first sample."""
        return self.filter.begin(state.q, state.v)

    def step(self, memory: FilteredMotion, state: State, target: Target) -> tuple[FloatArray, FilteredMotion]:
        """Compute the torque; see the class."""
        moved = self.filter.step(memory, state.q, state.v)
        inertial = self.model.inverse_dynamics(moved.q, moved.v, moved.a) - self.model.statics(moved.q)
        inertial = inertial + wearer_friction(self.friction, self.model, moved.q, moved.v)
        return self.model.statics(state.q) + spread(self.share, state.q) * inertial, moved


def sensitivity_amplification(
    source: ModelSource,
    amplification: ArrayLike,
    *,
    bandwidth: float = BANDWIDTH,
    rate: float = RATE,
    friction: PassiveFriction | None = WHOLE,
) -> SensitivityAmplification:
    """Make a :class:`SensitivityAmplification` controller from a model of the leg.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        amplification: Amplification α ≥ 1, a number or one for each joint.
        bandwidth: Bandwidth of the motion filter [Hz], which makes accelerations of the measured velocities. If it is
            higher, the leg feels lighter over more frequencies, and more noise passes.
        rate: Sampling rate [Hz].
        friction: Friction compensation; None for none. Its share is multiplied by 1 − 1/α.

    Returns:
        The controller.

    Raises:
        ExoidError: An amplification is below 1, bandwidth or rate do not fit, or the source has no control model.

    Example:
        >>> law = sensitivity_amplification(est, 5.0, bandwidth=15.0)  # doctest: +SKIP
    """
    model = ControlModel.of(source)
    return SensitivityAmplification(model, np.asarray(amplification), MotionFilter(bandwidth, rate), friction)
