"""Settings of a recursive estimator, and the matrices that follow from them once and for all."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.description import LARGEST_ANGLE
from exoid.leg.leg_data import refuse_floating_base
from exoid.tools.numbers import checked
from exoid.torques import DryFriction, TorqueModel

from .hypotheses import Detection

LAGS = 100
"""Rows over which the correlation of residuals is followed: 2 s at a cut-off of 8 Hz, a stride."""


@dataclass(frozen=True, eq=False)
class Settings:
    """Settings as :class:`exoid.online.RecursiveEstimator` describes them."""

    model: TorqueModel
    rate: float = 500.0
    cutoff: float | None = 8.0
    memory: float = 20.0
    reversal_speed: float = 0.1
    torque_limits: tuple[float, ...] = ()  # of each joint [N·m]; empty for none
    false_alarms: float = 0.1
    passive: tuple[str, ...] = ()  # joints without an actuator
    largest_angle: float = 2.0 * LARGEST_ANGLE  # beyond which angles are degrees [rad]
    flat: bool = True  # whether the first filter keeps harmonics; a Gaussian lets less noise into the accelerations

    def __post_init__(self) -> None:
        """Check the settings."""
        refuse_floating_base(self.model.leg, "a recursive estimator")
        for block in self.model.blocks:
            term = block.term
            if term.internal_state is not None or term.loaded:
                what = f"{type(term).__name__} depends on more than angle, velocity and acceleration of a sample"
                raise NotSupportedError(what, remedy="use Coulomb and Viscous friction without presliding online")
        checked(self.largest_angle, "the largest angle in rad", above=0.0, infinite=True, ndim=0)
        checked(self.rate, "the rate in Hz", above=0.0, ndim=0)
        checked(self.memory, "the memory in s", above=0.0, infinite=True, ndim=0)
        checked([self.reversal_speed, self.false_alarms], "the reversal speed or rate of false alarms", least=0.0)
        checked(self.torque_limits, "the torque limits in N·m", above=0.0, infinite=True)
        if len(self.torque_limits) not in (0, self.n):
            what = f"{len(self.torque_limits)} torque limits for {self.n} joints"
            raise BadArgumentError(what, remedy="pass one number in N·m for each joint")
        if not self.driven.any():
            what, remedy = "all joints are passive", "leave those out of passive whose torque is measured"
            raise BadArgumentError(what, remedy=remedy)
        if self.cutoff is not None:
            _ = self.kernels  # refuses a cut-off that the rate cannot carry

    @cached_property
    def n(self) -> int:
        """Number of joints."""
        return len(self.model.leg.joint_names)

    @cached_property
    def count(self) -> int:
        """Number of parameters P."""
        return len(self.model.names)

    @cached_property
    def stride(self) -> int:
        """Samples from one row to the next: six rows a period of the cut-off; at half of that 5 % of a signal pass."""
        return 1 if self.cutoff is None else max(1, int(self.rate / (6.0 * self.cutoff)))

    @cached_property
    def block(self) -> int:
        """Samples of a block: five rows behind the filter, or 64 samples without one."""
        return 64 if self.cutoff is None else 5 * self.stride

    @property
    def block_time(self) -> float:
        """Duration of a block [s]."""
        return self.block / self.rate

    @cached_property
    def kernels(self) -> tuple[FloatArray, FloatArray]:
        """First filter, from which velocity and acceleration come, and second one, of columns and torque."""
        # A first filter that took a tenth of a harmonic would bend products such as v², and with them the values
        assert self.cutoff is not None
        widest = self.rate / (1.25 * _width(flat=self.flat))
        first = kernels(self.rate, min(2.0 * self.cutoff, widest), flat=self.flat)
        return first, kernels(self.rate, self.cutoff)[:2]

    @cached_property
    def histories(self) -> tuple[int, int]:
        """Samples that each filter keeps."""
        return (0, 0) if self.cutoff is None else (self.kernels[0].shape[1] - 1, self.kernels[1].shape[1] - 1)

    @property
    def delay(self) -> float:
        """Delay of a row by the filters [s]."""
        return (self.histories[0] // 2 + self.histories[1] // 2) / self.rate

    @cached_property
    def smoothing(self) -> FloatArray:
        """Matrices of value, first and second derivative by the first filter, (3, k, history + k)."""
        return _sliding(self.kernels[0], range(self.block))

    @cached_property
    def decimating(self) -> FloatArray:
        """Matrices of value and derivative by the second filter at every row, (2, m, history + k)."""
        return _sliding(self.kernels[1], range(self.stride - 1, self.block, self.stride))

    @cached_property
    def filter_inflation(self) -> float:
        """Rows that say as much as one independent row of white noise behind both filters."""
        if self.cutoff is None:
            return 1.0
        response = np.convolve(self.kernels[0][0], self.kernels[1][0])
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
        sticking = [j for block in self.model.blocks if isinstance(block.term, DryFriction) for j in block.joints]
        return np.isin(np.arange(self.n), sticking)

    @cached_property
    def driven(self) -> NDArray[np.bool_]:
        """Joints that are not passive, (n,)."""
        return np.isin(self.model.leg.joint_names, self.passive, invert=True)

    @cached_property
    def detection(self) -> Detection:
        """Hypotheses of the change detection, with their thresholds."""
        alarms = self.false_alarms if self.memory < math.inf else 0.0
        return Detection.of(self.model, alarms / 36_000.0)  # at most ten independent looks a second


def kernels(rate: float, cutoff: float, *, flat: bool = False) -> FloatArray:
    """Weights of the smoothed signal and its two derivatives, (3, 2 d + 1); −3 dB at the cut-off."""
    # The zero-phase filter of an identification needs samples that are still to come. A symmetric kernel gives the
    # same, d samples late. It is a Gaussian of four σ to each side. A flat one, of five, is a Gaussian times a
    # polynomial that keeps parabolas as they are: it takes 1 % of a signal at 0.38 of its cut-off, a Gaussian 5 %.
    sigma = 1.0 / (cutoff * _width(flat=flat)) if cutoff > 0.0 else math.inf
    narrowest = 1.2  # standard deviation in samples for which the derivatives are accurate to 1 %
    if not narrowest <= sigma * rate < 1e5:
        remedy = f"choose a cut-off below {rate / (narrowest * _width(flat=flat)):.3g} Hz, and the rate in Hz"
        raise BadArgumentError(f"a causal low-pass of {cutoff:.4g} Hz at {rate:.4g} samples a second", remedy=remedy)
    half = math.ceil((4.0 + flat) * sigma * rate)
    t, found = np.arange(-half, half + 1) / (sigma * rate), []
    for k in range(3):
        powers = t ** np.arange(k % 2, k + 1 + 2 * flat, 2)[:, None]
        basis, wanted = powers * np.exp(-0.5 * t**2), np.zeros(len(powers))
        wanted[k // 2] = math.factorial(k)  # the k-th derivative of tᵏ; those of the other powers are zero
        found.append(np.linalg.solve(basis @ powers.T, wanted) @ basis / sigma**k)
    return np.array(found)


def _width(*, flat: bool) -> float:
    """Product of 1/σ over the cut-off, 2π / √(2 y): e⁻ʸ, or (1 + y) e⁻ʸ of a flat kernel, is −3 dB."""
    return 2.0 * math.pi / math.sqrt(2.0 * (1.07796 if flat else 0.5 * math.log(2.0)))


def _sliding(kernels: FloatArray, rows: range) -> FloatArray:
    """Matrices that apply weights to the samples behind a history of as many samples less one."""
    return np.array([[np.pad(weights, (row, rows.stop - 1 - row)) for row in rows] for weights in kernels])
