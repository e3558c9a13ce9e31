"""Sensitivity amplification: the wearer feels a fraction of the leg's inertia, and none of its weight."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.codegen import Dialect, LawInC
from exoid.codegen.templates import step_of
from exoid.leg.joint_numbers import for_joints
from exoid.rig import Target
from exoid.tools.numbers import checked

from .c_description import describe
from .friction import FrictionCompensation, model_to_compensate
from .law import State, refuse_rate, refuse_shape, sound, spread
from .model import ControlModel, ModelSource

WHOLE = FrictionCompensation(drives=False)
"""All of the model's friction, of which the controller takes the share 1 − 1/α."""


class FilteredMotion(NamedTuple):
    """Memory of the filter, which contains the filtered motion, (n,) or (n, B) each."""

    q: FloatArray  # filtered angles [rad]
    rate: FloatArray  # rate of change of the filtered angles [rad/s]
    v: FloatArray  # filtered velocities [rad/s]
    a: FloatArray  # rate of change of the filtered velocities: accelerations, with the same delay [rad/s²]
    q_read: FloatArray  # last reading of the angles [rad]
    v_read: FloatArray  # last reading of the velocities [rad/s]


@dataclass(frozen=True)
class MotionFilter:
    """Low-pass filter λ² / (s + λ)² of angles and velocities, whose states also give the accelerations."""

    # The step is exact for readings that change linearly over each period T. With a channel x, its rate y, the
    # slope m of its reading u, z = x − u + 2m/λ and w = y − m:
    #
    #     z⁺ = e^{−λT} [(1 + λT) z + T w],      w⁺ = e^{−λT} [(1 − λT) w − λ²T z].
    #
    # The filter has no overshoot and no resonance: its gain is at most 1 at every frequency, from the mean acceleration
    # of a period to the filtered one too. Every channel is late by `delay`.

    bandwidth: float  # frequency of half the power [Hz]
    rate: float  # sampling rate [Hz]

    def __post_init__(self) -> None:
        """Check bandwidth and rate."""
        refuse_rate(self.rate)
        checked(self.bandwidth, "the bandwidth of the motion filter [Hz]", above=0.0, most=0.5 * self.rate, ndim=0)

    @property
    def pole(self) -> float:
        """Pole λ [1/s]."""
        # 1 / (1 + jω/λ)² has half the power where (ω/λ)² = √2 − 1
        return 2.0 * np.pi * self.bandwidth / float(np.sqrt(np.sqrt(2.0) - 1.0))

    @property
    def delay(self) -> float:
        """Delay 2/λ of slow motion [s]."""
        return 2.0 / self.pole

    def begin(self, q: FloatArray, v: FloatArray) -> FilteredMotion:
        """Begin as if the leg had moved with constant velocity until the first sample."""
        before = q - v / self.rate
        return FilteredMotion(before - self.delay * v, v, v, np.zeros_like(v), before, v)

    def step(self, motion: FilteredMotion, q: FloatArray, v: FloatArray) -> FilteredMotion:
        """Filter a sample."""
        angles = self._channel(motion.q, motion.rate, motion.q_read, q)
        return FilteredMotion(*angles, *self._channel(motion.v, motion.a, motion.v_read, v), q, v)

    def _channel(
        self, x: FloatArray, y: FloatArray, before: FloatArray, u: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        step, period, slope = self.pole / self.rate, 1.0 / self.rate, (u - before) * self.rate
        late, decay = self.delay * slope, float(np.exp(-step))
        z, w = x - before + late, y - slope
        z_next = decay * ((1.0 + step) * z + period * w)
        w_next = decay * ((1.0 - step) * w - self.pole * step * z)
        return u - late + z_next, slope + w_next


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
    friction: FrictionCompensation | None = WHOLE  # friction compensation, which never drives; None for none

    def __post_init__(self) -> None:
        """Check the amplification."""
        object.__setattr__(self, "amplification", checked(self.amplification, "amplification", least=1.0))

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
        refuse_shape(state, self.model.n, np.shape(state.q)[1:2])
        return self.filter.begin(state.q, state.v)

    def step(self, memory: FilteredMotion, state: State, target: Target) -> tuple[FloatArray, FilteredMotion]:
        """Compute the torque; see the class."""
        refuse_shape(state, self.model.n, memory.q.shape[1:])
        with np.errstate(invalid="ignore"):  # what is not finite is refused below, by name
            moved = self.filter.step(memory, state.q, state.v)
        inertial = self.model.inverse_dynamics(moved.q, moved.v, moved.a) - self.model.statics(moved.q)
        if self.friction is not None:
            filtered = state._replace(q=moved.q, v=moved.v)
            inertial = inertial + self.friction.torque(self.model, filtered, target)
        torque = self.model.statics(state.q) + spread(self.share, state.q) * inertial
        return sound(self.model.driven(torque), state), moved

    def in_c(self, dialect: Dialect) -> LawInC:
        """Describe the law in C; it has no reference."""
        share, one = for_joints(self.share, self.model.n, "amplification"), self.filter
        step, decay = one.pole / one.rate, float(np.exp(-one.pole / one.rate))
        return describe(
            self.model,
            self.friction,
            self.rate,
            dialect,
            equation="tau = G(q) + springs(q) + (1 - 1/alpha) (M a + C v{friction}) at filtered angles, velocities and "
            "accelerations",
            step=step_of("sensitivity_amplification"),
            calls=("gravity", "springs", "bodies"),
            tables={
                "share": (share, "1 - 1/alpha"),
                "filter_delay": (one.delay, "delay 2/lambda of the motion filter [s]"),
                "filter_rate": (one.rate, "sampling rate [Hz]"),
                "filter_zz": (decay * (1.0 + step), "exp(-lambda T) (1 + lambda T)"),
                "filter_zw": (decay / one.rate, "exp(-lambda T) T [s]"),
                "filter_wz": (-decay * one.pole * step, "-exp(-lambda T) lambda^2 T [1/s]"),
                "filter_ww": (decay * (1.0 - step), "exp(-lambda T) (1 - lambda T)"),
            },
            memory={  # of the motion filter
                "q": "filtered angles [rad]",
                "rate": "their rate of change [rad/s]",
                "v": "filtered velocities [rad/s]",
                "a": "their rate of change: accelerations [rad/s^2]",
                "q_read": "last reading of the angles [rad]",
                "v_read": "last reading of the velocities [rad/s]",
            },
            begin=step_of("sensitivity_amplification_begin"),
            measured="state->v",
        )


def sensitivity_amplification(
    source: ModelSource,
    amplification: ArrayLike,
    *,
    bandwidth: float = 20.0,
    rate: float = 500.0,
    friction: FrictionCompensation | None = WHOLE,
) -> SensitivityAmplification:
    """Make a :class:`SensitivityAmplification` controller from a model of the leg.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        amplification: Amplification α ≥ 1, a number or one for each joint.
        bandwidth: Bandwidth of the motion filter [Hz], which makes accelerations of the measured velocities. If it is
            higher, the leg feels lighter over more frequencies, and more noise passes.
        rate: Sampling rate [Hz].
        friction: Friction compensation, its share times 1 − 1/α; a warning if it drives and is negative. None for none.

    Returns:
        The controller.

    Raises:
        ExoidError: An amplification is below 1, bandwidth or rate do not fit, friction is of a desired velocity, or the
            source has no control model.

    Example:
        >>> import exoid
        >>> float(sensitivity_amplification(exoid.load_leg("cuhk"), 5.0, bandwidth=15.0).share)
        0.8
    """
    model = model_to_compensate(source, friction, follows=False)
    return SensitivityAmplification(model, np.asarray(amplification), MotionFilter(bandwidth, rate), friction)
