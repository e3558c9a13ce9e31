"""Replay of a controller on a recorded log: the torque that it would have commanded."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError, in_file, within
from exoid.experiments import follow_log
from exoid.rig import Reference, Target
from exoid.signals import Recording
from exoid.signals.csv_writer import LogPart, write_parts
from exoid.signals.timebase import refuse_gaps
from exoid.tools.json_values import json_value
from exoid.tools.read_only import ReadOnly
from exoid.tools.tables import DataTable, to_text
from exoid.torques import TorqueModel
from exoid.torques.position_units import TURNS, PositionUnit, heading, position_units

from .law import AnyLaw, RunningLaw, State, name_of, sound
from .limited import Limited
from .tracking import rms


@dataclass(frozen=True, eq=False, repr=False)
class LawReplay(ReadOnly):
    """Torque that a controller would have commanded during a log; prints itself as a table.

    The motion is that of the log, whatever the torque: nothing says how the leg would have moved.

    Attributes:
        law: Name of the controller.
        rate: Sampling rate of the controller [Hz].
        joint_names: Names of the joints, (n,).
        time: Time stamps of the controller's samples [s], (N,).
        commanded: Torque that it would have commanded [N·m], (N, n).
        recorded: Torque in the log at these times [N·m], (N, n); NaN for joints without one.
        limit: Largest torque [N·m], (n,); infinite for none.
        slew: Largest rate of change of the torque [N·m/s], (n,); infinite for none.
        units: Units of each joint, (n,).
    """

    law: str
    rate: float
    joint_names: tuple[str, ...]
    time: FloatArray
    commanded: FloatArray
    recorded: FloatArray
    limit: FloatArray
    slew: FloatArray
    units: tuple[PositionUnit, ...]

    @property
    def figures(self) -> dict[str, FloatArray]:
        """RMS and largest torques [N·m], the largest rate of change [N·m/s], and shares at the limits, (n,) each.

        Figures of recorded torques are not a number for joints without them.
        """
        changes = np.abs(np.diff(self.commanded, axis=0)) * self.rate
        parts = {"torque": self.commanded, "recorded": self.recorded, "difference": self.commanded - self.recorded}
        found = {f"rms_{name}": rms(values) for name, values in parts.items()}
        found |= {f"peak_{name}": np.asarray(np.abs(values).max(axis=0)) for name, values in parts.items()}
        at_limit, at_slew = np.abs(self.commanded) >= (1.0 - 1e-9) * self.limit, changes >= (1.0 - 1e-6) * self.slew
        found |= {"peak_rate": changes.max(axis=0), "share_at_limit": at_limit.mean(axis=0)}
        return found | {"share_at_slew": at_slew.mean(axis=0)}

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write columns ``time``, ``tau_<joint>`` of the commanded torque and ``recorded_<joint>`` where there is one.

        Args:
            path: File to write; an existing one is replaced only when the new one is complete.

        Raises:
            ExoidError: The file cannot be written.
        """
        there = np.flatnonzero(np.isfinite(self.recorded).all(axis=0))
        names = [f"tau_{name}" for name in self.joint_names]
        known = [f"recorded_{self.joint_names[k]}" for k in there]
        parts = [LogPart(["time"], [self.time]), LogPart(names, [self.commanded])]
        write_parts(path, [*parts, LogPart(known, [self.recorded[:, there]])])

    def to_json(self) -> dict[str, Any]:
        """Convert the metrics to JSON types.

        Returns:
            Values of the joints by the name of the metric; None for a joint without recorded torque.
        """
        joints = {"joint_names": list(self.joint_names), "torque_units": [unit.torque for unit in self.units]}
        return {"law": self.law, "rate": self.rate, **joints, **json_value(self.figures)}

    def __str__(self) -> str:
        """Print as a table, one line for each joint."""
        unit = heading(self.units, "{torque}")
        titles = {
            "rms_torque": f"rms [{unit}]",
            "rms_recorded": "recorded",
            "rms_difference": "difference",
            "peak_torque": f"peak [{unit}]",
            "peak_difference": "peak difference",
            "peak_rate": f"peak rate [{heading(self.units, '{torque}/s')}]",
            "share_at_limit": "at limit",
            "share_at_slew": "at rate limit",
        }
        texts = []
        for name in titles:
            form = "{:.1%}" if name.startswith("share") else "{:.3g}"
            texts.append(["" if np.isnan(x) else form.format(x).replace("%", " %") for x in self.figures[name]])
        rows = [tuple(row) for row in zip(self.joint_names, *texts, strict=True)]
        span = f"{self.time[0]:g} to {self.time[-1]:g} s"
        title = f"torque that {self.law} at {self.rate:g} Hz would have commanded, {span}"
        return to_text(DataTable(title, ("joint", *titles.values()), rows))


