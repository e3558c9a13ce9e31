"""Recursive estimator of ``exoid export --recursive``."""

from __future__ import annotations

from exoid.estimate import Estimate
from exoid.online import RecursiveEstimator
from exoid.online.in_c import RecursiveSource, write_recursive

RATE, CUTOFF = 500.0, 8.0
"""Sampling rate and cut-off [Hz]: those of :class:`exoid.online.RecursiveEstimator`."""


def export_recursive(
    estimate: Estimate, path: str, rate: float | None, cutoff: float | None, forgetting: str
) -> RecursiveSource:
    """Write a recursive estimator of the parameters of an estimate as C."""
    online = RecursiveEstimator(
        estimate.leg,
        estimate.model.terms,
        rate=RATE if rate is None else rate,
        cutoff=CUTOFF if cutoff is None else cutoff,
        forgetting=forgetting,
    )
    return write_recursive(path, online)
