"""Torque noise for predictions of precision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError


@dataclass(frozen=True)
class TorqueNoise:
    """Noise of the logged torque signals.

    Attributes:
        std: Standard deviation at each joint [N·m].
        bandwidth: Frequency up to which the spectrum is flat [Hz]; inf for white noise. Noise of bandwidth b has 2 b
            independent samples a second at any rate of the log.
        assumed: Whether the standard deviations are default values.

    Raises:
        ExoidError: A standard deviation or the bandwidth is not positive.
    """

    std: tuple[float, ...]
    bandwidth: float = np.inf
    assumed: bool = False

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (all(0.0 < std < np.inf for std in self.std) and self.bandwidth > 0.0):
            raise ExoidError(
                f"torque noise of {self.std} N·m, bandwidth {self.bandwidth:g} Hz",
                remedy="give a positive standard deviation for each joint, and a positive bandwidth",
            )

    @classmethod
    def of(cls, std: ArrayLike | None, typical: FloatArray, bandwidth: float = np.inf) -> TorqueNoise:
        """Take given standard deviations, or 2 % of the typical torque of each joint.

        Args:
            std: Standard deviation [N·m], a number or (n,); None if unknown.
            typical: Typical torque of each joint [N·m], (n,).
            bandwidth: Frequency up to which the spectrum is flat [Hz].

        Returns:
            Noise of n joints.

        Raises:
            ExoidError: The number of standard deviations is neither one nor n, or a value is not positive.
        """
        if std is None:
            return cls(tuple((0.02 * typical).tolist()), bandwidth, assumed=True)
        try:
            each = np.broadcast_to(np.asarray(std, dtype=np.float64), typical.shape)
        except ValueError as error:
            raise ExoidError(
                f"torque noise of {np.size(std)} joints for a leg of {len(typical)}",
                remedy="give one number, or one for each joint",
            ) from error
        return cls(tuple(each.tolist()), bandwidth)

    def per_sample(self, rate: float) -> FloatArray:
        """Compute the standard deviation of white noise with the same spectral density in the band of the motion.

        Noise of bandwidth b has the spectral density of white noise that is √(rate / 2b) times as large.

        Args:
            rate: Sampling rate of the log [Hz].

        Returns:
            Standard deviations [N·m], (n,).
        """
        return np.asarray(np.array(self.std) * np.sqrt(max(1.0, rate / (2.0 * self.bandwidth))))

    def __str__(self) -> str:
        """Write standard deviations and bandwidth."""
        stds = ", ".join(f"{std:.2g}" for std in self.std)
        band = "white" if np.isinf(self.bandwidth) else f"up to {self.bandwidth:g} Hz"
        return f"{stds} N·m ({band}{', assumed' if self.assumed else ''})"