def replay_law(
    law: AnyLaw, recording: Recording, reference: Reference | None = None, *, name: str | None = None
) -> LawReplay:
    """Compute the torque that a controller would have commanded during a log.

    The controller reads the angles and velocities of the log at its own rate. ``state.last`` is its own last torque.
    Where the log has to be filtered, for a reference or for velocities, its first and last tenths of a second are left
    out. The log shows neither how the leg would have moved under that torque, nor what a controller that adapts would
    have learned.

    Args:
        law: Controller with or without memory.
        recording: The log, at least as fast as the controller. Without velocities, those of its filtered angles count.
        reference: Reference to follow from the first sample on; None for the motion of the log itself, so that feedback
            is small and the model's torque remains.
        name: Name of the controller in tables; None for its class.

    Returns:
        Commanded and recorded torque.

    Raises:
        ExoidError: The log has a gap or fewer samples than the controller's rate asks for, the controller does not fit
            its joints, or a torque is not finite.

    Example:
        >>> data = exoid.datasets.bleex_swing()
        >>> half = exoid.control.gravity_support(data.leg, 0.5)
        >>> replay_law(half, data.train).commanded.shape[1]
        3
    """
    where = recording.file_name
    inner = getattr(law, "law", law)
    leg = getattr(getattr(inner, "model", getattr(inner, "source", None)), "leg", None)
    recording = recording if leg is None else TorqueModel(leg, ()).select(recording)  # by name, not by order
    with in_file(where):
        refuse_gaps(recording.time)
    if recording.sample_rate < 0.99 * law.rate:
        what = f"a log of {recording.sample_rate:.4g} Hz for a controller at {law.rate:g} Hz"
        remedy = "record faster, or make the controller with the rate of the log"
        raise BadArgumentError(what, where=where, remedy=remedy)
    followed = follow_log(recording) if reference is None or recording.v is None else None
    elapsed = recording.time - recording.time[0]
    edge = 0.0 if followed is None else followed.edge
    first, last = np.ceil(max(0.0, edge * law.rate - 1e-9)), np.floor((elapsed[-1] - edge) * law.rate + 1e-9)
    times = np.arange(first, last + 1) / law.rate
    if len(times) < 2:
        what = f"a log of {elapsed[-1]:g} s is too short"
        raise BadArgumentError(what, where=where, remedy="give one of several seconds")
    q = _sampled(recording.q, elapsed, times)
    if recording.v is not None:
        v = _sampled(recording.v, elapsed, times)
    else:
        assert followed is not None
        v = np.array([followed.at(float(t)).v[:, 0] for t in times])
    aims = followed if reference is None else reference
    assert aims is not None
    recorded = np.full_like(q, np.nan) if recording.tau is None else _sampled(recording.tau, elapsed, times)
    limits = (law.limit, law.slew) if isinstance(law, Limited) else (np.inf, np.inf)
    limit, slew = (np.broadcast_to(np.asarray(x, dtype=np.float64), (recording.n_joints,)) for x in limits)
    label = name_of(law) if name is None else name
    run, commanded = RunningLaw(law, int(first)), np.empty_like(q)
    for k, time in enumerate(times.tolist()):
        aim = Target(*(None if x is None else x[:, 0] for x in aims.at(time)))  # type: ignore[arg-type]
        with within(f"at {time:g} s"):
            commanded[k] = sound(run.command(q[k], v[k], aim), State(q[k], v[k]), aim)
    units = (TURNS,) * recording.n_joints if leg is None else position_units(leg)
    return LawReplay(
        label, law.rate, recording.joint_names, recording.time[0] + times, commanded, recorded, limit, slew, units
    )


def _sampled(values: FloatArray, elapsed: FloatArray, times: FloatArray) -> FloatArray:
    """Columns at other times, (N, n), interpolated between samples."""
    return np.column_stack([np.interp(times, elapsed, column) for column in values.T])
