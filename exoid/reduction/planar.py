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

from exoid._typing import ComplexArray, FloatArray

GRAVITY = 9.81
"""Standard of the documents and of Pinocchio [m/s²]."""

BLOCK = 8192
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
        jacobians = [pin.getJointJacobian(model, data, j, pin.LOCAL_WORLD_ALIGNED).reshape(6, n) for j in joints]
        axes = np.array([jacobian[:, j] for j, jacobian in enumerate(jacobians)])
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
    block = max(1, min(BLOCK, len(q)))
    workspace = _Workspace.allocate(chain.n, block)  # once: fresh memory costs more than the arithmetic
    for start in range(0, len(q), block):
        rows = slice(start, start + block)
        work, columns = workspace.first(len(q[rows])), out[..., rows]
        _begin(work, None if torso is None else TorsoSamples(*(x[rows] for x in torso)))
        for j in range(chain.n):
            _add_segment(chain, j, _OfJoint(q[rows, j], v[rows, j], a[rows, j]), work, columns, cumulative=cumulative)
        for k, sign in enumerate(chain.signs):
            if sign < 0.0:
                columns[3 * k :, k] *= -1.0


class _OfJoint(NamedTuple):
    """Motion of one joint relative to the segment before, (B,) each."""

    angle: FloatArray
    rate: FloatArray
    acceleration: FloatArray


class _Workspace(NamedTuple):
    """Memory for one block of B samples; what is of segment j is written over by the next one's.

    Attributes:
        angle: φ_j, (B,).
        rate: φ̇_j, (B,).
        acceleration: φ̈_j, (B,).
        scratch: (2, B).
        origin: i conj(p̈_j + i g), (B,).
        direction: e^{iφ_j}, (B,).
        turn: e^{iφ_j}(φ̈_j + i φ̇_j²), (B,).
        moment: What is multiplied by h_j, or what a lever adds to it, (B,).
        levers: conj(d_k e^{iφ_k}) of the segments k above, (n, B).
    """

    angle: FloatArray
    rate: FloatArray
    acceleration: FloatArray
    scratch: FloatArray
    origin: ComplexArray
    direction: ComplexArray
    turn: ComplexArray
    moment: ComplexArray
    levers: ComplexArray

    @classmethod
    def allocate(cls, n: int, block: int) -> _Workspace:
        """Ask for the memory."""
        angle, rate, acceleration, *_ = real = np.empty((5, block))
        origin, direction, turn, moment, *_ = numbers = np.empty((4 + n, block), dtype=np.complex128)
        return cls(angle, rate, acceleration, real[3:], origin, direction, turn, moment, numbers[4:])

    def first(self, count: int) -> _Workspace:
        """View the memory as that of a smaller block."""
        return _Workspace._make(x[..., :count] for x in self)


def _begin(work: _Workspace, torso: TorsoSamples | None) -> None:
    """Start with the motion of the torso."""
    if torso is None:
        work.angle[:] = work.rate[:] = work.acceleration[:] = 0.0
        work.origin[:] = GRAVITY
    else:
        work.angle[:], work.rate[:], work.acceleration[:] = torso[:3]
        work.origin.real, work.origin.imag = torso.hip_acceleration_z + GRAVITY, torso.hip_acceleration_x


def _add_segment(
    chain: PlanarChain, j: int, joint: _OfJoint, work: _Workspace, out: FloatArray, *, cumulative: bool
) -> None:
    """Fill the columns of segment j, but for the signs s_k, and go on to the next segment."""
    angle, rate, acceleration, scratch, origin, direction, turn, moment, levers = work
    add = np.add if chain.signs[j] > 0.0 else np.subtract
    for absolute, relative in zip((angle, rate, acceleration), joint, strict=True):
        add(absolute, relative, out=absolute)
    _direct(angle, out=direction, scratch=scratch)
    turn.real = acceleration
    np.multiply(rate, rate, out=turn.imag)
    turn *= direction
    X, Y, J = out[3 * j : 3 * j + 3]
    np.multiply(direction, origin, out=moment)
    X[j], Y[j], J[j] = moment.imag, moment.real, acceleration
    if cumulative:
        np.multiply(joint.acceleration, chain.signs[j], out=J[:j])
    else:
        J[:j] = acceleration
    for k in range(j - 1, -1, -1):  # each joint further up has the lever of one more segment
        np.multiply(turn, levers[k], out=moment)
        np.add(X[k + 1], moment.imag, out=X[k])
        np.add(Y[k + 1], moment.real, out=Y[k])
    if j < chain.n - 1:
        d = complex(*chain.offsets[j])
        np.conjugate(np.multiply(direction, d, out=direction), out=levers[j])
        origin += np.conjugate(np.multiply(turn, d, out=turn), out=turn)  # p̈ grows by i d e^{iφ}(φ̈ + i φ̇²)


def _direct(angle: FloatArray, *, out: ComplexArray, scratch: FloatArray) -> None:
    """e^{iφ} from t = tan(φ/2): cos φ = 2/(1 + t²) − 1, sin φ = 2t/(1 + t²); a third of the time of cos and sin."""
    t, double = scratch
    np.tan(np.multiply(angle, 0.5, out=t), out=t)
    np.multiply(t, t, out=double)
    double += 1.0
    np.divide(2.0, double, out=double)
    np.subtract(double, 1.0, out=out.real)
    np.multiply(double, t, out=out.imag)


def _plane(axis: FloatArray, up: FloatArray) -> Plane:
    lateral = axis / np.linalg.norm(axis)
    lateral = lateral * np.sign(lateral[np.argmax(np.abs(lateral))])
    return Plane(np.cross(lateral, up), lateral, up)
