"""From recordings to the rows of the least-squares problem, and from rows to one small triangle a joint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import TorqueModel

SMALLEST_MOTION = 2e-3
"""A joint whose angle spans less than this [rad], about a tenth of a degree, counts as standing still."""


class Rows(NamedTuple):
    """Both sides of τ = W β for each sample and joint of one recording, filtered alike, ends removed.

    Attributes:
        time: [s], (N,).
        W: Regressor, (N, n, P).
        tau: Measured torque [N·m], (N, n).
        usable: Which samples of which joint may be fitted, (N, n).
        independence: Share of the samples that carry independent noise; a low-pass leaves fewer.
        stands_for: How many rows each of these stands for; 1 unless thinned.
    """

    time: FloatArray
    W: FloatArray
    tau: FloatArray
    usable: NDArray[np.bool_]
    independence: float
    stands_for: float = 1.0


class Triangle(NamedTuple):
    """All that least squares needs to know of the rows of one joint: R of the QR factorisation of [W τ].

    Attributes:
        R: Upper triangle, (P + 1, P + 1).
        rows: How many rows went in.
        samples: How many independent samples they amount to.
    """

    R: FloatArray
    rows: int
    samples: float

    def residual(self, values: FloatArray) -> float:
        """Root of the sum of squared residuals ‖W β − τ‖ [N·m]."""
        return float(np.linalg.norm(self.R @ np.append(values, -1.0)))


def make_rows(model: TorqueModel, data: Recording | Poses, preparation: Preparation) -> Rows:
    """Make the rows of a recording, or of poses."""
    return static_rows(model, data) if isinstance(data, Poses) else dynamic_rows(model, data, preparation)


def static_rows(model: TorqueModel, poses: Poses) -> Rows:
    """Rows of a leg at rest: no velocity, no acceleration, nothing to filter."""
    poses = for_leg(model, poses)
    still = np.zeros_like(poses.q)
    W, tau = without_known(model, model.regressor(poses.q, still, still, poses.torso), poses.tau)
    return Rows(np.arange(len(poses), dtype=np.float64), W, tau, np.ones(poses.q.shape, dtype=np.bool_), 1.0)


def dynamic_rows(model: TorqueModel, recording: Recording, preparation: Preparation) -> Rows:
    """Form regressor columns from the kinematics, then pass columns and torque through the same filter.

    Raises:
        ExoidError: The recording has no torque, lacks a joint of the leg, or is too short for the filter.
    """
    recording = for_leg(model, recording).resampled()
    if recording.tau is None:
        raise ExoidError(
            "there is no torque in the recording",
            where=_sources([recording]),
            remedy=f"record tau, in columns {', '.join('tau_' + n for n in recording.joint_names)}",
        )
    rate = recording.sample_rate
    q, v, a, valid = preparation.kinematics(recording)
    W = preparation.filter_columns(model.regressor(q, v, a, recording.torso), rate)
    W, tau = without_known(model, W, preparation.filter(recording.tau, rate))
    return Rows(recording.time[valid], W[valid], tau[valid], model.usable(v)[valid], preparation.independence(rate))


def without_known(model: TorqueModel, W: FloatArray, tau: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Take torque that is known, columns beyond those of the parameters, to the other side."""
    count = len(model.names)
    return (W[..., :count], tau - W[..., count:].sum(axis=2)) if W.shape[2] > count else (W, tau)


