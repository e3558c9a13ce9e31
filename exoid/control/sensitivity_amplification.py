"""Sensitivity amplification: the wearer feels a fraction of the leg's inertia, and none of its weight."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import Dialect, LawInC
from exoid.codegen.law_in_c import per_joint
from exoid.codegen.templates import step_of
from exoid.errors import BadArgumentError
from exoid.rig import Target

from .c_description import describe
from .friction import PassiveFriction, wearer_friction
from .law import State, spread
from .model import ControlModel, ModelSource
from .motion_filter import FilteredMotion, MotionFilter

MEMORY = {
    "q": "filtered angles [rad]",
    "rate": "their rate of change [rad/s]",
    "v": "filtered velocities [rad/s]",
    "a": "their rate of change: accelerations [rad/s^2]",
    "q_read": "last reading of the angles [rad]",
    "v_read": "last reading of the velocities [rad/s]",
}
"""Memory of the motion filter in C."""

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
            raise BadArgumentError(
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

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the law in C; it has no reference."""
        share = per_joint(self.share, "amplification", self.model.n)
        return describe(
            self.model,
            self.friction,
            self.rate,
            dialect,
            equation="tau = G(q) + springs(q) + (1 - 1/alpha) (M a + C v{friction}) at filtered angles, velocities and "
            "accelerations",
            step=step_of("sensitivity_amplification"),
            calls=("gravity", "springs", "inverse_dynamics"),
            tables={"share": (share, "1 - 1/alpha"), **self.filter.tables_in_c()},
            memory=MEMORY,
            begin=step_of("sensitivity_amplification_begin"),
            measured="state->v",
        )


def sensitivity_amplification(
    source: ModelSource,
    amplification: ArrayLike,
    *,
    bandwidth: float = 20.0,
    rate: float = 500.0,
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
