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

from exoid._typing import ComplexArray, FloatArray

GRAVITY = 9.81
"""Gravity of the documents and of Pinocchio [m/s²]."""

BLOCK = 8192
"""Samples computed at once: the temporaries of one block stay in the processor's cache."""

TOLERANCE = 1e-9
"""Largest error of parallel axes and of gravity."""


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
    def from_model(cls, model: pin.Model) -> PlanarChain | None:
        """Read the geometry from a model."""
        return cls.of_joints(model, range(1, model.njoints))

    @classmethod
    def of_joints(cls, model: pin.Model, joints: range) -> PlanarChain | None:
        """Read the geometry of some joints of a model."""
        parents, freedoms = ([list(x)[j] for j in joints] for x in (model.parents, model.nvs))
        serial = parents == [0, *joints[:-1]] and set(freedoms) == {1} if joints else False
        gravity = model.gravity.linear
        if not serial or set(model.nvs[1:]) != {1} or abs(np.linalg.norm(gravity) - GRAVITY) > TOLERANCE:
            return None
        data = model.createData()
        pin.computeJointJacobians(model, data, pin.neutral(model))
        jacobians = [pin.getJointJacobian(model, data, j, pin.LOCAL_WORLD_ALIGNED).reshape(6, model.nv) for j in joints]
        axes = np.array([jacobian[:, j - 1] for j, jacobian in zip(joints, jacobians, strict=True)])
        if not axes[:, 3:].any(axis=1).all():  # a prismatic joint
            return None
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
    force: FloatArray | None = None,
) -> None:
    """Write the documented regressor for (X1, Y1, J1, X2, …) of every sample."""
    block = max(1, min(BLOCK, len(q)))
    work = _Workspace.allocate(chain.n, block)  # allocated once, as fresh memory costs more time than the arithmetic
    segments = _segments(chain)
    for start in range(0, len(q), block):
        rows = slice(start, start + block)
        if len(q) - start < block:
            work = work.first(len(q) - start)
        joints, columns = (q[rows].T, v[rows].T, a[rows].T), out[..., rows]
        moved = None if torso is None else TorsoSamples(*(x[rows] for x in torso))
        for segment in segments:
            _move(segment, joints, work, moved)
            _fill_columns(segment, joints[2], work, columns, None if force is None else force[..., rows], cumulative)
        for j, sign, _ in segments:
            if sign < 0.0:
                columns[3 * j :, j] *= -1.0


_Joints = tuple[FloatArray, FloatArray, FloatArray]
"""Angles, rates and accelerations of the joints, (n, B) each."""


class _Segment(NamedTuple):
    """Segment j and the joint that carries it."""

    j: int  # index
    sign: float  # sign s_j
    offset: complex | None  # vector d_j as a complex number; None for the last segment


def _segments(chain: PlanarChain) -> list[_Segment]:
    """Segments with Python numbers, which NumPy reads faster than its own scalars."""
    offsets = [*(complex(x, z) for x, z in chain.offsets.tolist()), None]
    return [
        _Segment(j, sign, offset) for j, (sign, offset) in enumerate(zip(chain.signs.tolist(), offsets, strict=True))
    ]


class _Parts(NamedTuple):
    """Complex numbers of B samples, with views of their real and imaginary parts."""

    whole: ComplexArray
    real: FloatArray
    imag: FloatArray

    @classmethod
    def of(cls, numbers: ComplexArray) -> _Parts:
        """Make the views."""
        return cls(numbers, numbers.real, numbers.imag)


class _Workspace(NamedTuple):
    """Memory for one block of B samples; each segment overwrites the values of the one before."""

    absolute: FloatArray  # angle φ_j, rate φ̇_j and acceleration φ̈_j, (3, B)
    scratch: FloatArray  # temporary values, (2, B)
    origin: _Parts  # values i conj(p̈_j + i g)
    direction: _Parts  # values e^{iφ_j}
    turn: _Parts  # values e^{iφ_j}(φ̈_j + i φ̇_j²)
    moment: _Parts  # factor of h_j, or the part of it that a lever adds
    levers: ComplexArray  # values conj(d_k e^{iφ_k}) of the segments k above, (n, B)

    @classmethod
    def allocate(cls, n: int, block: int) -> _Workspace:
        """Allocate the memory."""
        real, numbers = np.empty((5, block)), np.empty((4 + n, block), dtype=np.complex128)
        origin, direction, turn, moment = (_Parts.of(row) for row in numbers[:4])
        return cls(real[:3], real[3:], origin, direction, turn, moment, numbers[4:])

    def first(self, count: int) -> _Workspace:
        """View the memory as a smaller block."""
        absolute, scratch, *numbers, levers = self
        origin, direction, turn, moment = (_Parts.of(parts.whole[:count]) for parts in numbers)
        return _Workspace(absolute[:, :count], scratch[:, :count], origin, direction, turn, moment, levers[:, :count])


