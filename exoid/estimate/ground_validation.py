"""Prediction of the torques of a leg that stands, without what forces of the ground may add to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.regression.every_row import make_rows
from exoid.regression.intervals import half_width
from exoid.regression.rows import for_leg, source_of
from exoid.signals import Preparation, Recording
from exoid.signals.contacts import depends_on_contacts
from exoid.signals.cutoff import white_noise
from exoid.torques.contacts import split
from exoid.torques.contacts.elimination import eliminate, reference_axes
from exoid.torques.contacts.stretches import Stretch
from exoid.torques.contacts.support_model import LOOP, SupportModel

from .data import EstimateData
from .torque_band import parameter_variance

LEVEL = 0.95  # probability that a band contains a measured torque
T = TypeVar("T", bound=tuple[FloatArray, ...])


class StandingTorques(NamedTuple):
    """Torques that an estimate predicts for a leg on the ground.

    Attributes:
        time: Samples at which they follow from the motion [s], (N,).
        torque: Torques of the joints [N·m], (N, n).
        half: Half the width of the 95 % band of a measured torque [N·m], (N, n).
    """

    time: FloatArray
    torque: FloatArray
    half: FloatArray


class Compared(NamedTuple):
    """Measured and predicted torques, filtered alike."""

    time: FloatArray  # samples that are compared [s], (N,)
    measured: FloatArray  # measured torque [N·m], (N, n)
    predicted: FloatArray  # predicted torque [N·m], (N, n)
    variance: FloatArray  # variance of the measured torque about the predicted one [N²·m²], (N, n)
    known: FloatArray  # part of both that is known: torque of measured wrenches and of payloads [N·m], (N, n)


def stands(estimate: EstimateData, recording: Recording) -> bool:
    """Tell whether a recording has to be split by the links that rest on the ground."""
    return bool(estimate.model.leg.base_rows) or depends_on_contacts(recording)


def compare_on_ground(
    estimate: EstimateData,
    recording: Recording,
    preparation: Preparation,
    bandwidth: float,
    *,
    unknown_wrenches: bool = True,
) -> Compared:
    """Predict the torques of a recording with contacts."""
    # Where one link rests by an unknown wrench, the base hangs on it, and each joint has a torque. Where
    # several do, only the part Z Zᵀ τ can be predicted, on which no force of the ground does work: that is
    # compared.
    leg = estimate.model.leg
    stretches = split(leg, for_leg(estimate.model, recording), preparation).stretches
    if not unknown_wrenches:
        resting = {link for stretch in stretches for link in stretch.links} - {leg.description.root_link}
        stretches = tuple(each for each in stretches if not {*each.links} & resting)
        if not stretches:
            raise NotSupportedError(
                f"{', '.join(sorted(resting))} on the ground throughout, and the wrenches there were not measured",
                where=source_of(recording),
                remedy=f"record the wrenches (columns wrench_{min(resting)}_fx to _mz), or the leg in the air",
            )
    return in_time_order([_compare(estimate, stretch, preparation, bandwidth) for stretch in stretches])


def in_time_order(parts: Sequence[T]) -> T:
    """Put arrays of several stretches together, in order of the time that stands first."""
    order = np.argsort(np.concatenate([part[0] for part in parts]), kind="stable")
    return type(parts[0])(*(np.concatenate(arrays)[order] for arrays in zip(*parts, strict=True)))


def joint_torques(estimate: EstimateData, recording: Recording) -> StandingTorques:
    """Predict the joint torques of a leg on the ground from its motion, and from wrenches where they were measured.

    τ = W_q β − Σ J_qᵀ w_c for measured wrenches w_c. Where one link rests by an unknown wrench, the equation of the
    base gives it. Where several do, the torques do not follow from the motion, and the samples are left out.

    Args:
        estimate: The estimate.
        recording: Motion with contacts or wrenches; its torques are not used.

    Returns:
        Torques, low-passed as rows of the estimate are.

    Raises:
        ExoidError: Several links rest by unknown wrenches throughout, or nothing else is left of the recording.
    """
    model = estimate.model
    silent = replace(for_leg(model, recording), tau=np.zeros_like(recording.q))
    found = []
    for stretch in split(model.leg, silent, estimate.preparation).stretches:
        axes = reference_axes(model.leg, stretch.links, silent.q) if stretch.links else None
        if axes is not None:
            continue
        support = SupportModel.of(model.loaded_by(estimate.values), stretch.links, None)
        rows = make_rows(support, stretch.recording, estimate.preparation)
        joints = slice(rows.tau.shape[1] - len(model.joint_names), None)
        torque = (rows.W @ estimate.values - rows.tau)[:, joints]
        noise = _noise(estimate, support.row_names)[joints]
        variance = parameter_variance(estimate.covariance, rows.W[:, joints]) + noise
        found.append(StandingTorques(rows.time, torque, half_width(LEVEL, estimate.dof) * np.sqrt(variance)))
    if not found:
        raise NotSupportedError(
            "several links rest by unknown wrenches throughout, and torques do not follow from the motion",
            where=source_of(recording),
            remedy="measure the wrenches, or record motions on one foot",
        )
    return in_time_order(found)


def _compare(estimate: EstimateData, stretch: Stretch, preparation: Preparation, bandwidth: float) -> Compared:
    """Predict the torques while the same links rest."""
    model, links, recording = estimate.model, stretch.links, stretch.recording
    axes = reference_axes(model.leg, links, recording.q[recording.mask]) if links else None
    support = SupportModel.of(model.loaded_by(estimate.values), links, axes)
    rows = make_rows(support, recording, preparation)
    known = np.zeros_like(rows.tau) if rows.known is None else rows.known
    measured, predicted = rows.tau + known, rows.W @ estimate.values + known
    q = recording.q[np.searchsorted(recording.time, rows.time)]
    variance = parameter_variance(estimate.covariance, rows.W) + bandwidth * _noise(estimate, support.row_names)
    variance = variance + wrench_variance(estimate, recording, preparation, q, links, axes)
    if axes is not None:
        loop = eliminate(model.leg, links, q, axes).loop
        assert loop is not None
        parts = (np.einsum("njr,nr->nj", loop, part) for part in (measured, predicted, known))
        measured, predicted, known = parts
        variance = np.einsum("njr,nr->nj", loop**2, variance)
    joints = slice(measured.shape[1] - len(model.joint_names), None)  # rows of the base stand before them, if any
    return Compared(rows.time, *(part[:, joints] for part in (measured, predicted, variance, known)))


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


def _noise(estimate: EstimateData, row_names: tuple[str, ...]) -> FloatArray:
    """Variance of the noise of each row: that of its joint, or of closed chains the mean of all joints, (R,)."""
    squares = estimate.residual_rms**2
    lost = (estimate.dof + len(estimate.values)) / estimate.dof
    of_joints = dict(zip(estimate.joint_names, squares.tolist(), strict=True))
    whole = float(squares.mean())
    return lost * np.array([whole if name.startswith(LOOP) else of_joints.get(name, 0.0) for name in row_names])
