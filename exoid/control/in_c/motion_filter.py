"""Constants of the motion filter in C."""

from __future__ import annotations

import numpy as np

from exoid.codegen.laws import ArrayInC
from exoid.control.motion_filter import MotionFilter


def filter_tables(law: MotionFilter) -> tuple[ArrayInC, ...]:
    """Write the constants of the filter."""
    step = law.pole / law.rate
    constants = {
        "filter_delay": (law.delay, "delay 2/lambda of the motion filter [s]"),
        "filter_rate": (law.rate, "sampling rate [Hz]"),
        "filter_zz": (np.exp(-step) * (1.0 + step), "exp(-lambda T) (1 + lambda T)"),
        "filter_zw": (np.exp(-step) / law.rate, "exp(-lambda T) T [s]"),
        "filter_wz": (-np.exp(-step) * law.pole * step, "-exp(-lambda T) lambda^2 T [1/s]"),
        "filter_ww": (np.exp(-step) * (1.0 - step), "exp(-lambda T) (1 - lambda T)"),
    }
    return tuple(ArrayInC(name, what, np.array(float(value))) for name, (value, what) in constants.items())
