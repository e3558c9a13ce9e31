r"""The planar chain: its geometry, and its documented regressor in batched closed form.

In the plane of motion a vector (x, z) is the complex number x + i z. With absolute angles φ_j and the vector d_j from
joint j to joint j+1 at the zero pose, the mass moment h_j = Y_j − i X_j of segment j (with what hangs below it) enters
the torque of joint k ≤ j as

    τ_k = s_k Re{ h_j [ e^{iφ_j} · i conj(p̈_j + i g) + e^{iφ_j}(φ̈_j + i φ̇_j²) · conj(r_kj) ] },

where p̈_j is the acceleration of joint j's origin, r_kj the vector from joint k to joint j, and s_k = ±1 the sign of
its axis. Its inertia enters as s_k J_j φ̈_j. For three segments these are doc. 1, eqs. (10)-(12); for two with
s = (1, −1), doc. 2, eqs. (7)-(8) as repaired.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from .._typing import FloatArray

GRAVITY = 9.81
"""Standard of the documents and of Pinocchio [m/s²]."""

BLOCK = 4096
"""Samples worked on at once: the temporaries of one block stay in the processor's cache."""

TOLERANCE = 1e-9


class Plane(NamedTuple):
    """Directions of the sagittal plane in the base frame.

    Attributes:
        forward: x.
        lateral: y; positive rotation is about −lateral.
        up: z, against gravity.
    """

    forward: FloatArray
    lateral: FloatArray
    up: FloatArray


class TorsoSamples(NamedTuple):
    """Motion of the torso at each sample, see :class:`exoid.TorsoMotion`; every array is (N,)."""

    pitch: FloatArray
    pitch_rate: FloatArray
    pitch_acceleration: FloatArray
    hip_acceleration_x: FloatArray
    hip_acceleration_z: FloatArray


@dataclass(frozen=True, eq=False)
class PlanarChain:
    """Geometry of a serial chain of revolute joints whose axes are horizontal and parallel.

    Attributes:
        plane: The plane of motion.
        signs: s_k = +1 where the axis is −lateral, −1 where it is +lateral, (n,).
        offsets: d_j, from joint j to joint j+1 at the zero pose, (x, z) [m], (n−1, 2).
        rotations: Orientation of each joint frame at the zero pose, (n, 3, 3).
    """

    plane: Plane
    signs: FloatArray
    offsets: FloatArray
    rotations: FloatArray

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.signs)

    @classmethod
    def from_model(cls, model: pin.Model) -> PlanarChain | None:
        """Read the geometry from a model; None where it is not such a chain."""
        n = model.njoints - 1
        serial = list(model.parents)[1:] == list(range(n)) and list(model.nvs)[1:] == [1] * n
        gravity = model.gravity.linear
        if not serial or n == 0 or abs(np.linalg.norm(gravity) - GRAVITY) > TOLERANCE:
            return None
        data = model.createData()
        pin.computeJointJacobians(model, data, pin.neutral(model))
        joints = range(1, n + 1)
        axes = np.array(
            [pin.getJointJacobian(model, data, j, pin.LOCAL_WORLD_ALIGNED)[:, j - 1] for j in joints]
        )
        plane = _plane(axes[0, 3:], -gravity / GRAVITY)
        signs = -np.round(axes[:, 3:] @ plane.lateral)
        parallel = np.allclose(axes[:, 3:], -signs[:, None] * plane.lateral, atol=TOLERANCE) and signs.all()
        if not parallel or abs(plane.lateral @ plane.up) > TOLERANCE:
            return None
        origins = np.array([data.oMi[j].translation for j in joints])
        offsets = np.diff(origins, axis=0) @ np.column_stack([plane.forward, plane.up])
        return cls(plane, signs, offsets, np.array([data.oMi[j].rotation for j in joints]))


