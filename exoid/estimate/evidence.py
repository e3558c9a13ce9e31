"""Evidence behind the values of an estimate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import BadArgumentError
from exoid.regression.diagnostics import JointNoise
from exoid.regression.model import MotionSamples

OUTLYING = 0.001  # share of the samples at each end of a range that may be outliers


@dataclass(frozen=True, eq=False)
class MotionRanges:
    """Ranges of angle, speed and acceleration of each joint."""

    lowest: FloatArray  # smallest angle [rad], (n,)
    highest: FloatArray  # largest angle [rad], (n,)
    speed: FloatArray  # largest speed [rad/s], (n,)
    acceleration: FloatArray  # largest size of the acceleration [rad/s²], (n,)

    @classmethod
    def of(cls, motion: MotionSamples, used: BoolArray) -> MotionRanges:
        """Measure the ranges of some samples of a motion, without the outermost thousandth of them."""
        lowest, highest = np.quantile(motion.q[used], [OUTLYING, 1.0 - OUTLYING], axis=0)
        speed, acceleration = (np.quantile(np.abs(x[used]), 1.0 - OUTLYING, axis=0) for x in (motion.v, motion.a))
        return cls(lowest, highest, speed, acceleration)

    def joined(self, other: MotionRanges) -> MotionRanges:
        """Return the ranges of two motions together."""
        return MotionRanges(
            np.minimum(self.lowest, other.lowest),
            np.maximum(self.highest, other.highest),
            np.maximum(self.speed, other.speed),
            np.maximum(self.acceleration, other.acceleration),
        )


@dataclass(frozen=True)
class Support:
    """Samples at which the same links rested by wrenches that were not measured."""

    name: str  # these links, or "measured"
    seconds: float  # how long they rested in all recordings [s]
    residual_rms: Mapping[str, float]  # RMS residual of each row [N, N·m], by its name

    def __str__(self) -> str:
        """Write one line."""
        sizes = ", ".join(f"{row} {rms:.3g}" for row, rms in self.residual_rms.items())
        return f"{self.name}: {self.seconds:.1f} s, residual RMS [N, N·m]: {sizes}"


@dataclass(frozen=True, eq=False, kw_only=True)
class Evidence:
    """What recordings say beside the values of P parameters and n joints; None where it is not known.

    Attributes:
        dof_each: Degrees of freedom of each parameter's variance, at most those of the estimate, (P,): they depend on
            the noise at the parameter's own frequencies.
        parameter_scale: Parameter scale: value of each parameter that alone would explain all torque of a joint, (P,);
            see :attr:`exoid.Estimate.identifiability`.
        reference_scale: Reference scale: the parameter scale in a calm exercise at the same angles, (P,).
        collinearity: Condition index of each parameter: half of its variance comes from directions that the recordings
            see so many times worse than the best, (P,).
        noise: Noise of the residuals of each joint, n of them.
        ranges: Ranges of the motion that was fitted.
        torque_spread: Standard deviation of the fitted torque of each joint [N·m], (n,).
        cutoff_source: How the cut-off of the preparation was chosen.
        supports: Sets of links that rested on the ground, with the residuals of their rows; empty without contacts.
        bounded: Parameters that would have become negative and were kept at zero. Intervals are then centred there, as
            wide as without the bound: rather too wide.
    """

    dof_each: FloatArray | None = None
    parameter_scale: FloatArray | None = None
    reference_scale: FloatArray | None = None
    collinearity: FloatArray | None = None
    noise: tuple[JointNoise, ...] | None = None
    ranges: MotionRanges | None = None
    torque_spread: FloatArray | None = None
    cutoff_source: str | None = None
    supports: tuple[Support, ...] = ()
    bounded: tuple[str, ...] = ()

    def check(self, parameters: int, joints: int) -> None:
        """Check sizes and forbid changes.

        Args:
            parameters: Number of parameters P.
            joints: Number of joints n.

        Raises:
            ExoidError: An array has another shape, or is not finite.
        """
        shapes: dict[str, tuple[int, ...]] = dict.fromkeys((one.name for one in fields(self)[:4]), (parameters,))
        shapes["torque_spread"] = (joints,)
        freeze(self, {name: shape for name, shape in shapes.items() if getattr(self, name) is not None})
        if self.noise is not None and len(self.noise) != joints:
            raise BadArgumentError(f"noise of {len(self.noise)} joints, not {joints}", remedy="identify again")


def freeze(record: object, shapes: Mapping[str, tuple[int, ...]]) -> None:
    """Copy arrays of a record that must be finite and fit its parameters or joints, and forbid changes."""
    for name, shape in shapes.items():
        array = np.array(getattr(record, name), dtype=np.float64)
        if array.shape != shape or not np.isfinite(array).all():
            what = f"{name} of shape {array.shape} must be finite, and of shape {shape}"
            raise BadArgumentError(what, remedy="identify again")
        array.flags.writeable = False
        object.__setattr__(record, name, array)
