"""Settings of a recursive estimator, and the matrices that follow from them once and for all."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.fixed_base import refuse_floating_base
from exoid.signals import FiniteDifference, Preparation, ZeroPhase
from exoid.torques import DryFriction, TorqueModel

from .kernels import Kernels, gaussian, sliding

ROWS = 5
"""Rows of a block behind the filter."""

SAMPLES = 64
"""Samples of a block without a filter."""

ROWS_A_CUTOFF = 6.0
"""Rows a second over the cut-off: at half this rate the filter passes 5 % of the amplitude."""

KINEMATICS_MULTIPLE = 2.0
"""Cut-off of the first filter over that of the second."""

FORGETTING = ("none", "exponential", "directional")
ESTIMATORS = ("wls", "ols")

EPOCH = 60.0
"""Default duration of an epoch of the detection of slow changes [s]."""

LAGS = 25
"""Rows over which the correlation of residuals is followed."""


@dataclass(frozen=True, eq=False)
class Settings:
    """Settings of a recursive estimator.

    Attributes:
        model: Leg and terms.
        rate: Sampling rate [Hz].
        cutoff: −3 dB frequency of the filter that columns and torque pass [Hz]; None for no filter.
        forgetting: "directional", "exponential" or "none".
        memory: Time constant with which rows are forgotten [s].
        estimator: "wls" or "ols".
        reversal_speed: Speed below which a joint with dry friction may stick [rad/s]; its rows are left out. 0 for
            none.
        torque_limits: Largest torque of each joint [N·m], (n,); samples at or beyond it are left out. Infinite for
            none.
        nonnegative: Whether friction and rotor inertia are kept from falling below zero.
        consistent: Whether the values are those of physically possible links.
        false_alarms: Rate of false alarms of the change detection [1/h]; 0 for no detection.
        window: Time constant of the change detection [s].
        epoch: Duration of rows whose estimates are compared to detect slow changes [s].

    Raises:
        ExoidError: A setting is out of range, or the model cannot be estimated online.
    """

    model: TorqueModel
    rate: float
    cutoff: float | None
    forgetting: str
    memory: float
    estimator: str
    reversal_speed: float
    torque_limits: FloatArray
    nonnegative: bool
    consistent: bool
    false_alarms: float
    window: float
    epoch: float = EPOCH

    def __post_init__(self) -> None:
        """Check the settings."""
        refuse_floating_base(self.model.leg, "a recursive estimator")
        _refuse_terms(self.model)
        for name, options in (("forgetting", FORGETTING), ("estimator", ESTIMATORS)):
            if getattr(self, name) not in options:
                raise ExoidError(f"{name}={getattr(self, name)!r}", remedy=f"use one of {', '.join(options)}")
        for name in ("rate", "memory", "window", "epoch"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ExoidError(f"{name}={getattr(self, name)}", remedy="pass a positive number, in Hz or s")
        for name in ("reversal_speed", "false_alarms"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ExoidError(f"{name}={getattr(self, name)}", remedy="pass zero or a positive number")
        if self.cutoff is not None and not 0.0 < self.cutoff < 0.5 * self.rate:
            raise ExoidError(
                f"a cut-off of {self.cutoff:g} Hz at {self.rate:g} Hz", remedy="pass a frequency below half the rate"
            )
        if self.estimator == "ols" and self.forgetting != "none":
            raise ExoidError("ols does not weigh rows, which forgetting needs", remedy="use wls, or forgetting='none'")
        if self.torque_limits.shape != (self.n,) or not (self.torque_limits > 0.0).all():
            raise ExoidError(
                f"torque limits of shape {self.torque_limits.shape} for {self.n} joints, or not positive",
                remedy="pass one number in N·m for each joint",
            )
        if self.cutoff is not None:
            _ = self.narrow, self.wide  # refuses a cut-off that the rate cannot carry

    @cached_property
    def n(self) -> int:
        """Number of joints."""
        return len(self.model.joint_names)

    @cached_property
    def count(self) -> int:
        """Number of parameters P."""
        return len(self.model.names)

    @property
    def preparation(self) -> Preparation:
        """Preparation of a batch identification that passes the same frequencies."""
        return FiniteDifference() if self.cutoff is None else ZeroPhase(cutoff=self.cutoff)

    @cached_property
    def stride(self) -> int:
        """Samples from one row to the next."""
        return 1 if self.cutoff is None else max(1, int(self.rate / (ROWS_A_CUTOFF * self.cutoff)))

    @cached_property
    def block(self) -> int:
        """Samples of a block."""
        return SAMPLES if self.cutoff is None else ROWS * self.stride

    @cached_property
    def limits(self) -> tuple[float, ...] | None:
        """Largest torque of each joint [N·m], (n,); None for none."""
        return None if np.isinf(self.torque_limits).all() else tuple(self.torque_limits.tolist())

    @property
    def row_time(self) -> float:
        """Time from one row to the next [s]."""
        return self.stride / self.rate

    @property
    def block_time(self) -> float:
        """Duration of a block [s]."""
        return self.block / self.rate

    @cached_property
    def wide(self) -> Kernels:
        """First filter: all channels pass it, and velocity and acceleration come out of it."""
        assert self.cutoff is not None
        limit = math.sqrt(math.log(2.0)) * self.rate / (2.0 * math.pi * 1.25)
        return gaussian(self.rate, min(KINEMATICS_MULTIPLE * self.cutoff, limit))

    @cached_property
    def narrow(self) -> Kernels:
        """Second filter, which columns and torque pass."""
        assert self.cutoff is not None
        return gaussian(self.rate, self.cutoff)

    @property
    def delay(self) -> float:
        """Delay of a row by the filters [s]."""
        return 0.0 if self.cutoff is None else (self.wide.delay + self.narrow.delay) / self.rate

    @cached_property
    def smoothing(self) -> FloatArray:
        """Matrices of value, first and second derivative by the first filter, (3, k, history + k)."""
        return np.array([sliding(weights, range(self.block)) for weights in self.wide])

    @cached_property
    def decimating(self) -> FloatArray:
        """Matrix of the second filter at every row, (m, history + k)."""
        return sliding(self.narrow.smooth, range(self.stride - 1, self.block, self.stride))

    @cached_property
    def histories(self) -> tuple[int, int]:
        """Samples that each filter keeps."""
        return (0, 0) if self.cutoff is None else (2 * self.wide.delay, 2 * self.narrow.delay)

    @cached_property
    def filter_inflation(self) -> float:
        """Rows that say as much as one independent row of white noise behind both filters."""
        if self.cutoff is None:
            return 1.0
        response = scipy.signal.convolve(self.wide.smooth, self.narrow.smooth)
        every = scipy.signal.correlate(response, response)[len(response) - 1 :: self.stride]
        return float(1.0 + 2.0 * (every[1:] / every[0]).sum())

    @cached_property
    def acting(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Parameters and joints of the columns that are not zero."""
        parameters, joints = np.nonzero(self.model.acting.T)
        return parameters, joints

    @cached_property
    def sticking(self) -> NDArray[np.bool_]:
        """Joints with dry friction, which may stick, (n,)."""
        found = np.zeros(self.n, dtype=np.bool_)
        for block in self.model.blocks:
            if isinstance(block.term, DryFriction):
                found[list(block.joints)] = True
        return found

    @cached_property
    def parameter_joint(self) -> tuple[str, ...]:
        """Joint that each parameter belongs to: that of the term, or of the segment; "" for neither, (P,)."""
        found = dict.fromkeys(self.model.names, "")
        leg = self.model.leg
        if leg.chain is not None:
            found |= {name: leg.joint_names[k // 3] for k, name in enumerate(leg.parameter_names)}
        for block in self.model.blocks:
            found |= {name: leg.joint_names[block.joints[0]] for name in block.names if name in found}
        return tuple(found.values())


def _refuse_terms(model: TorqueModel) -> None:
    """Refuse terms whose columns are not a function of one sample of the motion."""
    for block in model.blocks:
        term = block.term
        if term.internal_state is not None or term.loaded or term.needs_temperature:
            raise ExoidError(
                f"{type(term).__name__} depends on more than angle, velocity and acceleration of a sample",
                remedy="use Coulomb and Viscous friction without presliding online",
            )
