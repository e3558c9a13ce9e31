"""How far a predicted torque may be off: errors of the parameters, and friction of another form beyond the training."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.torques import Motion, Presliding
from exoid.torques.terms import SIGN_WIDTH

LENGTHS = (3e-3, 1e-2, 3e-2)  # presliding lengths [rad]
STRIBECK = (0.1, 0.3)  # Stribeck velocities, as parts of the largest speed of the training
KINDS: dict[str, tuple[int, ...]] = {"presliding": (0, 1, 2), "stribeck": (3, 4), "quadratic": (5,), "load": (6,)}
"""Columns of each form of friction."""

COUNT = sum(map(len, KINDS.values()))  # number K of columns of each joint


class TorqueBand(NamedTuple):
    """Predicted torque and the band around it [N·m], (N, n) each.

    Attributes:
        torque: Prediction.
        lower: Lower edge.
        upper: Upper edge.
    """

    torque: FloatArray
    lower: FloatArray
    upper: FloatArray


def parameter_variance(covariance: FloatArray, rows: FloatArray) -> FloatArray:
    """Variance w C wᵀ that the parameters' errors give a torque."""
    W = rows[..., : len(covariance)]
    return np.asarray(np.clip(((W @ covariance) * W).sum(axis=-1), 0.0, None))


@dataclass(frozen=True, eq=False)
class AlternativeFriction:
    """Columns of friction of other forms at each joint, K of them."""

    # Column k of joint j is the k-th alternative at this joint, with a coefficient of its own there: presliding z(q),
    # sgn(v) exp(−(v / vs)²), v |v| and sgn(v) |τ_rb|.

    rigid: FloatArray  # parameters of the rigid bodies, whose torque τ_rb loads the joints, (p,)
    speed: FloatArray  # largest speed of the training [rad/s], (n,)
    radian: FloatArray  # what counts as a radian, at a prismatic joint in m, (n,)

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Columns that can act on each joint: all, (n, K)."""
        return np.ones((len(self.speed), COUNT), dtype=np.bool_)

    @property
    def states(self) -> list[tuple[int, Presliding]]:
        """Presliding states of each joint."""
        return [(j, Presliding(radian * x)) for j, radian in enumerate(self.radian.tolist()) for x in LENGTHS]

    def fill(self, motion: Motion, columns: FloatArray, out: FloatArray) -> None:
        """Write the columns, of a floating base in the rows of its joints."""
        load = np.tensordot(self.rigid, columns[: len(self.rigid)], axes=1)
        if motion.payload is not None:
            load += motion.payload.T
        load = load[-len(self.speed) :]
        for j, of_joint in enumerate(np.moveaxis(out, 1, 0)[-len(self.speed) :]):
            v, smoothing = motion.v[:, j], SIGN_WIDTH * self.radian[j]
            sign, slow = np.tanh(v / smoothing), max(self.speed[j], smoothing)
            of_joint[:] = (
                *(motion.states[j, Presliding(float(self.radian[j]) * x)] for x in LENGTHS),
                *(sign * np.exp(-((v / (part * slow)) ** 2)) for part in STRIBECK),
                v * np.abs(v),
                sign * np.abs(load[j]),
            )


@dataclass(frozen=True, eq=False)
class ModelError:
    """Second moment of the torque that friction of other forms would add, after the parameters have absorbed theirs.

    A joint's torque may contain z c, with z the columns of :class:`.AlternativeFriction` and c unknown coefficients.
    The fit of the parameters alone absorbs w G c of it, with G the regression of z on the training's rows. The
    prediction then errs by (z − w G) c, which is as small as the residuals inside the training and grows beyond it.
    With E[c cᵀ] = L Lᵀ its second moment is ‖(z − w G) L‖² = ‖w A + z B‖².

    Attributes:
        speed: Largest speed of the training [rad/s], (n,).
        parameters: A, (P, r).
        alternatives: B of each joint, (n, K, r).
        explained: Mean second moment on the rows of the training [N²·m²], (n,): part of the residual variance.
    """

    speed: FloatArray
    parameters: FloatArray
    alternatives: FloatArray
    explained: FloatArray

    def __post_init__(self) -> None:
        """Check shapes and forbid changes."""
        joints, rank = len(self.speed), self.parameters.shape[1]
        fits = self.alternatives.shape == (joints, COUNT, rank) and self.explained.shape == (joints,)
        for array in (self.speed, self.parameters, self.alternatives, self.explained):
            if not (fits and np.isfinite(array).all()):
                raise BadArgumentError("the model error does not fit the estimate's joints", remedy="identify again")
            array.flags.writeable = False

    def variance(self, rows: FloatArray) -> FloatArray:
        """Compute the second moment of the error of torques, ‖w A + z B‖².

        Args:
            rows: Rows w of the model and z of the alternatives, filtered or not, (N, n, P + K); on the ground, where
                rows may combine joints, R rows with the alternatives of all joints, (N, R, P + n K).

        Returns:
            Second moment [N²·m²], (N, n) or (N, R).
        """
        w, z = np.split(rows, [len(self.parameters)], axis=-1)
        joints, count, rank = self.alternatives.shape
        if z.shape[-1] == joints * count:
            other = z @ self.alternatives.reshape(-1, rank)
        else:
            other = np.einsum("njk,jkr->njr", z, self.alternatives)
        return np.asarray(((w @ self.parameters + other) ** 2).sum(axis=-1))
