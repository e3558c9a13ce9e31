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
    """Write a recursive estimator of the parameters of an estimate as C.

    Args:
        estimate: The estimate, of which leg and terms are used.
        path: Source to write.
        rate: Sampling rate [Hz]; None for the default.
        cutoff: Cut-off of the filter [Hz]; None for the default.
        forgetting: "directional", "exponential" or "none". Unless it is "none", changes are detected.

    Returns:
        What was written.

    Raises:
        ExoidError: A setting or a term has no form in C, or the file cannot be written.
    """
    online = RecursiveEstimator(
        estimate.leg,
        estimate.model.terms,
        rate=RATE if rate is None else rate,
        cutoff=CUTOFF if cutoff is None else cutoff,
        forgetting=forgetting,
    )
    return write_recursive(path, online)
