"""Logs of a laboratory: text with a line of names and a line of units."""

from pathlib import Path

import numpy as np

from exoid.signals import Source
from exoid.signals.readers import ArrayTable

TO_SI = {"s": 1.0, "ms": 1e-3, "rad": 1.0, "deg": np.pi / 180.0, "Nm": 1.0}
QUANTITIES = {"angle": "q", "torque": "tau"}


def read_lab(file, options):
    """Read columns such as "knee.angle" in "deg" as q_knee [rad]."""
    path = Path(file)
    names, units = (line.split() for line in path.read_text(encoding="utf-8").splitlines()[:2])
    numbers = np.loadtxt(path, skiprows=2, ndmin=2)
    columns = {}
    for name, unit, values in zip(names, units, numbers.T, strict=True):
        joint, _, quantity = name.rpartition(".")
        columns[f"{QUANTITIES[quantity]}_{joint}" if joint else name] = TO_SI[unit] * values
    lines = np.arange(3, 3 + len(numbers))
    return ArrayTable(file, Source.of(path), columns, lines, "line")
