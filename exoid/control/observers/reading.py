"""Readings of an observer: the torque of the wearer with its band, at one sample or over a log."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.tools.tables import make_table, to_text


class ObserverReading(NamedTuple):
    """Torque that acts on the leg from outside, at one sample, (n,) each.

    Attributes:
        torque: Torque of the wearer on the leg [N·m], as it was one delay of the observer ago.
        std: Standard deviation of its error by noise, parameters and model error [N·m].
        stiction: Largest error by friction of joints that may stick [N·m].
        detected: Whether the torque is beyond stiction and noise.
    """

    torque: FloatArray
    std: FloatArray
    stiction: FloatArray
    detected: BoolArray


@dataclass(frozen=True, eq=False, repr=False)
class ObservedTorque:
    """Torque that acts on the leg from outside, over a log.

    Attributes:
        time: Time stamps of the log [s], (N,); a torque is known one delay after it acts.
        torque: Torque of the wearer on the leg [N·m], (N, n).
        std: Standard deviation of its error by noise, parameters and model error [N·m], (N, n).
        stiction: Largest error by friction of joints that may stick [N·m], (N, n).
        detected: Whether the torque is beyond stiction and noise, (N, n).
        joint_names: Joints, (n,).
        delay: Delay of the torque for slow signals [s], (n,).
        settling: Samples at the beginning that the observer needs to settle, without detection.
    """

    time: FloatArray
    torque: FloatArray
    std: FloatArray
    stiction: FloatArray
    detected: BoolArray
    joint_names: tuple[str, ...]
    delay: FloatArray
    settling: int

    @property
    def alarms(self) -> FloatArray:
        """Number of times that each joint is detected anew, (n,)."""
        before = np.vstack([np.zeros((1, self.detected.shape[1]), dtype=np.bool_), self.detected[:-1]])
        return np.asarray((self.detected & ~before).sum(axis=0), dtype=np.float64)

    def __len__(self) -> int:
        """Count the samples."""
        return len(self.time)

    def __repr__(self) -> str:
        """Write the size in one line."""
        return f"ObservedTorque({len(self)} samples; joints: {', '.join(self.joint_names)})"

    def __str__(self) -> str:
        """Print a table with a row for each joint, after the observer has settled."""
        headers = ("joint", "rms [N·m]", "peak [N·m]", "std [N·m]", "detected [%]", "alarms", "delay [ms]")
        torque = self.torque[min(self.settling, len(self) - 1) :]
        rms, share = np.sqrt(np.mean(torque**2, axis=0)), 100.0 * self.detected.mean(axis=0)
        std, peak = np.sqrt(np.mean(self.std**2, axis=0)), np.abs(torque).max(axis=0)
        rows = [
            (name, f"{a:.3g}", f"{b:.3g}", f"{c:.2g}", f"{d:.3g}", f"{e:.0f}", f"{1e3 * f:.3g}")
            for name, a, b, c, d, e, f in zip(
                self.joint_names, rms, peak, std, share, self.alarms, self.delay, strict=True
            )
        ]
        return to_text(make_table(headers, rows))
