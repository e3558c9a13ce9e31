"""Muscles of a wearer: torque of the intended motion at the middle of each step."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.leg.dynamics import inverse_dynamics

from .controllers import Reference, Target
from .planar_bodies import PlanarBodies
from .plant import Plant
from .wearer import Wearer

CHUNK = 250
"""Number of steps whose torque is computed at once."""


class Muscles:
    """Torque u = RNEA_limb(q_i, v_i, a_i) + k_m q_i + d_m v_i of the muscles, at the middle of each of N steps."""

    def __init__(self, wearer: Wearer, limb: Plant, dt: float, count: int) -> None:
        self._wearer, self._limb, self._dt, self._count = wearer, limb, dt, count
        self._next, self._chunk = 0, np.zeros((0, limb.n, limb.count))

    def next(self) -> FloatArray:
        """Return the torque of the next step."""
        k = self._next % CHUNK
        if k == 0:
            self._chunk = self._compute(self._next)
        self._next += 1
        return np.asarray(self._chunk[min(k, len(self._chunk) - 1)])

    def _compute(self, first: int) -> FloatArray:
        """Torques of a chunk of steps, (K, n, B)."""
        wearer, shape = self._wearer, (self._limb.n, self._limb.count)
        if wearer.intention is None:
            return np.zeros((1, *shape))
        steps = range(first, max(min(first + CHUNK, self._count), first + 1))
        q, v, a = intended(wearer.intention, [(k + 0.5) * self._dt for k in steps], shape, wearer.feedforward)
        torque = np.asarray(wearer.muscle_stiffness) * q + np.asarray(wearer.muscle_damping) * v
        return np.asarray(torque + feedforward(self._limb, q, v, a) if wearer.feedforward else torque)


def intended(
    intention: Reference, times: list[float], shape: tuple[int, int], with_acceleration: bool
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Evaluate the intended motion."""
    targets = [intention.at(time) for time in times]
    if with_acceleration and any(target.a is None for target in targets):
        raise ExoidError(
            "the intention has no acceleration, which the muscles' feedforward needs",
            remedy="give an intention with accelerations, such as those of exoid.experiments, or feedforward=False",
        )
    if not with_acceleration:
        targets = [Target(target.q, target.v, np.zeros(1)) for target in targets]
    try:
        q, v, a = (np.array([np.broadcast_to(x, shape) for x in each]) for each in zip(*targets, strict=True))
    except ValueError:
        raise ExoidError(
            f"an intention of shape {np.shape(targets[0].q)} for {shape[0]} joints of {shape[1]} rigs",
            remedy=f"give {shape} or ({shape[0]}, 1) angles; gait_for_leg(leg, flexion) makes the gait of a leg",
        ) from None
    if not (np.isfinite(q).all() and np.isfinite(v).all() and np.isfinite(a).all()):
        raise ExoidError("the intention contains a number that is not finite", remedy="give angles in rad")
    return q, v, a


def feedforward(limb: Plant, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """Compute the torque that the limb alone needs for a motion."""
    if limb.leg.chain is None:
        leg = limb.leg.with_parameters(limb.parameters[:, 0])
        model = leg.model.copy()
        model.gravity.linear = leg.gravity_of_tilted_torso(float(limb.pitch[0]))
        return inverse_dynamics(model, q[..., 0], v[..., 0], a[..., 0])[..., None]
    count = len(q)
    bodies = PlanarBodies.from_parameters(limb.leg, np.tile(limb.parameters, count), np.tile(limb.pitch, count))
    rows = [x.transpose(1, 0, 2).reshape(limb.n, -1) for x in (q, v, a)]
    M, bias = bodies.dynamics(*rows[:2])
    torque = (M * rows[2]).sum(axis=1) + bias
    return np.asarray(torque.reshape(limb.n, count, -1).transpose(1, 0, 2))
