r"""Kinematics of closed loops: all joint angles of a tree from those of its independent joints, batched over samples.

Each loop holds points of two links together, φ(q) = 0. With A = ∂φ/∂q, split into independent and dependent joints,

    A_d Δq_d = −(φ + A_i Δq_i),    v = G v_i,    a = G a_i + b,    G = [1; −A_d⁻¹ A_i],    A_d b_d = −Ȧ v

(Featherstone 2008, ch. 8). Forces of the loops do no work on motions along G. So Gᵀ takes torques, the regressor and
the mass matrix of the tree to those of the independent joints, and no loop force is left in them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import scipy  # its parts load when they are first used
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.errors import BadArgumentError

from .dynamics import JointFrames, joint_frames
from .loops import Loop, Loops
from .model import joint_axis, position_limits

BLOCK = 4096
"""Samples computed at once: enough that the interpreter costs little, few enough for the processor's cache."""

STRIDE = 16
"""Every such sample is solved first, and the samples around start from it."""

STEP = 0.2
"""Longest step of a joint on the way to a pose [rad or m]; a shorter one keeps to the branch on which it began."""

CORRECTIONS = 12
"""Most corrections at the end of the way; three are usual."""

CONVERGED = 1e-7
"""Last correction that ends Newton's method [rad or m]; the error is about ten times its square."""

CLOSED = 1e-5
"""Largest gap of a closed loop [m]: URDFs have five to six decimals."""

INDEPENDENT_ROWS = 1e-6
"""Smallest singular value, over the largest, of a direction that the loops hold."""

TRANSMISSION = 0.3
"""Least :meth:`Closure._transmission` of random poses, about the sine of the angle between two dependent links.

Near a dead centre, where it is 0, dependent joints move without bound: 0.15 still loses base parameters of cylinders.
"""


class TreeMotion(NamedTuple):
    """Motion of all joints of a leg."""

    q: FloatArray  # angles [rad], (N, t)
    v: FloatArray  # velocities [rad/s], (N, t)
    a: FloatArray  # accelerations [rad/s²], (N, t)
    # velocities of all joints per unit of each independent one, (t, n, N); None without loops
    G: FloatArray | None = None

    def project(self, rows: FloatArray) -> FloatArray:
        """Take the last axis, torques or columns of all t joints, to the independent ones."""
        if self.G is None:
            return rows
        return np.asarray(np.einsum("b...t,tib->b...i", rows, self.G))


class _PointPair(NamedTuple):
    """Point of two bodies that a loop holds together."""

    loop: Loop
    bodies: tuple[int, int]  # index of each body; −1 for the root link
    places: FloatArray  # the point in the frame of each, (2, 3)


class _Linear(NamedTuple):
    """Loop equations at B poses, in the axes of the first body of each loop."""

    frames: JointFrames
    gap: FloatArray  # φ [m], (3 P, B)
    A: FloatArray  # its derivative by all joints, (3 P, t, B)


