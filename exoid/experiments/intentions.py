"""What a wearer adds to an intended motion: tremor, and a stumble."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.rig import Reference, Target


@dataclass(frozen=True)
class Tremor(Reference):
    """Another motion with a tremor: θ + A sin(2π f t). Physiological tremor has 8 to 12 Hz, that of Parkinson's 4 to 6.

    Attributes:
        motion: The other motion.
        amplitude: Amplitude A [rad], a number or (n,).
        frequency: Frequency f [Hz], likewise.

    Raises:
        ExoidError: An amplitude or frequency is negative, not finite or too high.
    """

    motion: Reference
    amplitude: ArrayLike
    frequency: ArrayLike = 10.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        for name in ("amplitude", "frequency"):
            object.__setattr__(self, name, _column(getattr(self, name), f"{name} of a tremor"))
        if np.max(self.frequency) > 30.0:  # it is in rad/s
            raise BadArgumentError(f"a tremor of {np.max(self.frequency):g} Hz", remedy="give the frequency in Hz")

    def at(self, time: float) -> Target:
        """Evaluate the motion."""
        q, v, a = self.motion.at(time)
        amplitude, rate = np.asarray(self.amplitude), 2.0 * np.pi * np.asarray(self.frequency)
        sine, cosine = amplitude * np.sin(rate * time), amplitude * np.cos(rate * time)
        return Target(q + sine, v + rate * cosine, None if a is None else a - rate**2 * sine)


@dataclass(frozen=True)
class Stumble(Reference):
    """Another motion with a sudden detour: θ + A p(s), p = 64 s³ (1 − s)³, s = (t − t0) / T from 0 to 1.

    The detour is largest in its middle; its acceleration is continuous and at most 24 A / T².

    Attributes:
        motion: The other motion.
        detour: Largest detour A [rad], a number or (n,).
        begin: Time t0 at which it begins [s].
        duration: Duration T [s].

    Raises:
        ExoidError: A number is not finite, or the duration is not positive.
    """

    motion: Reference
    detour: ArrayLike
    begin: float
    duration: float = 0.4

    def __post_init__(self) -> None:
        """Check the numbers."""
        object.__setattr__(self, "detour", _column(self.detour, "detour of a stumble", signed=True))
        if not (np.isfinite(self.begin) and 0.0 < self.duration < np.inf):
            raise BadArgumentError(
                f"a stumble at {self.begin:g} s for {self.duration:g} s", remedy="give finite times, positive duration"
            )

    def at(self, time: float) -> Target:
        """Evaluate the motion."""
        q, v, a = self.motion.at(time)
        s = min(max((time - self.begin) / self.duration, 0.0), 1.0)
        w, detour = s * (1.0 - s), np.asarray(self.detour)
        slope = 1.0 - 2.0 * s
        rate, change = 192.0 * w * w * slope, 384.0 * w * (slope * slope - w)
        moved = None if a is None else a + change / self.duration**2 * detour
        return Target(q + 64.0 * w**3 * detour, v + rate / self.duration * detour, moved)


def _column(value: ArrayLike, name: str, *, signed: bool = False) -> FloatArray:
    """Check a number or (n,), which becomes (n, 1)."""
    array = np.asarray(value, dtype=np.float64)
    if array.ndim > 1 or not np.isfinite(array).all() or (not signed and (array < 0.0).any()):
        raise BadArgumentError(f"{name}: {value!r}", remedy="give finite SI numbers, one or one for each joint")
    return array[:, None] if array.ndim else array