def _move(segment: _Segment, joints: _Joints, work: _Workspace, torso: TorsoSamples | None) -> None:
    """Advance the absolute motion to the next segment; the first one follows the torso."""
    j, sign, _ = segment
    angle, rate, acceleration = work.absolute
    q, v, a = joints
    if j > 0:
        add = np.add if sign > 0.0 else np.subtract
        add(angle, q[j], out=angle)
        add(rate, v[j], out=rate)
        add(acceleration, a[j], out=acceleration)
        return
    np.multiply(q[0], sign, out=angle)
    np.multiply(v[0], sign, out=rate)
    np.multiply(a[0], sign, out=acceleration)
    work.origin.whole[:] = GRAVITY
    if torso is not None:
        work.absolute[:] += torso[:3]
        work.origin.real[:] += torso.hip_acceleration_z
        work.origin.imag[:] += torso.hip_acceleration_x


def _fill_columns(
    segment: _Segment,
    accelerations: FloatArray,
    work: _Workspace,
    out: FloatArray,
    force: FloatArray | None,
    cumulative: bool,
) -> None:
    """Fill the columns of a segment without the signs s_k, and advance the origin to the next segment."""
    j, sign, offset = segment
    (angle, rate, acceleration), scratch, origin, direction, turn, moment, levers = work
    _direct(angle, out=direction, scratch=scratch)
    turn.real[:] = acceleration
    np.multiply(rate, rate, out=turn.imag)
    np.multiply(turn.whole, direction.whole, out=turn.whole)
    np.multiply(direction.whole, origin.whole, out=moment.whole)
    if force is not None:
        _fill_force(turn, force[3 * j : 3 * j + 2])
    X, Y, J = out[3 * j], out[3 * j + 1], out[3 * j + 2]
    X[j], Y[j], J[j] = moment.imag, moment.real, acceleration
    for k in range(j - 1, -1, -1):  # each joint above has the lever of one more segment
        np.multiply(turn.whole, levers[k], out=moment.whole)
        np.add(X[k + 1], moment.imag, out=X[k])
        np.add(Y[k + 1], moment.real, out=Y[k])
        if cumulative:
            np.multiply(accelerations[j], sign, out=J[k])
        else:
            J[k] = acceleration
    if offset is not None:
        np.conjugate(np.multiply(direction.whole, offset, out=direction.whole), out=levers[j])
        np.conjugate(np.multiply(turn.whole, offset, out=turn.whole), out=turn.whole)
        np.add(origin.whole, turn.whole, out=origin.whole)  # p̈ grows by i d e^{iφ}(φ̈ + i φ̇²)


def _fill_force(turn: _Parts, out: FloatArray) -> None:
    """Force i h e^{iφ}(φ̈ + i φ̇²) of the mass moment h = Y − i X: forward and up for X and for Y, (2, 2, B)."""
    out[0, 0], out[0, 1] = turn.real, turn.imag
    np.negative(turn.imag, out=out[1, 0])
    out[1, 1] = turn.real


def _direct(angle: FloatArray, *, out: _Parts, scratch: FloatArray) -> None:
    """e^{iφ} from t = tan(φ/2): cos φ = 2/(1 + t²) − 1, sin φ = 2t/(1 + t²); a third of the time of cos and sin."""
    t, double = scratch
    np.tan(np.multiply(angle, 0.5, out=t), out=t)
    np.multiply(t, t, out=double)
    np.add(double, 1.0, out=double)
    np.divide(2.0, double, out=double)
    np.subtract(double, 1.0, out=out.real)
    np.multiply(double, t, out=out.imag)


def _plane(axis: FloatArray, up: FloatArray) -> Plane:
    lateral = axis / np.linalg.norm(axis)
    lateral = lateral * np.sign(lateral[np.argmax(np.abs(lateral))])
    return Plane(np.cross(lateral, up), lateral, up)