@dataclass(frozen=True, eq=False)
class Closure:
    """Loop equations of a tree of joints, and the pose at which they were first solved."""

    loops: Loops
    model: pin.Model  # the tree
    pairs: tuple[_PointPair, ...]
    independent: NDArray[np.intp]  # joints of the leg, (n,)
    dependent: NDArray[np.intp]  # joints that follow from them, (m,)
    reference: FloatArray  # closed pose of all joints [rad], (t,)
    rows: FloatArray  # combinations of φ that are independent at all poses, (m, 3 P)
    sign: float  # sign of det A_d on the branch of the reference

    @classmethod
    def of(cls, loops: Loops, model: pin.Model, frame: Callable[[str], tuple[int, pin.SE3]], where: str) -> Closure:
        """Assemble a machine: find a closed pose, and check that the loops determine the dependent joints."""
        names = list(model.names)[1:]
        pairs = tuple(_pairs(loops, frame, where))
        dependent = np.array(sorted(names.index(name) for name in loops.dependent))
        independent = np.setdiff1d(np.arange(len(names)), dependent)
        if unknown := [name for name in loops.start if name not in names]:
            raise BadArgumentError(f"[start] names {unknown[0]!r}, which does not move", where=where)
        moved = {j for pair in pairs for j in _moves(model, pair)}
        for j in sorted(set(dependent.tolist()) - moved):
            what = f"joint {names[j]!r} is dependent, and moves no loop"
            raise BadArgumentError(what, joints=(names[j],), where=where, remedy="leave it out of dependent")
        start = np.array([loops.start.get(name, 0.0) for name in names])
        start[independent] = np.clip(start, *position_limits(model))[independent]
        open_ = cls(loops, model, pairs, independent, dependent, start, np.zeros((0, 3 * len(pairs))), 0.0)
        pose = open_._assemble(start)
        open_._refuse_gap(pose)
        rng = np.random.default_rng(0)  # the pose itself may be symmetric, and hide a direction
        near = np.tile(pose, (9, 1))
        near[1:, independent] += rng.uniform(-0.05, 0.05, (8, len(independent)))
        near[1:] = [open_._assemble(x) for x in near[1:]]
        at = open_._linearise(near[open_.gap(near).max(axis=1) < CLOSED].T)
        directions, size, _ = np.linalg.svd(at.A.reshape(len(at.A), -1), full_matrices=False)
        held = int((size > INDEPENDENT_ROWS * size[0]).sum())
        on_paths = ", ".join(names[j] for j in sorted(moved))
        if held != len(dependent):
            raise BadArgumentError(
                f"the loops take {held} freedoms of their joints, and {len(dependent)} joints are dependent",
                where=where,
                remedy=f"name {held} of {on_paths} as dependent, or correct the kinds and axes of the loops",
            )
        rows = directions[:, :held].T
        A_d = rows @ at.A[:, dependent, 0]
        size = np.linalg.svd(A_d, compute_uv=False)
        if size[-1] < INDEPENDENT_ROWS * size[0]:
            raise BadArgumentError(
                f"the loops do not determine {', '.join(loops.dependent)} at {open_._angles(pose)}: a dead centre",
                where=where,
                remedy=f"give angles away from it in [start], or choose other dependent joints among {on_paths}",
            )
        return replace(open_, reference=pose, rows=rows, sign=float(np.sign(np.linalg.det(A_d))))

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the independent joints."""
        return tuple(self.model.names[j + 1] for j in self.independent.tolist())

    def motion(self, q: FloatArray, v: FloatArray, a: FloatArray) -> TreeMotion:
        """Find the motion of all joints from that of the independent ones, (N, n) each."""
        poses, closed = self.solve(q)
        if not closed.all():
            k = int(np.argmin(closed))
            pose = np.array(self.reference)
            pose[self.independent] = q[k]
            self._refuse_gap(self._assemble(pose), f"sample {k}, ")
        return self.rates(poses, v, a)

    def rates(self, q: FloatArray, v: FloatArray, a: FloatArray) -> TreeMotion:
        """Find velocities and accelerations of all joints at closed poses (N, t)."""
        G = np.zeros((q.shape[1], v.shape[1], len(q)))
        G[self.independent, np.arange(v.shape[1])] = 1.0
        velocity, acceleration = np.zeros((2, *q.shape))
        for block in _blocks(len(q)):
            at = self._linearise(q[block].T)
            A_d, A_i = (np.tensordot(self.rows, at.A[:, each], 1) for each in (self.dependent, self.independent))
            solve = _solver(A_d)
            part = G[..., block]
            part[self.dependent] = -solve(A_i)
            velocity[block] = np.einsum("tib,bi->bt", part, v[block])
            bias = self.rows @ self._bias(at.frames, velocity[block].T)
            acceleration[block] = np.einsum("tib,bi->bt", part, a[block])
            acceleration[block, self.dependent] -= solve(bias[:, None])[:, 0].T
        return TreeMotion(q, velocity, acceleration, G)

    def solve(self, x: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Find the poses of all joints (N, t), and which of them close on the branch of the reference, (N,)."""
        start = np.tile(self.reference, (len(x), 1))
        if len(x) > 2 * STRIDE:
            keys, closed = self.solve(x[::STRIDE])
            nearest = np.minimum((np.arange(len(x)) + STRIDE // 2) // STRIDE, len(keys) - 1)
            ways = [np.abs(x - each[:, self.independent]).max(axis=1) for each in (keys[nearest], start)]
            use = closed[nearest] & (ways[0] < ways[1])
            start[use] = keys[nearest[use]]
        found = [self._walk(start[block].T, x[block].T) for block in _blocks(len(x))]
        return np.vstack([q.T for q, _ in found]), np.concatenate([closed for _, closed in found])

    @cached_property
    def sizes(self) -> FloatArray:
        """Scale of random motions, (n,): 1 rad, or the slide, at most 1 m, that turns a dependent joint by 1 rad."""
        slides = np.array([not joint_axis(joint)[3:].any() for joint in self.model.joints[1:]])
        A = self.rows @ self._linearise(self.reference[:, None]).A[..., 0]
        G_d = np.linalg.solve(A[:, self.dependent], A[:, self.independent])
        turned = np.abs(G_d[~slides[self.dependent]]).max(axis=0, initial=1.0)
        return np.where(slides[self.independent], 1.0 / turned, 1.0)

    @cached_property
    def _looped(self) -> BoolArray:
        """Independent joints that loops contain, (n,)."""
        return np.isin(self.independent, [j for pair in self.pairs for j in _moves(self.model, pair)])

    def closing(self, lower: FloatArray, upper: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Narrow the ranges of joints of loops (n,) about the reference, until loops close all over them."""
        rng, home, parts = np.random.default_rng(0), self.reference[self.independent], np.ones((2, 1))
        for sides in np.array([[[1.0], [0.0]], [[0.0], [1.0]], [[1.0], [1.0]]]):  # each alone, then together
            closed = np.zeros(1, dtype=np.bool_)
            while not closed.all() and (parts > 0.0).all():
                low, high = np.where(self._looped, home + parts * sides * ([lower, upper] - home), [lower, upper])
                closed = self._closes(rng.uniform(low, high, (200, len(home))))
                parts -= 0.05 * sides * (not closed.all())
        return np.maximum(low, lower), np.minimum(high, upper)

    def reachable(self, x: FloatArray) -> FloatArray:
        """Move the joints of loops (N, n) towards the reference until all loops close, away from dead centres."""
        x, home = np.array(x), self.reference[self.independent]
        for _ in range(40):  # the last are at the reference
            closed = self._closes(x)
            if closed.all():
                break
            x[~closed] = np.where(self._looped, home + 0.6 * (x[~closed] - home), x[~closed])
        return x

    def _closes(self, x: FloatArray) -> BoolArray:
        """Whether loops close, away from dead centres: the reference has at least twice that distance, (N,)."""
        (poses, closed), most = self.solve(x), self._transmission(self.reference[None])[0]
        closed[closed] = self._transmission(poses[closed]) >= min(TRANSMISSION, 0.5 * most)
        return closed

    def _transmission(self, q: FloatArray) -> FloatArray:
        """Distance from dead centres, (N,): smallest singular value of A_d with columns of unit length."""
        A_d = np.tensordot(self.rows, self._linearise(q.T).A[:, self.dependent], 1).transpose(2, 0, 1)
        return np.asarray(np.linalg.svd(A_d / np.linalg.norm(A_d, axis=1, keepdims=True), compute_uv=False)[:, -1])

    def correct(self, q: FloatArray) -> FloatArray:
        """Close poses of all joints (N, t) that are nearly closed, on the branch of each."""
        return self._walk(q.T, q[:, self.independent].T)[0].T

    def gap(self, q: FloatArray) -> FloatArray:
        """Size of the gap of each loop [m] at poses of all joints (N, t), (N, number of loops)."""
        found = [self._linearise(q[block].T).gap.T for block in _blocks(len(q))]
        sizes = np.linalg.norm(np.vstack(found).reshape(len(q), -1, 3), axis=2)
        of_loop = [[pair.loop.name == loop.name for pair in self.pairs] for loop in self.loops.loops]
        return np.column_stack([sizes[:, each].max(axis=1) for each in of_loop])

    def _walk(self, q: FloatArray, x: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Go to the independent angles x (n, B) in straight steps, with one Newton correction each."""
        q = np.array(q)
        steps = max(1, int(np.ceil(np.abs(x - q[self.independent]).max(initial=0.0) / STEP)))
        change = (x - q[self.independent]) / steps
        for k in range(steps + CORRECTIONS):
            at = self._linearise(q)
            A_d, error = np.tensordot(self.rows, at.A[:, self.dependent], 1), self.rows @ at.gap
            if k < steps:
                error += np.einsum("mib,ib->mb", np.tensordot(self.rows, at.A[:, self.independent], 1), change)
                q[self.independent] += change
            with np.errstate(all="ignore"):  # poses that do not close end anywhere
                correction = _solver(A_d)(-error[:, None])[:, 0]
                largest = np.abs(correction).max(axis=0)
                q[self.dependent] += correction * np.minimum(1.0, 2.0 * STEP / largest)
            if k >= steps and not (largest > CONVERGED).any():
                break
        # Across a dead centre lies the other branch, where the determinant has the other sign
        same = np.sign(np.linalg.det(A_d.transpose(2, 0, 1))) == self.sign
        q[self.independent] = x
        return q, np.asarray(same & (largest <= CONVERGED))

    def _linearise(self, q: FloatArray) -> _Linear:
        frames = joint_frames(self.model, q)
        gap, A = np.zeros((len(self.pairs), 3, q.shape[1])), np.zeros((len(self.pairs), 3, *q.shape))
        for k, pair in enumerate(self.pairs):
            ends = [_point(frames, body, place) for body, place in zip(pair.bodies, pair.places, strict=True)]
            gap[k] = ends[1] - ends[0]
            for j in _moves(self.model, pair):
                axis = joint_axis(self.model.joints[j + 1])
                side = int(j + 1 in self.model.supports[pair.bodies[1] + 1])
                if axis[3:].any():
                    moved = _cross(axis[3:] @ frames.rotation[j], ends[side] - frames.translation[j])
                else:
                    moved = axis[:3] @ frames.rotation[j]
                A[k, :, j] = moved if side else -moved
        self._turn(frames, gap)
        self._turn(frames, A)
        return _Linear(frames, gap.reshape(-1, q.shape[1]), A.reshape(-1, *q.shape))

    def _turn(self, frames: JointFrames, vectors: FloatArray) -> None:
        """Turn vectors (P, 3, …, B) into the axes of each loop's first body, where redundant directions stay."""
        for pair, vector in zip(self.pairs, vectors, strict=True):
            if pair.bodies[0] >= 0:
                vector[:] = np.einsum("ikb,i...b->k...b", frames.rotation[pair.bodies[0]], vector)

    def _bias(self, frames: JointFrames, v: FloatArray) -> FloatArray:
        """Acceleration of the gap at zero joint acceleration, Ȧ v, (3 P, B)."""
        still = np.zeros((3, v.shape[1]))
        motions: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        for j in range(len(v)):
            parent, axis = self.model.parents[j + 1] - 1, joint_axis(self.model.joints[j + 1])
            omega, alpha, a = motions[parent] if parent >= 0 else (still, still, still)
            r = frames.translation[j] - (frames.translation[parent] if parent >= 0 else 0.0)
            a = a + _cross(alpha, r) + _cross(omega, _cross(omega, r))
            rate = (axis[3:] if axis[3:].any() else axis[:3]) @ frames.rotation[j] * v[j]
            if axis[3:].any():
                omega, alpha = omega + rate, alpha + _cross(omega, rate)
            else:
                a = a + 2.0 * _cross(omega, rate)
            motions.append((omega, alpha, a))
        gap = np.zeros((len(self.pairs), *still.shape))
        for k, pair in enumerate(self.pairs):
            for sign, body, place in zip((-1.0, 1.0), pair.bodies, pair.places, strict=True):
                if body >= 0:
                    omega, alpha, a = motions[body]
                    r = place @ frames.rotation[body]
                    gap[k] += sign * (a + _cross(alpha, r) + _cross(omega, _cross(omega, r)))
        self._turn(frames, gap)
        return gap.reshape(-1, v.shape[1])

    def _assemble(self, pose: FloatArray) -> FloatArray:
        """Close the loops at one pose as far as possible, without the branch of the reference."""

        def at(angles: FloatArray) -> _Linear:
            trial = np.array(pose)
            trial[self.dependent] = angles
            return self._linearise(trial[:, None])

        found = scipy.optimize.least_squares(
            lambda x: at(x).gap[:, 0],  # type: ignore[misc]
            pose[self.dependent],
            lambda x: at(x).A[:, self.dependent, 0],  # type: ignore[misc]
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
        )
        pose = np.array(pose)
        pose[self.dependent] = found.x
        return pose

    def _angles(self, pose: FloatArray) -> str:
        return ", ".join(f"{self.model.names[j + 1]} = {pose[j]:.4g}" for j in self.independent.tolist())

    def _refuse_gap(self, pose: FloatArray, place: str = "") -> None:
        """Refuse a pose at which the loops are open, or at which they change the branch."""
        gaps = self.gap(pose[None])[0]
        k, at = int(np.argmax(gaps)), self._angles(pose)
        open_ = f"does not close at {at}: a gap of {1e3 * gaps[k]:.3g} mm stays at best"
        what = open_ if gaps[k] > CLOSED else f"closes at {at} only beyond a dead centre"
        if self.sign == 0.0 and gaps[k] <= CLOSED:
            return
        raise BadArgumentError(
            f"{place}loop {self.loops.loops[k].name} {what}",
            joints=self.joint_names,
            remedy="correct the frames of the loop or the zeros of the joints, give [start] near a closed pose, or "
            "narrow the limits of the joints in the URDF",
        )


def _pairs(loops: Loops, frame: Callable[[str], tuple[int, pin.SE3]], where: str) -> Iterator[_PointPair]:
    """Points of all loops, given body and placement of each link."""
    for loop in loops.loops:
        ends = loop.first, loop.second
        bodies, frames = zip(*(frame(end.link) for end in ends), strict=True)
        if bodies[0] == bodies[1]:
            what = f"loop {loop.name} connects {loop.first.link} and {loop.second.link}, which do not move"
            raise BadArgumentError(what, where=where, remedy="name two links with a joint between them")
        places = [at * end.placement for at, end in zip(frames, ends, strict=True)]
        for point in loop.points:
            yield _PointPair(loop, bodies, np.array([place * point for place in places]))


def _moves(model: pin.Model, pair: _PointPair) -> list[int]:
    """Joints that move one of the two points and not the other."""
    first, second = (set(model.supports[body + 1]) for body in pair.bodies)
    return sorted(j - 1 for j in first ^ second if j)


def _point(frames: JointFrames, body: int, place: FloatArray) -> FloatArray:
    """Place of a point in the base frame, (3, B)."""
    if body < 0:
        return np.tile(place[:, None], frames.translation.shape[2])
    return np.asarray(frames.translation[body] + place @ frames.rotation[body])


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Cross product of vectors (3, B); numpy's takes five times as long."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _solver(A: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Solver of A x = b for samples last; not a number where A is singular."""
    by_sample = np.ascontiguousarray(A.transpose(2, 0, 1))

    def solve(b: FloatArray) -> FloatArray:
        try:
            return np.asarray(np.linalg.solve(by_sample, b.transpose(2, 0, 1)).transpose(1, 2, 0))
        except np.linalg.LinAlgError:  # the determinant costs as much as the solution, and is hardly ever zero
            by_sample[np.linalg.det(by_sample) == 0.0] = np.nan
            return solve(b)

    return solve


def _blocks(count: int) -> Iterator[slice]:
    return (slice(start, start + BLOCK) for start in range(0, max(count, 1), BLOCK))
