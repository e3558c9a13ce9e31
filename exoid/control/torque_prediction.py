"""Prediction error of the torque for composite adaptation, with the information that it contains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError

from .friction import WIDTH
from .law import State
from .motion_filter import FilteredMotion, MotionFilter
from .slotine_li import SlotineLiModel

SLIDING = 2.0 * WIDTH
"""Velocity above which friction is known well enough to learn from a joint's torque [rad/s]."""


SETTLED = 5.0
"""Delays of the filter until its signals count: the torque before the first sample is unknown."""


class PredictionMemory(NamedTuple):
    """Memory of the prediction, with B legs."""

    motion: FilteredMotion  # filtered motion, (n, B) each
    torque: FloatArray  # filtered torque [N·m], (n, B)
    torque_rate: FloatArray  # rate of change of it [N·m/s], (n, B)
    information: FloatArray  # information matrix I = P⁻¹, (B, P, P)
    age: FloatArray  # time since the first sample [s], ()


class Learned(NamedTuple):
    """What a sample teaches."""

    memory: PredictionMemory  # memory for the next sample
    gradient: FloatArray  # T Wᵀ R e, (B, P)


@dataclass(frozen=True)
class TorquePrediction:
    """Prediction error e = W(q_f, v_f, a_f) β − τ_f of filtered signals, and the information İ = WᵀRW − λ (I − I₀).

    Motion and torque pass the same filter λ_f² / (s + λ_f)², so that accelerations need no derivative of the noise.
    Information is forgotten towards that of the beginning (M. E. Salgado, G. C. Goodwin, R. H. Middleton 1988). So
    I ≥ I₀ always, and the gain P never exceeds the initial covariance: it does not wind up. Nothing is forgotten while
    no joint slides.

    Attributes:
        bandwidth: Bandwidth of the filter [Hz].
        torque_std: Standard deviation of the torque's error, noise and model together [N·m].
        correlation: Time over which this error is correlated [s]: R = 1 / (torque_std² · correlation).
        memory: Time 1/λ over which information is forgotten [s].

    Raises:
        ExoidError: A number is not positive.
    """

    bandwidth: float = 5.0
    torque_std: float = 1.0
    correlation: float = 0.1
    memory: float = 10.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        numbers = (self.bandwidth, self.torque_std, self.correlation, self.memory)
        if not all(0.0 < number < np.inf for number in numbers):
            raise ExoidError(f"no such prediction: {self}", remedy="give positive, finite numbers")

    def filter(self, rate: float) -> MotionFilter:
        """Make the filter.

        Args:
            rate: Sampling rate [Hz].

        Returns:
            The filter.

        Raises:
            ExoidError: The bandwidth is half the sampling rate or more.
        """
        return MotionFilter(self.bandwidth, rate)

    def begin(self, state: State, information: FloatArray, rate: float) -> PredictionMemory:
        """Compute the memory before the first sample.

        Args:
            state: Measured state, (n, B).
            information: Initial information, (P, P).
            rate: Sampling rate [Hz].

        Returns:
            The memory.
        """
        still = np.zeros_like(state.q)
        motion = self.filter(rate).begin(state.q, state.v)
        return PredictionMemory(motion, still, still, np.tile(information, (state.q.shape[1], 1, 1)), np.zeros(()))

    def learn(
        self,
        memory: PredictionMemory,
        model: SlotineLiModel,
        values: FloatArray,
        state: State,
        initial: FloatArray,
        usable: NDArray[np.bool_],
        rate: float,
    ) -> Learned:
        """Compare predicted and measured torque at a sample.

        Args:
            memory: Memory from the previous sample.
            model: Linear model of the leg.
            values: Parameters β, (B, P).
            state: Measured state with the torque held until this moment in ``state.last``, (n, B).
            initial: Initial information I₀, (P, P).
            usable: Joints whose rows may be used, (n, B).
            rate: Sampling rate [Hz].

        Returns:
            Gradient and memory.
        """
        lowpass, period = self.filter(rate), 1.0 / rate
        motion = lowpass.step(memory.motion, state.q, state.v)
        held = np.zeros_like(state.q) if state.last is None else state.last
        torque, torque_rate = lowpass.hold(memory.torque, memory.torque_rate, held)
        W = model.regressor(motion.q, motion.v, motion.v, motion.a)
        settled = memory.age >= SETTLED * lowpass.delay
        sliding = usable & settled & (np.abs(motion.v) > SLIDING)
        W = W * sliding.T[..., None]
        measured = (torque - model.fixed(motion.q, motion.v, motion.a)) * sliding
        error = np.einsum("bnp,bp->bn", W, values) - measured.T
        weight = period / (self.torque_std**2 * self.correlation)
        kept = np.where(sliding.any(axis=0), np.exp(-period / self.memory), 1.0)[:, None, None]
        gained = weight * np.einsum("bnp,bnr->bpr", W, W)
        information = initial + kept * (memory.information - initial) + gained
        after = PredictionMemory(motion, torque, torque_rate, information, memory.age + period)
        return Learned(after, weight * np.einsum("bnp,bn->bp", W, error))
