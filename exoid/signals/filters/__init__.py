"""Low-pass filters: zero-phase, parallel (at the requested rows only), and moving average; rows without reversals."""

from .low_pass import (
    TOLERANCE,
    ParallelFilter,
    both_passes,
    design_frequency,
    edge_length,
    noise_bandwidth,
    reach,
    refuse_short,
    zero_phase,
    zero_phase_gain,
)
from .moving_average import exponential_moving_average
from .reversals import around_stops, reversal_pulses, without_reversals

__all__ = [
    "TOLERANCE",
    "ParallelFilter",
    "around_stops",
    "both_passes",
    "design_frequency",
    "edge_length",
    "exponential_moving_average",
    "noise_bandwidth",
    "reach",
    "refuse_short",
    "reversal_pulses",
    "without_reversals",
    "zero_phase",
    "zero_phase_gain",
]
