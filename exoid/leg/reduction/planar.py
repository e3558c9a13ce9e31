r"""Planar chain: its geometry, and its documented regressor in batched closed form.

In the plane of motion a vector (x, z) is the complex number x + i z. Let φ_j be the absolute angles and d_j the vector
from joint j to joint j+1 at the zero pose. The mass moment h_j = Y_j − i X_j of segment j, with all segments below it,
enters the torque of joint k ≤ j as

    τ_k = s_k Re{ h_j [ e^{iφ_j} · i conj(p̈_j + i g) + e^{iφ_j}(φ̈_j + i φ̇_j²) · conj(r_kj) ] },

where p̈_j is the acceleration of joint j's origin, r_kj the vector from joint k to joint j, and s_k = ±1 the sign of
its axis. The inertia enters as s_k J_j φ̈_j. For three segments these are doc. 1, eqs. (10)-(12); for two with
s = (1, −1), doc. 2, eqs. (7)-(8) as corrected.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.tools.numbers import ROUNDED

GRAVITY = 9.81
"""Gravity of the documents and of Pinocchio [m/s²]."""

BLOCK = 8192
"""Samples computed at once: the temporaries of one block stay in the processor's cache."""


class Plane(NamedTuple):
    """Directions of the sagittal plane in the base frame.

    Attributes:
        forward: Direction x, (3,).
        lateral: Direction y, (3,); positive rotation is about −lateral.
        up: Direction z against gravity, (3,).
    """

    forward: FloatArray
    lateral: FloatArray
    up: FloatArray


class TorsoSamples(NamedTuple):
    """Motion of the torso at N samples, see :class:`exoid.TorsoMotion`."""

    pitch: FloatArray  # tilt [rad], (N,)
    pitch_rate: FloatArray  # rate of the tilt [rad/s], (N,)
    pitch_acceleration: FloatArray  # acceleration of the tilt [rad/s²], (N,)
    hip_acceleration_x: FloatArray  # forward acceleration of the first joint's origin [m/s²], (N,)
    hip_acceleration_z: FloatArray  # upward acceleration of the first joint's origin [m/s²], (N,)


@dataclass(frozen=True, eq=False)
class PlanarChain:
    """Geometry of a serial chain of revolute joints whose axes are horizontal and parallel."""

    plane: Plane  # plane of motion
    signs: FloatArray  # sign s_k of each axis: +1 along −lateral, −1 along +lateral, (n,)
    offsets: FloatArray  # vectors d_j from joint j to joint j+1 at the zero pose, (x, z) [m], (n−1, 2)
    rotations: FloatArray  # orientation of each joint frame at the zero pose, (n, 3, 3)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.signs)

    @classmethod
    def of_joints(cls, model: pin.Model, joints: range) -> PlanarChain | None:
        """Read the geometry of some joints of a model."""
        parents, freedoms = ([list(x)[j] for j in joints] for x in (model.parents, model.nvs))
        serial = parents == [0, *joints[:-1]] and set(freedoms) == {1} if joints else False
        gravity = model.gravity.linear
        if not serial or set(model.nvs[1:]) != {1} or abs(np.linalg.norm(gravity) - GRAVITY) > ROUNDED:
            return None
        data = model.createData()
        pin.computeJointJacobians(model, data, pin.neutral(model))
        jacobians = [pin.getJointJacobian(model, data, j, pin.LOCAL_WORLD_ALIGNED).reshape(6, model.nv) for j in joints]
        axes = np.array([jacobian[:, j - 1] for j, jacobian in zip(joints, jacobians, strict=True)])
        if not axes[:, 3:].any(axis=1).all():  # a prismatic joint
            return None
        lateral = axes[0, 3:] / np.linalg.norm(axes[0, 3:])
        lateral, up = lateral * np.sign(lateral[np.argmax(np.abs(lateral))]), -gravity / GRAVITY
        plane = Plane(np.cross(lateral, up), lateral, up)
        signs = -np.round(axes[:, 3:] @ plane.lateral)
        parallel = np.allclose(axes[:, 3:], -signs[:, None] * plane.lateral, atol=ROUNDED) and signs.all()
        if not parallel or abs(plane.lateral @ plane.up) > ROUNDED:
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
    force: FloatArray | None = None,
) -> None:
    """Write the documented regressor for (X1, Y1, J1, X2, …) of every sample, and forces on the hip for X and Y."""
    signs, offsets = chain.signs.tolist(), [complex(*offset) for offset in chain.offsets]
    reserve = np.empty((4 + len(signs), min(BLOCK, len(q))), dtype=np.complex128)  # once: fresh memory costs time
    for start in range(0, len(q), BLOCK):
        rows = slice(start, start + BLOCK)
        part, still = out[..., rows], np.zeros((3, len(q[rows])))
        angle, rate, acceleration = still if torso is None else np.array([x[rows] for x in torso[:3]])  # φ_j, its rates
        # i conj(p̈_j + i g), e^{iφ_j}, e^{iφ_j}(φ̈_j + i φ̇_j²), a part of the factor of h_j, and conj(d_k e^{iφ_k})
        origin, direction, turn, moment, *levers = reserve[:, : len(q) - start]
        origin[:] = GRAVITY
        if torso is not None:
            origin += torso.hip_acceleration_z[rows] + 1j * torso.hip_acceleration_x[rows]
        for j, sign in enumerate(signs):
            for absolute, own in ((angle, q), (rate, v), (acceleration, a)):
                np.add(absolute, sign * own[rows, j], out=absolute)
            cosine_and_sine(angle, out=(direction.real, direction.imag))
            turn.real, turn.imag = acceleration, rate**2
            np.multiply(turn, direction, out=turn)
            np.multiply(direction, origin, out=moment)
            X, Y, J = part[3 * j : 3 * j + 3]
            X[j], Y[j], J[j] = moment.imag, moment.real, acceleration
            for k in range(j - 1, -1, -1):  # each joint above has the lever of one more segment
                np.multiply(turn, levers[k], out=moment)
                np.add(X[k + 1], moment.imag, out=X[k])
                np.add(Y[k + 1], moment.real, out=Y[k])
                J[k] = sign * a[rows, j] if cumulative else acceleration
            if force is not None:  # i h e^{iφ}(φ̈ + i φ̇²) of the mass moment h = Y − i X
                force[3 * j, :, rows], force[3 * j + 1, :, rows] = (turn.real, turn.imag), (-turn.imag, turn.real)
            if j + 1 < len(signs):
                np.conjugate(np.multiply(direction, offsets[j], out=direction), out=levers[j])
                origin += np.conjugate(np.multiply(turn, offsets[j], out=turn), out=turn)  # i d e^{iφ}(φ̈ + i φ̇²)
        for joint in np.flatnonzero(chain.signs < 0.0):
            part[3 * joint :, joint] *= -1.0


def cosine_and_sine(angle: FloatArray, out: tuple[FloatArray, FloatArray]) -> None:
    """Compute 2/(1 + t²) − 1 and 2t/(1 + t²) with t = tan(φ/2): a third of the time of cos and sin."""
    t = np.tan(0.5 * angle)
    double = 2.0 / (1.0 + t * t)
    np.subtract(double, 1.0, out=out[0])
    np.multiply(double, t, out=out[1])
