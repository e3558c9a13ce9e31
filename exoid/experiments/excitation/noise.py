"""The torque noise that a plan reckons with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError

SHARE = 0.02
"""Of a joint's typical torque: the noise that is assumed where none is given."""


@dataclass(frozen=True)
class TorqueNoise:
    """Noise of the torque signals as they are logged.

    Attributes:
        std: Standard deviation at each joint [N·m].
        bandwidth: Up to where its spectrum is flat [Hz]; inf for white noise. Noise of bandwidth b has 2 b independent
            samples a second, however fast the log is.
        assumed: Whether nobody gave it.
    """

    std: tuple[float, ...]
    bandwidth: float = np.inf
    assumed: bool = False

    def __post_init__(self) -> None:
        """Check that there is noise."""
        if not (all(0.0 < std < np.inf for std in self.std) and self.bandwidth > 0.0):
            raise ExoidError(
                f"torque noise of {self.std} N·m, bandwidth {self.bandwidth:g} Hz",
                remedy="give a positive standard deviation for each joint, and a positive bandwidth",
            )

    @classmethod
    def of(cls, std: ArrayLike | None, typical: FloatArray, bandwidth: float = np.inf) -> TorqueNoise:
        """Take what is given, or 2 % of the typical torque of each joint.

        Args:
            std: A number or one for each joint [N·m]; None if unknown.
            typical: Typical torque of each joint [N·m], (n,).
            bandwidth: See the class.

        Raises:
            ExoidError: There is not one number, or one for each joint.
        """
        if std is None:
            return cls(tuple((SHARE * typical).tolist()), bandwidth, assumed=True)
        try:
            each = np.broadcast_to(np.asarray(std, dtype=np.float64), typical.shape)
        except ValueError as error:
            raise ExoidError(
                f"torque noise of {np.size(std)} joints for a leg of {len(typical)}",
                remedy="give one number, or one for each joint",
            ) from error
        return cls(tuple(each.tolist()), bandwidth)

    def per_sample(self, rate: float) -> FloatArray:
        """Standard deviation of white noise that does the same harm in a log at ``rate`` [Hz], (n,) [N·m].

        In the band of the motion noise of bandwidth b has the density of white noise √(rate / 2b) times as large.
        """
        return np.asarray(np.array(self.std) * np.sqrt(max(1.0, rate / (2.0 * self.bandwidth))))

    def __str__(self) -> str:
        """Say it in words."""
        stds = ", ".join(f"{std:.2g}" for std in self.std)
        band = "white" if np.isinf(self.bandwidth) else f"up to {self.bandwidth:g} Hz"
        return f"{stds} N·m ({band}{', assumed' if self.assumed else ''})"
