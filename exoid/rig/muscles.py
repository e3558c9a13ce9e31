"""Muscles of a wearer: torque of the intended motion at the middle of each step."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.dynamics import inverse_dynamics
from exoid.leg.torso import TorsoMotion

from .controllers import Reference, Target
from .pinocchio_stepper import PinocchioBodies
from .plant import Plant
from .wearer import Wearer


def muscle_torques(wearer: Wearer, limb: Plant, dt: float, count: int) -> Iterator[FloatArray]:
    """Torque u = RNEA_limb(q_i, v_i, a_i) + k_m q_i + d_m v_i at the middle of each step; it repeats after `count`."""
    shape, first = (limb.n, limb.count), 0
    torque = np.zeros((1, *shape))
    while wearer.intention is not None and first < count:
        steps = range(first, min(first + 250, count))  # in chunks: RNEA of many samples at once is fast
        q, v, a = intended(wearer.intention, [(k + 0.5) * dt for k in steps], shape, wearer.feedforward)
        torque = np.asarray(wearer.muscle_stiffness) * q + np.asarray(wearer.muscle_damping) * v
        if wearer.feedforward:
            q, v, a = (x.transpose(0, 2, 1).reshape(-1, limb.n) for x in (q, v, a))
            if limb.leg.chain is None:  # of one rig
                alone = inverse_dynamics(PinocchioBodies(limb).model, q, v, a)
            else:
                W = limb.leg.regressor(q, v, a, TorsoMotion(pitch=np.tile(limb.pitch, len(steps))))
                alone = W @ limb.leg.parameters
            torque = torque + alone.reshape(len(steps), limb.count, limb.n).transpose(0, 2, 1)
        yield from torque
        first = steps.stop
    while True:
        yield torque[-1]


def intended(
    intention: Reference, times: list[float], shape: tuple[int, int], with_acceleration: bool
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Evaluate the intended motion, (K, n, B) each."""
    targets = [intention.at(time) for time in times]
    if with_acceleration and any(target.a is None for target in targets):
        raise BadArgumentError(
            "the intention has no acceleration, which the muscles' feedforward needs",
            remedy="give an intention with accelerations, such as those of exoid.experiments, or feedforward=False",
        )
    if not with_acceleration:
        targets = [Target(target.q, target.v, np.zeros(1)) for target in targets]
    try:
        q, v, a = (np.array([np.broadcast_to(x, shape) for x in each]) for each in zip(*targets, strict=True))
    except ValueError:
        raise BadArgumentError(
            f"an intention of shape {np.shape(targets[0].q)} for {shape[0]} joints of {shape[1]} rigs",
            remedy=f"give {shape} or ({shape[0]}, 1) angles; gait_for_leg(leg, flexion) makes the gait of a leg",
        ) from None
    if not (np.isfinite(q).all() and np.isfinite(v).all() and np.isfinite(a).all()):
        raise BadArgumentError("the intention contains a number that is not finite", remedy="give angles in rad")
    return q, v, a
