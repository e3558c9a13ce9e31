"""What estimators need that fit samples, not rows: where to begin, derivatives, and rows linearised at a solution."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import NotSupportedError
from exoid.identification.problem import Problem
from exoid.regression.fit import wls
from exoid.regression.row_data import NoiseKind, RowBlock, Rows
from exoid.regression.rows import for_leg, rate_class
from exoid.signals import ZeroPhase, choose_cutoff
from exoid.torques import Motion, TorqueModel

STEPS = (1e-5, 1e-5, 1e-3)
"""Half of the central difference in angle, velocity and acceleration; the torque is linear in the last."""

T = TypeVar("T")


class LinearisedRows(NamedTuple):
    """Weighted residuals of measured channels, such as angles and torques, and their derivatives by β."""

    columns: Sequence[NDArray[np.intp]]  # parameters that act on each channel, as indices
    recordings: Sequence[RowBlock]  # rows of each recording

    @staticmethod
    def of(recordings: Sequence[RowBlock]) -> LinearisedRows:
        """Collect recordings; poses may have the first channels only."""
        channels = max(block.rows.W.shape[1] for block in recordings)
        every = np.arange(recordings[0].rows.W.shape[2])
        return LinearisedRows([every] * channels, recordings)

    def weight_index(self, kind: NoiseKind, joint: int) -> int:
        """All rows have one weight."""
        return 0

    def gather(self, work: Callable[[Iterable[RowBlock]], T]) -> Iterator[T]:
        """Let work go over the rows of each recording."""
        for block in self.recordings:
            yield work([block])


def linearised_block(
    W: FloatArray, residual: FloatArray, values: FloatArray, time: FloatArray | None, usable: FloatArray | None = None
) -> RowBlock:
    """Make a block of the rows of one recording."""
    stamps = np.arange(len(W), dtype=np.float64) if time is None else time
    kind = NoiseKind(time is None, rate_class(stamps))
    mask = np.ones(residual.shape, dtype=np.bool_) if usable is None else usable > 0.0
    acting = np.ones(W.shape[1:], dtype=np.bool_)
    still = np.zeros_like(residual)
    return RowBlock(kind, Rows(stamps, W, residual + W @ values, still, still, mask, acting, 1.0), True, True)


def default_preparation(problem: Problem) -> ZeroPhase:
    """How recordings are prepared by default."""
    return ZeroPhase(choose_cutoff([for_leg(problem.model, data) for data in problem.local_data]))


def default_start(problem: Problem) -> FloatArray:
    """β by weighted least squares on rows as they are prepared by default, whatever the problem's own preparation."""
    preparation = default_preparation(problem)
    if preparation != problem.preparation:
        problem = problem.changed(preparation=preparation)
    return wls(problem).solution.values


def refuse_other_friction(model: TorqueModel, estimator: str) -> None:
    """Refuse terms whose torque does not follow from the motion of the moment alone."""
    plain = type(model) is TorqueModel and not any(
        term.loaded or term.internal_state is not None or term.needs_temperature for term in model.terms
    )
    if not plain:
        raise NotSupportedError(
            f"{estimator} takes no friction that remembers, depends on load or temperature, or has free settings",
            remedy="use wls or huber, or give the settings numbers",
        )


class Response(NamedTuple):
    """Torque and its derivatives."""

    W: FloatArray  # regressor, (N, n, P)
    to_motion: FloatArray  # ∂τ_i / ∂(q, v, a)_j, (3, N, n, n): derivative, sample, torque, joint


def respond(model: TorqueModel, values: FloatArray, motion: Motion) -> Response:
    """Differentiate τ = W(q, v, a) β by central differences."""
    samples, joints = motion.q.shape
    to_motion = np.empty((3, samples, joints, joints))
    for kind, step in enumerate(STEPS):
        for joint in range(joints):
            sides = []
            for by in (step, -step):
                moved = [motion.q, motion.v, motion.a]
                moved[kind] = moved[kind].copy()
                moved[kind][:, joint] += by
                q, v, a = moved
                sides.append(torque(model.columns(Motion(q, v, a, motion.torso)), values))
            difference = sides[0] - sides[1]
            to_motion[kind, :, :, joint] = difference / (2.0 * step)
    return Response(model.columns(motion).transpose(2, 1, 0), to_motion)


def torque(columns: FloatArray, values: FloatArray) -> FloatArray:
    """W β, (N, n), from columns, (P, n, N)."""
    return np.asarray(np.tensordot(values, columns, axes=1).T)
