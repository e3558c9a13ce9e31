"""Comparison of the torque that was measured and that an estimate predicts: their filter, and what is between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Actuators, Coupling, Drive
from exoid.errors import BadArgumentError
from exoid.regression.every_row import each_row
from exoid.regression.row_data import Rows
from exoid.regression.rows import Prepared
from exoid.signals import Preparation, Recording, ZeroPhase, without_torque_delay
from exoid.signals.cutoff import white_noise
from exoid.torques.contacts.elimination import eliminate

from .data import EstimateData
from .finding import Finding
from .late_velocity import late_velocities


class TorqueFilter(NamedTuple):
    """Filter that measured and predicted torque pass; prints itself.

    Attributes:
        preparation: Way from a recording to kinematics and filtered torques.
        source: "of the estimate" or "given".
        chosen: How the estimate's cut-off was chosen, with its value; "" where that is not known.
        comparable: Whether residuals compare with those of the training: both passed the same kind of filter.
    """

    preparation: Preparation
    source: str
    chosen: str
    comparable: bool = True

    @property
    def cutoff(self) -> float | None:
        """Cut-off frequency of the torques [Hz]; None for a preparation without one."""
        return self.preparation.cutoff if isinstance(self.preparation, ZeroPhase) else None

    def __str__(self) -> str:
        """Write filter and source in one phrase."""
        if self.cutoff is None:
            return f"prepared by {self.preparation.name} ({self.source})"
        if self.source == "given":
            estimates = f"; the estimate's is {self.chosen}" if self.chosen else ""
            return f"low-passed at {self.cutoff:.4g} Hz (given{estimates})"
        _, _, how = self.chosen.partition(", ")
        return f"low-passed at {self.cutoff:.4g} Hz (cut-off of the estimate{', ' + how if how else ''})"


def to_predict(
    estimate: EstimateData,
    recordings: Recording | Iterable[Recording],
    actuators: Mapping[str, Drive | Coupling] | Actuators | None,
    cutoff: float | None,
) -> tuple[EstimateData, list[tuple[Recording, list[Finding]]], TorqueFilter]:
    """Give an estimate the drives of recordings, bring these into the state of its training, and choose the filter."""
    # Torques are computed by the drives and shifted by the delays of the training, and late velocities are left out:
    # findings of each recording say so.
    if not isinstance(estimate, EstimateData):
        raise BadArgumentError(f"{estimate!r} is not of one leg", remedy='pass that of one group, estimate["left"]')
    several = list(recordings) if isinstance(recordings, Iterable) else [recordings]
    wrong = [item for item in several if not isinstance(item, Recording)]
    if wrong or not several:
        what = f"{wrong[0]!r} is no recording" if wrong else "no recordings"
        raise BadArgumentError(what, remedy='pass at least one, such as Recording.from_csv("log.csv")')
    if actuators is not None:
        estimate = replace(estimate, actuators=Actuators.of(estimate.model.leg, actuators))
    late = {joint: delay for joint, delay in enumerate(estimate.torque_delays.tolist()) if delay}
    ready = []
    for recording in several:
        read = recording if estimate.actuators is None else estimate.actuators.torque(recording)
        read = without_torque_delay(estimate.model.select(read), late) if late else read
        found, remedy = list[Finding](), "correct the time stamps of both logs, and identify without delay"
        for joint, delay in late.items():
            name = estimate.joint_names[joint]
            message = f"the torque of {name} was shifted by {1e3 * delay:.3g} ms, the delay of the training"
            found.append(Finding("torque-delay", name, delay, "s", "info", message, remedy))
        velocities = list(late_velocities(read))
        ready.append((replace(read, v=None, a=None) if velocities else read, [*found, *velocities]))
    own = estimate.preparation
    where = f", {estimate.evidence.cutoff_source}" if estimate.evidence.cutoff_source else ""
    chosen = f"{own.cutoff:.4g} Hz{where}" if isinstance(own, ZeroPhase) else ""
    if cutoff is None:
        return estimate, ready, TorqueFilter(own, "of the estimate", chosen)
    return estimate, ready, TorqueFilter(ZeroPhase(cutoff), "given", chosen, isinstance(own, ZeroPhase))


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
