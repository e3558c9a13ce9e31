"""Checks of what an observer reads."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.control.model import ControlModel, ModelSource
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.regression.rows import for_leg
from exoid.signals import Recording
from exoid.torques import TorqueModel

from .alignment import Channels

FASTEST = 50.0
"""Speed that no leg reaches [rad/s]: an angle that changes faster jumped."""

SAME_RATE = 1e-3
"""Largest relative difference between the rate of a log and that of the observer."""


def refuse_reading(reading: Channels, before: FloatArray, rate: float, names: tuple[str, ...]) -> None:
    """Refuse a reading that no leg makes."""
    for what, values in zip(("angle", "velocity", "torque"), reading, strict=True):
        if values is None:
            continue
        if values.shape != before.shape:
            raise ExoidError(f"{what} of shape {values.shape}", remedy=f"give one value for each of {', '.join(names)}")
        if not np.isfinite(values).all():
            row, joint = np.argwhere(~np.isfinite(np.atleast_2d(values)))[0]
            place = f"sample {row}" if values.ndim == 2 else ""
            raise ExoidError(
                f"the {what} of {names[joint]} is {np.atleast_2d(values)[row, joint]}",
                where=place,
                remedy="repeat the step with the last good reading, from the memory before, or begin again after a gap",
            )
    jumps = np.atleast_2d(np.abs(reading.q - before))
    if (jumps > FASTEST / rate).any():
        row, joint = np.argwhere(jumps > FASTEST / rate)[0]
        raise ExoidError(
            f"the angle of {names[joint]} jumps by {jumps[row, joint]:.3g} rad from one sample to the next",
            where=f"sample {row}" if reading.q.ndim == 2 else "",
            remedy="unwrap the angle or repair the encoder; after a gap, begin again",
        )


def observed_channels(source: ModelSource, recording: Recording, rate: float) -> tuple[Recording, Channels]:
    """Pick the channels that an observer reads from a log, joints in the order of the leg."""
    where = recording.source.name if recording.source else ""
    model = source.model if isinstance(source, Estimate) else TorqueModel.at_start(ControlModel.of(source).leg, ())
    if isinstance(source, Estimate) and source.actuators is not None:
        recording = source.actuators.torque(recording)
    recording = for_leg(model, recording)
    missing = [name for name, there in zip(recording.joint_names, recording.measured, strict=True) if not there]
    if recording.tau is None or missing:
        raise ExoidError(
            f"no torque of {', '.join(missing)} in the log",
            where=where,
            remedy="give the estimate its drives (identify(actuators=...)), or compute torques with "
            "exoid.actuators.Actuators",
        )
    if not recording.is_uniform:
        raise ExoidError(
            "time steps are uneven, as after a gap or dropped samples",
            where=where,
            remedy="run the observer over each part without a gap (recording.between), or resample",
        )
    if abs(recording.sample_rate / rate - 1.0) > SAME_RATE:
        raise ExoidError(
            f"a log at {recording.sample_rate:.6g} Hz for an observer at {rate:.6g} Hz",
            where=where,
            remedy=f"make the observer with rate={recording.sample_rate:.6g}",
        )
    if recording.base is not None or recording.torso is not None:
        raise ExoidError(
            "the base is tilted or moves, which the observer's model does not know",
            where=where,
            remedy="use the torque of the wearer off line, exoid.interaction, which takes motions of the base",
        )
    if recording.payloads:
        raise ExoidError(
            f"the leg carries {', '.join(map(str, recording.payloads))}, which would count as the wearer",
            where=where,
            remedy="take them out of the recording (payloads=()) if that is meant",
        )
    return recording, Channels(recording.q, recording.v, recording.tau)