def thin(rows: Rows) -> Rows:
    """Keep every m-th row, m = ⌊1 / independence⌋.

    Behind a low-pass the rows between are redundant, and what noise is left is nearly white at this pace, so that a
    simple model describes it: at the full pace the same model would spend its order on the edge of the filter.
    """
    step = max(1, int(1.0 / rows.independence))
    if step == 1:
        return rows
    kept = slice((len(rows.time) - 1) % step // 2, None, step)
    count = len(rows.time[kept])
    return Rows(
        rows.time[kept],
        rows.W[kept].copy(order="A"),
        rows.tau[kept].copy(),
        rows.usable[kept].copy(),
        min(1.0, rows.independence * step),
        len(rows.time) / count,
    )


Measured = TypeVar("Measured", Recording, Poses, Recording | Poses)


def for_leg(model: TorqueModel, recording: Measured) -> Measured:
    """Pick the leg's joints from a recording or poses, by name.

    Raises:
        ExoidError: A joint is missing.
    """
    names = model.leg.joint_names
    if set(names) <= set(recording.joint_names):
        return recording.select(names)
    labels = model.leg.joint_labels
    if set(labels) <= set(recording.joint_names):
        return recording.select(labels)
    missing = [name for name in names if name not in recording.joint_names]
    raise ExoidError(
        f"the leg's {', '.join(missing)} not in the recording, which has {', '.join(recording.joint_names)}",
        where=_sources([recording]),
        remedy="rename its columns, or map them: columns={'q_" + missing[0] + "': '<header>', ...}",
    )


def refuse_dead_torques(model: TorqueModel, recordings: Sequence[Recording | Poses]) -> None:
    """Refuse recordings in which the torque of a joint never changes: a channel that was not connected.

    Raises:
        ExoidError: Names the joint and the value.
    """
    chosen = [for_leg(model, recording) for recording in recordings]
    present = [recording.tau for recording in chosen if recording.tau is not None]
    if not present:
        return  # making rows says so, and which column is missing
    torques = np.vstack(present)
    for joint, torque in zip(model.leg.joint_names, torques.T, strict=True):
        if np.ptp(torque) == 0.0:
            raise ExoidError(
                f"the torque of joint {joint} is {torque[0] + 0.0:.6g} N·m in every sample although the joint moves",
                where=_sources(recordings),
                remedy="connect its torque channel, or map the right column to tau_" + joint,
            )


def make_triangles(rows: Rows) -> list[Triangle]:
    """Reduce the rows of each joint to a triangle."""
    triangles = []
    for joint in range(rows.tau.shape[1]):
        use = rows.usable[:, joint]
        table = np.column_stack([rows.W[use, joint], rows.tau[use, joint]])
        triangles.append(make_triangle(table, int(use.sum()), float(use.sum()) * rows.independence))
    return triangles


def make_triangle(table: FloatArray, rows: int, samples: float) -> Triangle:
    """Factorise rows of [W τ]."""
    width = table.shape[1]
    if len(table) < width:
        table = np.vstack([table, np.zeros((width - len(table), width))])
    return Triangle(np.asarray(np.linalg.qr(table, mode="r")), rows, samples)


def rms_residual(triangles: Sequence[Triangle], values: FloatArray) -> float:
    """RMS residual over the rows of several triangles [N·m]."""
    squares = sum(triangle.residual(values) ** 2 for triangle in triangles)
    return float(np.sqrt(squares / max(sum(triangle.rows for triangle in triangles), 1)))


def join(triangles: Sequence[Triangle], weights: Sequence[float] | None = None) -> Triangle:
    """Combine triangles, each multiplied by its weight, into the triangle of all their rows."""
    weights = [1.0] * len(triangles) if weights is None else weights
    table = np.vstack([weight * triangle.R for weight, triangle in zip(weights, triangles, strict=True)])
    return make_triangle(table, sum(t.rows for t in triangles), sum(t.samples for t in triangles))


def refuse_still_joints(model: TorqueModel, recordings: Sequence[Recording | Poses]) -> None:
    """Refuse recordings in which a joint of the leg never moves.

    Raises:
        ExoidError: Names the joint, how little it moves, and how to lock it.
    """
    angles = np.vstack([for_leg(model, recording).q for recording in recordings])
    for joint, span, mean in zip(model.leg.joint_names, np.ptp(angles, axis=0), angles.mean(axis=0), strict=True):
        if span < SMALLEST_MOTION:
            others = tuple(name for name in model.leg.joint_names if name != joint)
            raise ExoidError(
                f"joint {joint} stands still: its angle spans {span:.2g} rad, so nothing of it can be identified",
                where=_sources(recordings),
                remedy=f"move it, or lock it: Leg.from_urdf(..., joints={others}, locked={{{joint!r}: {mean:.4g}}})",
            )


def refuse_empty_joints(model: TorqueModel, triangles: Sequence[Triangle]) -> None:
    """Refuse a fit in which the terms' dead bands left no sample of a joint.

    Raises:
        ExoidError: Names the joints.
    """
    empty = [joint for joint, triangle in zip(model.leg.joint_names, triangles, strict=True) if triangle.rows == 0]
    if empty:
        raise ExoidError(
            f"no sample of {', '.join(empty)} is faster than the dead band of its friction term",
            remedy="move faster, or choose a smaller dead_band",
        )


def _sources(recordings: Sequence[Recording | Poses]) -> str:
    return ", ".join(recording.source.name for recording in recordings if recording.source)
