"""Measured and predicted torque of a recording, filtered alike, with the variance between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.regression.every_row import each_row
from exoid.regression.row_data import Rows
from exoid.regression.rows import Prepared
from exoid.signals import Preparation, Recording
from exoid.signals.cutoff import white_noise
from exoid.torques.contacts.elimination import eliminate

from .data import EstimateData


class Compared(NamedTuple):
    """Measured and predicted torques, filtered alike."""

    time: FloatArray  # samples that are compared [s], (N,)
    measured: FloatArray  # measured torque [N·m], (N, n)
    predicted: FloatArray  # predicted torque [N·m], (N, n)
    variance: FloatArray  # variance of the measured torque about the predicted one [N²·m²], (N, n)
    known: FloatArray  # part of both that is known: torque of measured wrenches and of payloads [N·m], (N, n)


def compare_rows(
    estimate: EstimateData, prepared: Prepared, recording: Recording, preparation: Preparation, bandwidth: float
) -> Iterator[tuple[Rows, Compared]]:
    """Predict the torque of a recording that no unknown wrench holds, stretch by stretch, with the rows of a band."""
    for rows in each_row(estimate.band_model, prepared):
        known = np.zeros_like(rows.tau) if rows.known is None else rows.known
        predicted = rows.W[..., : len(estimate.values)] @ estimate.values + known
        variance = estimate.measured_variance(rows.W, bandwidth)
        variance = variance + wrench_variance(estimate, recording, preparation, rows.q)
        yield rows, Compared(rows.time, rows.tau + known, predicted, variance, known)


def wrench_variance(
    estimate: EstimateData,
    recording: Recording,
    preparation: Preparation,
    q: FloatArray,
    links: Sequence[str] = (),
    axes: FloatArray | None = None,
) -> FloatArray:
    """Variance of rows by white noise of measured wrenches, Σ (Jᵀ)² σ² behind the filter, (N, R)."""
    # On a fixed base, residuals of the training have this noise where wrenches on the same links were measured. On a
    # floating one, the rows of joints were without wrenches.
    leg = estimate.model.leg
    trained = {link for each in estimate.inputs for link in each.wrenches if not leg.base_rows}
    variance = np.zeros((1, 1) if links else (len(q), leg.base_rows + len(leg.joint_names)))
    for link, wrench in recording.wrenches.items():
        if link not in trained:
            columns = leg.frame_jacobian(q, link, wrench.point).transpose(1, 2, 0)
            columns = eliminate(leg, links, q, axes).of(columns) if links else columns
            std = white_noise(np.hstack([wrench.force, wrench.moment]))
            variance = variance + np.einsum("crn,c->nr", columns**2, std**2)
    return np.asarray(preparation.independent_fraction(recording.sample_rate) * variance)