def fill_regressor(
    chain: PlanarChain,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    out: FloatArray,
    *,
    cumulative: bool,
    torso: TorsoSamples | None = None,
) -> None:
    """Write the documented regressor for (X1, Y1, J1, X2, …) of every sample.

    Args:
        chain: The geometry.
        q: Joint angles [rad], (N, n).
        v: Joint velocities [rad/s], (N, n).
        a: Joint accelerations [rad/s²], (N, n).
        out: Receives W, zeroed, (3 n, n, N): parameters first, samples last, so that each column is contiguous.
        cumulative: Whether J_j contains J_{j+1} (doc. 1, eqs. (8)-(9)) or not (doc. 2, Table I).
        torso: Motion of the torso; None where it stands upright and still.
    """
    for start in range(0, len(q), BLOCK):
        rows = slice(start, start + BLOCK)
        moved = None if torso is None else TorsoSamples(*(x[rows] for x in torso))
        joints_first = (np.ascontiguousarray(x[rows].T) for x in (q, v, a))
        _fill_block(chain, *joints_first, out[..., rows], cumulative, moved)


def _fill_block(
    chain: PlanarChain,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    out: FloatArray,
    cumulative: bool,
    torso: TorsoSamples | None,
) -> None:
    """Fill the columns of one block of samples, from the hip downwards; q, v, a are (n, B)."""
    angle, rate, acceleration = np.zeros((3, q.shape[1]))
    origin_x, origin_z = np.zeros(q.shape[1]), np.full(q.shape[1], GRAVITY)  # p̈ + i g of the joint's origin
    if torso is not None:
        angle, rate, acceleration = torso.pitch, torso.pitch_rate, torso.pitch_acceleration
        origin_x, origin_z = torso.hip_acceleration_x, torso.hip_acceleration_z + GRAVITY
    reaches: list[tuple[FloatArray, FloatArray]] = []  # r_kj for each k < j
    for j, sign in enumerate(chain.signs):
        X, Y, J = out[3 * j : 3 * j + 3]
        angle, rate, acceleration = angle + sign * q[j], rate + sign * v[j], acceleration + sign * a[j]
        c, s = _cosine_and_sine(angle)
        squared = rate * rate
        turn_x = c * acceleration - s * squared  # e^{iφ}(φ̈ + i φ̇²)
        turn_z = s * acceleration + c * squared
        fall_X = np.add(s * origin_z, c * origin_x, out=X[j])  # moment of what the origin's acceleration asks
        fall_Y = np.subtract(c * origin_z, s * origin_x, out=Y[j])
        J[j] = acceleration
        for k, (x, z) in enumerate(reaches):
            np.add(fall_X, turn_z * x - turn_x * z, out=X[k])
            np.add(fall_Y, turn_x * x + turn_z * z, out=Y[k])
            J[k] = sign * a[j] if cumulative else acceleration
        if j + 1 < chain.n:
            x, z = chain.offsets[j]
            arm_x, arm_z = c * x - s * z, c * z + s * x  # d e^{iφ}
            reaches = [(reach_x + arm_x, reach_z + arm_z) for reach_x, reach_z in reaches]
            reaches.append((arm_x, arm_z))
            origin_x = origin_x - (turn_z * x + turn_x * z)  # p̈ += i d e^{iφ}(φ̈ + i φ̇²)
            origin_z = origin_z + (turn_x * x - turn_z * z)
    for k in np.flatnonzero(chain.signs < 0.0):
        out[:, k] *= -1.0


def _cosine_and_sine(angle: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Both from t = tan(φ/2), (1 − t²)/(1 + t²) and 2t/(1 + t²): one vectorised call instead of two slow ones."""
    t = np.tan(0.5 * angle)
    squared = t * t
    scale = 1.0 / (1.0 + squared)
    return (1.0 - squared) * scale, (t + t) * scale


def _plane(axis: FloatArray, up: FloatArray) -> Plane:
    lateral = axis / np.linalg.norm(axis)
    lateral = lateral * np.sign(lateral[np.argmax(np.abs(lateral))])
    return Plane(np.cross(lateral, up), lateral, up)
