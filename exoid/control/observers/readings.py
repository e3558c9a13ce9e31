"""What an observer reads and gives: checks of its channels, and the torque of the wearer with its band."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.control.model import ControlModel, ModelSource
from exoid.errors import BadArgumentError, NotSupportedError, UnreadableInputError
from exoid.estimate import Estimate
from exoid.estimate.late_velocity import late_velocities
from exoid.signals import Recording
from exoid.signals.checks import FASTEST
from exoid.tools.tables import make_table, to_text
from exoid.torques import TorqueModel
from exoid.torques.position_units import PositionUnit, heading


class ObserverReading(NamedTuple):
    """Torque that acts on the leg from outside, at one sample, (n,) each.

    Attributes:
        torque: Torque of the wearer on the leg [N·m], as it was one delay of the observer ago.
        std: Standard deviation of its error by noise, parameters and model error [N·m].
        stiction: Largest error by friction of joints that may stick [N·m].
        detected: Whether the torque is beyond stiction and noise.
    """

    torque: FloatArray
    std: FloatArray
    stiction: FloatArray
    detected: BoolArray


@dataclass(frozen=True, eq=False, repr=False)
class ObservedTorque:
    """Torque that acts on the leg from outside, over a log.

    Attributes:
        time: Time stamps of the log [s], (N,); a torque is known one delay after it acts.
        torque: Torque of the wearer on the leg [N·m], (N, n).
        std: Standard deviation of its error by noise, parameters and model error [N·m], (N, n).
        stiction: Largest error by friction of joints that may stick [N·m], (N, n).
        detected: Whether the torque is beyond stiction and noise, (N, n).
        joint_names: Joints, (n,).
        delay: Delay of the torque for slow signals [s].
        settling: Samples at the beginning that the observer needs to settle, without detection.
        units: Units of each joint, (n,).
    """

    time: FloatArray
    torque: FloatArray
    std: FloatArray
    stiction: FloatArray
    detected: BoolArray
    joint_names: tuple[str, ...]
    delay: float
    settling: int
    units: tuple[PositionUnit, ...]

    @property
    def alarms(self) -> FloatArray:
        """Number of times that each joint is detected anew, (n,)."""
        return np.asarray((np.diff(self.detected.astype(np.int8), axis=0, prepend=0) > 0).sum(axis=0), dtype=np.float64)

    def __repr__(self) -> str:
        """Write the size in one line."""
        return f"ObservedTorque({len(self.time)} samples; joints: {', '.join(self.joint_names)})"

    def __str__(self) -> str:
        """Print a table with a row for each joint, after the observer has settled."""
        sizes = (f"{name} [{heading(self.units, '{torque}')}]" for name in ("rms", "peak", "std"))
        headers = ("joint", *sizes, "detected [%]", "alarms", "delay [ms]")
        torque = self.torque[min(self.settling, len(self.time) - 1) :]
        rms, share = np.sqrt(np.mean(torque**2, axis=0)), 100.0 * self.detected.mean(axis=0)
        std, peak = np.sqrt(np.mean(self.std**2, axis=0)), np.abs(torque).max(axis=0)
        rows = [
            (name, f"{a:.3g}", f"{b:.3g}", f"{c:.2g}", f"{d:.3g}", f"{e:.0f}", f"{1e3 * self.delay:.3g}")
            for name, a, b, c, d, e in zip(self.joint_names, rms, peak, std, share, self.alarms, strict=True)
        ]
        return to_text(make_table(headers, rows))


def refuse_readings(rows: FloatArray, before: FloatArray, rate: float, names: tuple[str, ...], where: str = "") -> None:
    """Refuse readings (N, 3, n) that no leg makes, after the angles ``before``, (n,)."""
    if rows.shape[1:] != (3, len(names)):
        remedy = f"give one value for each of {', '.join(names)}"
        raise BadArgumentError(f"readings of shape {rows.shape[2:]} for {len(names)} joints", remedy=remedy)
    for channel, row, joint in np.argwhere(~np.isfinite(rows.transpose(1, 0, 2)))[:1]:
        raise UnreadableInputError(
            f"the {('angle', 'velocity', 'torque')[channel]} of {names[joint]} is {rows[row, channel, joint]}",
            where=where and f"{where}, sample {row}",
            remedy="repeat the step with the last good reading, from the memory before, or begin again after a gap",
            joints=(names[joint],),
        )
    jumps = np.abs(np.diff(rows[:, 0], axis=0, prepend=before[None]))
    for row, joint in np.argwhere(jumps > FASTEST / rate)[:1]:
        raise UnreadableInputError(
            f"the angle of {names[joint]} jumps by {jumps[row, joint]:.3g} rad from one sample to the next",
            where=where and f"{where}, sample {row}",
            remedy="unwrap the angle or repair the encoder; after a gap, begin again",
            joints=(names[joint],),
        )


def refuse_contradictions(recording: Recording, v: FloatArray, lags: FloatArray) -> None:
    """Refuse a log with an angle that is frozen while its velocity is not, or a velocity of another scale or sign."""
    part, t = max(1, round(0.1 * recording.sample_rate)), recording.time
    ways = np.diff(recording.q[::part], axis=0)
    turned = np.add.reduceat(v, np.arange(0, len(v), part), axis=0)[:-1] / recording.sample_rate
    whole = len(ways) // 10 * 10  # an angle is frozen that stands still for a second
    q, path = (np.abs(x[:whole]).reshape(-1, 10, x.shape[1]).sum(axis=1) for x in (ways, turned))
    # 0.2 rad by its velocities contradict this: noise of 0.1 rad/s is a tenth of it
    frozen = np.array(recording.joint_names)[((q == 0.0) & (path > 0.2)).any(axis=0)].tolist()
    wrong = [(name, "the angle is frozen while its velocity is not") for name in frozen]
    on_time = np.column_stack([np.interp(t + lag, t, x) for lag, x in zip(lags, v.T, strict=True)])
    for finding in late_velocities(replace(recording, v=on_time)):
        # a tachometer behind a low-pass of 5 Hz has a scale that is off by 0.07
        if finding.kind == "velocity-scale" and abs(finding.value - 1.0) > 0.2:
            wrong.append((finding.joint, finding.message))
        # and 1.7 ms more lag than its low-pass at low frequencies, which may be told
        elif finding.kind == "velocity-scale" or abs(finding.value) > 0.003:
            what = f"{finding.joint}: {finding.message}; give the observer velocity_delay=, or no velocities"
            warnings.warn(what, UserWarning, stacklevel=3)
    for name, what in wrong[:1]:
        remedy = "mend the channel; without velocities in the log they are derived from the angles"
        raise UnreadableInputError(f"{name}: {what}", where=recording.file_name, remedy=remedy, joints=(name,))


def observed_log(source: ModelSource, recording: Recording, rate: float) -> Recording:
    """Pick what an observer reads from a log, joints in the order of the leg, with torques, at its rate."""
    where = recording.file_name
    model = source.model if isinstance(source, Estimate) else TorqueModel(ControlModel.of(source).leg, ())
    if isinstance(source, Estimate) and source.actuators is not None:
        recording = source.actuators.torque(recording)
    recording = model.select(recording)
    missing = tuple(name for name, there in zip(recording.joint_names, recording.measured, strict=True) if not there)
    if recording.tau is None or missing:
        raise UnreadableInputError(
            f"no torque of {', '.join(missing)} in the log",
            where=where,
            remedy="give the estimate its drives (identify(actuators=...)), or compute torques with "
            "exoid.actuators.Actuators",
            joints=missing,
        )
    if not recording.is_uniform:
        what = "time steps are uneven, as after a gap or dropped samples"
        remedy = "run the observer over each part without a gap (recording.between), or resample"
        raise UnreadableInputError(what, where=where, remedy=remedy)
    if abs(recording.sample_rate / rate - 1.0) > 1e-3:
        raise BadArgumentError(
            f"a log at {recording.sample_rate:.6g} Hz for an observer at {rate:.6g} Hz",
            where=where,
            remedy=f"make the observer with rate={recording.sample_rate:.6g}",
        )
    if recording.base is not None or recording.torso is not None:
        raise NotSupportedError(
            "the base is tilted or moves, which the observer's model does not know",
            where=where,
            remedy="use the torque of the wearer off line, exoid.interaction, which takes motions of the base",
        )
    if recording.payloads:
        raise NotSupportedError(
            f"the leg carries {', '.join(map(str, recording.payloads))}, which would count as the wearer",
            where=where,
            remedy="take them out of the recording (payloads=()) if that is meant",
        )
    return recording
