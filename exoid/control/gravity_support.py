"""Support of the leg's weight by a share, and transparent control: the wearer carries neither weight nor friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.rig import Target

from .law import RATE, State, refuse_rate, spread
from .model import ControlModel, ModelSource
from .passive_friction import PASSIVE, PassiveFriction, wearer_friction


@dataclass(frozen=True, eq=False)
class GravitySupport:
    """τ = share · [Ĝ(q) + ŝ(q)] + τ_f: the actuators carry a share of the weight, springs and offsets included."""

    # The wearer decides on the motion and feels the inertia, and the rest of weight and friction.

    model: ControlModel  # model of the leg
    share: FloatArray  # share of the weight, 0 to 1, a number or (n,)
    friction: PassiveFriction | None = None  # friction compensation, which never drives; None for none
    rate: float = RATE  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check share and rate."""
        refuse_rate(self.rate)
        array = np.array(self.share, dtype=np.float64)
        if array.ndim > 1 or not ((array >= 0.0) & (array <= 1.0)).all():
            raise ExoidError(
                f"support of {self.share!r} times the weight",
                remedy="give shares from 0 to 1; to carry the limb too, give a model that includes it",
            )
        array.flags.writeable = False
        object.__setattr__(self, "share", array)

    def torque(self, state: State, target: Target) -> FloatArray:
        """Compute the torque; see the class."""
        held = spread(self.share, state.q) * self.model.statics(state.q)
        return held + wearer_friction(self.friction, self.model, state.q, state.v)


def gravity_support(
    source: ModelSource, share: ArrayLike = 1.0, *, friction: PassiveFriction | None = None, rate: float = RATE
) -> GravitySupport:
    """Make a :class:`GravitySupport` controller.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        share: Share of the weight, 0 to 1, a number or one for each joint.
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A share is not from 0 to 1, the rate is not positive, or the source has no control model.

    Example:
        >>> import numpy as np
        >>> leg = exoid.load_leg("cuhk")
        >>> law = gravity_support(leg, share=0.6)
        >>> state = State(np.array([0.5, 0.8]), np.zeros(2))
        >>> np.allclose(law.torque(state, None), 0.6 * leg.gravity([0.5, 0.8])[0])
        True
    """
    return GravitySupport(ControlModel.of(source), np.asarray(share), friction, rate)


def transparent(
    source: ModelSource, *, friction: PassiveFriction | None = PASSIVE, rate: float = RATE
) -> GravitySupport:
    """Make a controller under which the wearer feels neither weight nor friction: zero torque at slow motion.

    The inertia remains; :func:`sensitivity_amplification` reduces that too.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        A :class:`GravitySupport` controller of all weight.

    Raises:
        ExoidError: The rate is not positive, or the source has no control model.
    """
    return gravity_support(source, 1.0, friction=friction, rate=rate)
