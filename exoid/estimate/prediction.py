"""What an estimate says a leg does under the torques that were measured: its motion, piece by piece."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, ExoidError, NotSupportedError, UnreadableInputError
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.payload import Payload
from exoid.leg.torso import MovingBase
from exoid.regression.rows import for_leg, source_of
from exoid.signals import Recording
from exoid.signals.moving_base import base_during

from .data import EstimateData

STEP = 2e-3  # longest step of the integration [s]; smoothed friction of a light foot acts within a few milliseconds
FASTEST = 1e3  # a joint faster than this [rad/s] has diverged


def predict_motion(estimate: EstimateData, recording: Recording, horizon: float = 0.5) -> Recording:
    """Let the identified leg move under the measured torques, started anew from the measured state every so often.

    Between two starts nothing pulls the model back to the measurement: what lies between both motions after a horizon
    is what the model gets wrong in that time. M(q) a = τ − b(q, v) is integrated by Runge and Kutta's method of
    order 4, with M and b from the estimate's torque, which is linear in a: τ = M a + b.

    Args:
        estimate: The estimate, with friction and all its terms.
        recording: Motion and torques; the base at rest, tilted or moving.
        horizon: Time from one start to the next [s].

    Returns:
        The predicted motion at the recording's (even) time stamps, which jumps back to the measured one at each start.

    Raises:
        ExoidError: There is no torque, a link stands on the ground, the horizon is shorter than two samples, or the
            model's motion diverges.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> predicted = predict_motion(exoid.identify(data.leg, data.train), data.test, horizon=0.25)
        >>> bool(np.abs(predicted.q - data.test.q).max() < 0.1)
        True
    """
    recording = for_leg(estimate.model, recording).resampled()
    if recording.tau is None:
        raise UnreadableInputError(
            "there is no torque in the recording", remedy="log it, or show the motion without prediction"
        )
    if not recording.measured.all():
        pairs = zip(recording.joint_names, recording.measured, strict=True)
        without = ", ".join(name for name, there in pairs if not there)
        raise NotSupportedError(
            f"the torque of {without} was not measured, so that the motion under it cannot be predicted",
            remedy="show the motion without prediction, or declare joints without an actuator passive",
        )
    if recording.loaded_links:
        raise NotSupportedError(
            f"the surroundings act on {', '.join(recording.loaded_links)}, and the predicted leg moves in the air",
            where=source_of(recording),
            remedy="show the motion without prediction, or cut out a swing and take them off: "
            "dataclasses.replace(recording.between(start, stop), wrenches={}, contacts={})",
        )
    if not 2.0 <= horizon * recording.sample_rate < math.inf:
        raise BadArgumentError(
            f"a horizon of {horizon:g} s at {recording.sample_rate:.4g} Hz", remedy="let it span two samples or more"
        )
    start, carried = estimate.preparation.kinematics(recording), base_during(recording, estimate.preparation)
    samples = len(recording)
    length = min(round(horizon * recording.sample_rate), samples)
    pieces = -(-samples // length)
    torque = np.pad(recording.tau, ((0, pieces * length + 1 - samples), (0, 0)), mode="edge")
    first = np.arange(pieces) * length
    q, v = start.q[first], start.v[first]
    out = np.empty((length, *q.shape))
    steps = math.ceil(1.0 / (recording.sample_rate * STEP))
    for sample in range(length):
        out[sample] = q
        rows = first + sample
        now, later, held = torque[rows], torque[rows + 1], np.minimum(rows, samples - 1)
        base = carried.rows(held) if isinstance(carried, BaseKinematics) else carried
        around = Surroundings(base, recording.payloads)
        for step in range(steps):
            ends = [now + (later - now) * (step + share) / steps for share in (0.0, 0.5, 1.0)]
            q, v = _step(estimate, q, v, ends, 1.0 / (recording.sample_rate * steps), around)
        if not (np.abs(v) < FASTEST).all():
            raise ExoidError(
                f"the model's motion diverges within {(sample + 1) / recording.sample_rate:.3g} s",
                remedy="check that the estimate is physical (exoid.lift.check_physical), or shorten the horizon",
            )
    predicted = out.transpose(1, 0, 2).reshape(-1, q.shape[1])[:samples]
    names = recording.joint_names
    about: dict[str, Any] = {"torso": recording.torso, "base": recording.base}
    return Recording(recording.time, predicted, joint_names=names, largest_angle=math.inf, **about)


class Surroundings(NamedTuple):
    """What acts on the leg from outside, held from one sample to the next."""

    base: MovingBase | None  # motion of the base, of B samples if it moves; None if it is upright and still
    payloads: tuple[Payload, ...]  # payloads on the leg


def _step(
    estimate: EstimateData, q: FloatArray, v: FloatArray, tau: list[FloatArray], dt: float, around: Surroundings
) -> tuple[FloatArray, FloatArray]:
    """Take a step from each of B states, (B, n), with torques at its start, middle and end."""
    a1 = _acceleration(estimate, q, v, tau[0], around)
    v2 = v + 0.5 * dt * a1
    a2 = _acceleration(estimate, q + 0.5 * dt * v, v2, tau[1], around)
    v3 = v + 0.5 * dt * a2
    a3 = _acceleration(estimate, q + 0.5 * dt * v2, v3, tau[1], around)
    v4 = v + dt * a3
    a4 = _acceleration(estimate, q + dt * v3, v4, tau[2], around)
    return q + dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4), v + dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)


def _acceleration(
    estimate: EstimateData, q: FloatArray, v: FloatArray, tau: FloatArray, around: Surroundings
) -> FloatArray:
    """Solve M a = τ − b, with M and b from torques with no acceleration and with 1 rad/s² of each joint, (B, n)."""
    count, n = q.shape
    units = np.repeat(np.vstack([np.zeros(n), np.eye(n)]), count, axis=0)
    motion = np.tile(q, (n + 1, 1)), np.tile(v, (n + 1, 1)), units
    base = around.base
    if isinstance(base, BaseKinematics):
        base = base.rows(np.tile(np.arange(count), n + 1))
    torques = estimate.torque(*motion, base, around.payloads).reshape(n + 1, count, n)
    b = torques[0]
    M = (torques[1:] - b).transpose(1, 2, 0)
    try:
        return np.asarray(np.linalg.solve(M, (tau - b)[..., np.newaxis])[..., 0])
    except np.linalg.LinAlgError:
        return np.full_like(q, np.nan)
