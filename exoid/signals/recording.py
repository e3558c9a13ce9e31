"""Recording: a checked, immutable log of one motion."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from exoid._typing import BoolArray
from exoid.errors import BadArgumentError, in_file

from . import checks, timebase
from .column import Column
from .csv_writer import LogPart, write_parts
from .external import refuse_contradictions
from .joined import join
from .log import read_log
from .log_parts import log_of_base, log_of_external
from .quantities import PREFIXES, QUANTITIES, UNITS, USUAL
from .readers import ReadOptions
from .readers.formats import open_table
from .readers.options import refuse_unknown_options
from .readers.text import PAYLOAD
from .recording_data import RecordingData, absent_columns, change_samples

if TYPE_CHECKING:
    from typing_extensions import Unpack


@dataclass(frozen=True, eq=False, repr=False)
class Recording(RecordingData):
    """Log of a motion and of the torques that caused it, checked when it is made and immutable afterwards.

    Arrays are copied to float64, C-contiguous and read-only. Samples are rows, joints are columns. Two recordings are
    equal only if they are the same object.

    Attributes:
        time: Time stamps [s], (N,), strictly increasing, N ≥ 10.
        q: Joint angles [rad], (N, n).
        v: Joint velocities [rad/s], (N, n); None to derive them from ``q``.
        a: Joint accelerations [rad/s²], (N, n); None to derive them.
        tau: Actuator torques [N·m], (N, n); None for a motion without torques. The column of a joint whose torque was
            not measured is NaN throughout: the joint takes part in the motion, and its torque gives no rows.
        joint_names: Names of the n columns.
        source: File of the data; None for arrays made in memory.
        mask: Samples that count, (N,): only these become rows of τ = W β; None if all do. The angles of the others
            are still needed for velocity and acceleration, their torques are not used. See :meth:`segments`.
        torso: Tilt of the torso, the same at all samples; None if it is upright and still.
        largest_angle: Limit of the angles [rad], beyond which they count as degrees; ``math.inf`` for a joint that
            makes full turns.
        current: Motor currents [A], (N, n); NaN throughout where a joint has none. None without currents.
        force: Forces of linear actuators [N], (N, n); NaN throughout where a joint has none. None without forces.
        motor_torque: Torques of motors that coupling gears connect to the joints [N·m], (N, n): motor k is in the
            column of joint k of the coupling. None without.
        motor_angle: Angles of motors behind series springs [rad], (N, n). None without.
        passive: Joints without an actuator. Their torque is known to be zero, and gives rows.
        computed: Joints whose torque was computed of what their drive measured, see :class:`exoid.actuators.Actuators`.
        payloads: Weighed bodies that were strapped to the leg. Their torque is known, and is taken out of the measured
            one.
        base: Motion of the base, for a leg whose torso moves, such as that of a walking wearer; None if it stands
            still. It excludes ``torso``.
        wrenches: Measured forces and moments of the surroundings on links, by name of the link in the URDF: the ground
            on a foot, a hand rail or harness on the root link.
        contacts: Samples at which a link is fixed to the ground, flat and without slip, by name of the link, (N,) each.
            A link that is here and not in ``wrenches`` has an unknown wrench while True, and none while False.

    Raises:
        ExoidError: Shapes do not fit, values are missing, time does not increase, units look wrong, or there are too
            few samples. The error says where, and what to do.

    Example:
        >>> t = np.arange(100) / 50.0
        >>> Recording(time=t, q=0.3 * np.sin(t)[:, np.newaxis], joint_names=("knee",))
        Recording(100 samples at 50 Hz, 1.98 s; joints: knee; q)
    """

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        arrays = self._arrays()
        named = ", ".join(name if name in USUAL else f"{name} [{UNITS[name]}]" for name in arrays)
        without = [name for name, there in zip(self.joint_names, self.measured, strict=True) if not there]
        unmeasured = f"; torque not measured: {', '.join(without)}" if without and self.tau is not None else ""
        passive = f"; passive: {', '.join(self.passive)}" if self.passive else ""
        payloads = f"; payloads: {', '.join(map(str, self.payloads))}" if self.payloads else ""
        joints = ", ".join(self.joint_names)
        base = "" if self.base is None else "; moving base"
        ground = f"; wrenches: {', '.join(self.wrenches)}" if self.wrenches else ""
        ground += f"; contacts: {', '.join(self.contacts)}" if self.contacts else ""
        uneven = "" if self.is_uniform else " (uneven)"
        part = "" if self.mask is None else f", {np.count_nonzero(self.mask)} in {len(self.segment_times)} segments"
        size = f"{len(self)} samples at {self.sample_rate:.4g} Hz, {self.duration:.4g} s{uneven}{part}"
        return f"Recording({size}; joints: {joints}; {named}{unmeasured}{passive}{payloads}{base}{ground})"

    @property
    def n_joints(self) -> int:
        """Number of joints, n."""
        return len(self.joint_names)

    @property
    def measured(self) -> BoolArray:
        """Joints whose torque is known, because it was measured or the joint is passive, (n,)."""
        if self.tau is None:
            return np.zeros(self.n_joints, dtype=np.bool_)
        return np.asarray(~np.isnan(self.tau[0]))  # a column is NaN throughout or nowhere

    @property
    def driven(self) -> BoolArray:
        """Joints whose torque was measured: known, and not by being passive, (n,)."""
        return np.array(
            [there and name not in self.passive for name, there in zip(self.joint_names, self.measured, strict=True)]
        )

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def is_uniform(self) -> bool:
        """Whether every sampling interval is within a thousandth of the median."""
        return timebase.is_uniform(self.time)

    @cached_property
    def sample_rate(self) -> float:
        """Sampling rate [Hz]: the mean rate if uniform, else one over the median interval."""
        return timebase.sampling_rate(self.time)

    def select(self, joint_names: Sequence[str]) -> Recording:
        """Select joints.

        Args:
            joint_names: Names of the joints, in the new order.

        Returns:
            The recording of these joints.

        Raises:
            ExoidError: A joint is not in the recording.
        """
        names = (joint_names,) if isinstance(joint_names, str) else tuple(joint_names)
        for name in names:
            if name not in self.joint_names:
                raise BadArgumentError(
                    f"no joint {name!r} in the recording; it has: {', '.join(self.joint_names)}",
                    where=self.file_name,
                    remedy="select among those, or read the log with columns={'q_<joint>': <header>}",
                    command=f"record it, or map its columns, e.g. --column q_{name}=HEADER --column tau_{name}=HEADER",
                )
        chosen = [self.joint_names.index(name) for name in names]
        arrays = {quantity: values[:, chosen] for quantity, values in self._arrays().items()}
        passive = tuple(name for name in self.passive if name in names)
        computed = tuple(name for name in self.computed if name in names)
        return replace(self, joint_names=names, passive=passive, computed=computed, **arrays)

    def slice(self, start: int | None = None, stop: int | None = None) -> Recording:
        """Select consecutive samples, as ``x[start:stop]`` does.

        Args:
            start: First sample; None for the beginning.
            stop: Sample after the last one; None for the end.

        Returns:
            The recording of these samples.

        Raises:
            ExoidError: Fewer than 10 samples are left.
        """
        rows = slice(start, stop)
        arrays = {quantity: values[rows] for quantity, values in {"time": self.time, **self._arrays()}.items()}
        return change_samples(self, arrays, lambda part: part.rows(rows), lambda flags: flags[rows])

    def segments(self, segments: Iterable[tuple[float, float]]) -> Recording:
        """Let only samples in some segments count, such as the swing phases of a walk.

        Unlike :meth:`between`, this does not cut the recording: velocity and acceleration are derived from all of it,
        so that segments lose nothing at their ends. The torque outside is not used, and τ = W β need not hold there.

        Args:
            segments: Start and stop of each segment [s]: samples with start ≤ time < stop count.

        Returns:
            The recording with a mask; samples that did not count before do not count either.

        Raises:
            ExoidError: A segment is not a pair of times, ends before it starts, or contains no sample.
        """
        inside = np.zeros(len(self), dtype=np.bool_)
        for start, stop in checks.as_segments(segments):
            first, last = np.searchsorted(self.time, [start, stop])
            if first == last:
                raise BadArgumentError(
                    f"no sample in the segment from {start:.6g} s to {stop:.6g} s",
                    where=self.file_name,
                    remedy=f"the recording lasts from {self.time[0]:.6g} s to {self.time[-1]:.6g} s",
                )
            inside[first:last] = True
        return replace(self, mask=inside if self.mask is None else inside & self.mask)

    @property
    def segment_times(self) -> tuple[tuple[float, float], ...]:
        """First and last time stamp of each segment of the mask [s]; empty if all samples count."""
        if self.mask is None:
            return ()
        edges = np.flatnonzero(np.diff(self.mask, prepend=False, append=False))
        pairs = zip(edges[::2], edges[1::2], strict=True)
        return tuple((float(self.time[first]), float(self.time[stop - 1])) for first, stop in pairs)

    def between(self, start: float | None = None, stop: float | None = None) -> Recording:
        """Select the samples with ``start`` ≤ time < ``stop``.

        Args:
            start: Time of the first sample [s]; None for the beginning.
            stop: Time before which the last sample lies [s]; None for the end.

        Returns:
            The recording of these samples.

        Raises:
            ExoidError: A time is no number, or fewer than 10 samples are left; names the times of the recording.
        """
        where = self.file_name
        low = -np.inf if start is None else start
        high = np.inf if stop is None else stop
        for limit in (low, high):
            if not isinstance(limit, float | int | np.floating | np.integer) or np.isnan(limit):
                raise BadArgumentError(f"a limit of {limit!r} s", where=where, remedy="give seconds, or None")
        first, last = np.searchsorted(self.time, [low, high])
        if last - first < checks.FEWEST_SAMPLES:
            begins, ends = self.time[[0, -1]].tolist()
            raise BadArgumentError(
                f"too few samples: {max(0, last - first)} from {low:g} s to {high:g} s, at least "
                f"{checks.FEWEST_SAMPLES} are needed; its time stamps are {begins:g} s to {ends:g} s",
                where=where,
                remedy="give time stamps of the log",
                command="give time stamps of the log to --start and --stop",
            )
        return self.slice(int(first), int(last))

    def resampled(self) -> Recording:
        """Resample onto uniform time stamps, starting at the first one, unless they are uniform.

        Angles and velocities are interpolated by a cubic spline. Accelerations, torques, currents and forces, which
        friction makes jump, are interpolated by a monotone cubic (PCHIP), which does not overshoot.

        Returns:
            The uniform recording.

        Raises:
            ExoidError: Time has a gap.
        """
        if self.is_uniform:
            return self
        timebase.refuse_gaps(self.time)
        # Stamps of arrival come in bursts, and a spline through two points with almost the same stamp oscillates
        intervals = np.diff(self.time, prepend=-np.inf)
        rows = intervals >= 0.25 * np.median(intervals)
        time = self.time[rows]
        grid = timebase.even_grid(time, self.sample_rate)
        smooth = {quantity.field: quantity.smooth for quantity in QUANTITIES}
        arrays = {
            field: timebase.interpolate(time, values[rows], grid, smooth=smooth[field])
            for field, values in self._arrays().items()
        }
        carried_over = partial(timebase.interpolate_mask, self.time, grid=grid)
        return change_samples(
            self, {"time": grid, **arrays}, lambda part: part.interpolated(time, grid, rows), carried_over
        )

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write columns ``time, q_<joint>, …``, which `from_csv` reads back exactly.

        A mask becomes a column ``mask`` of 0 and 1, which ``from_csv(path, mask="mask")`` reads. What was not measured
        has no column, nor has ``torso``: set it again after reading. A passive joint has a torque of zeros, which
        ``from_csv(path, passive=...)`` reads. Lines above the header, which ``from_csv`` reads, have the payloads, as
        ``# payload: knee:3.0@0.0,0.0,-0.3``, the position of the sensor of a base motion, as
        ``# base position: 0.1,0.0,0.2``, and axes and point of wrenches, as ``# wrench: left_foot:link@0.0,0.0,-0.08``.

        Args:
            path: File to write; an existing one is replaced only when the new one is complete.

        Raises:
            ExoidError: The file cannot be written.
        """
        arrays = {PREFIXES[quantity]: values for quantity, values in self._arrays().items()}
        there = {prefix: np.flatnonzero(~absent_columns(values)) for prefix, values in arrays.items()}
        parts = [
            LogPart(["time"], [self.time], [f"{PAYLOAD} {payload}" for payload in self.payloads]),
            *(
                LogPart([f"{prefix}_{self.joint_names[k]}" for k in there[prefix]], [values[:, there[prefix]]])
                for prefix, values in arrays.items()
            ),
            *([] if self.base is None else [log_of_base(self.base)]),
            log_of_external(self.wrenches, self.contacts),
            *([] if self.mask is None else [LogPart(["mask"], [self.mask.astype(np.float64)])]),
        ]
        write_parts(path, parts)

    @classmethod
    def from_csv(
        cls,
        path: str | os.PathLike[str],
        joint_names: Sequence[str] | None = None,
        columns: Mapping[str, str | Column] | None = None,
        **options: Unpack[ReadOptions],
    ) -> Recording:
        """Read a CSV log with columns ``time, q_<joint>, v_<joint>, a_<joint>, tau_<joint>``, of drives and base.

        The file is UTF-8 text with one header line, separated by commas, semicolons or tabs. Lines that start with
        ``#`` are skipped. Velocity and acceleration may be absent, but each for all joints. Torque τ, and of drives
        current ``i_`` [A], force ``f_`` [N], motor torque ``tm_`` [N·m] and motor angle ``qm_`` [rad] may be absent for
        any joint. A base that moves has ``base_gyro_x…z`` [rad/s] and ``base_acc_x…z`` [m/s²], or a pose
        ``base_x…z`` [m], ``base_qx…w``, see :class:`BaseMotion`. What acts on links
        is ``wrench_<link>_fx…fz`` [N], ``wrench_<link>_mx…mz`` [N·m] and ``contact_<link>`` (0 or 1), see
        :class:`Wrench`; a point that moves in the laboratory is ``wrench_<link>_px…pz`` [m]. Other columns are ignored.

        Args:
            path: The file.
            joint_names: Joints to read, in order; None for those of the ``q_`` columns, in the file's order.
            columns: Header in the file of each exoid column whose name differs, or the header with scale, zero and
                unit, e.g. ``{"time": "t", "tau_hip": Column("current", scale=0.118)}``.
            **options: Options of :class:`exoid.signals.ReadOptions`, such as ``angle_unit="deg"``.

        Returns:
            The recording.

        Raises:
            ExoidError: The file cannot be read, or its data fail a check. The error names file, line and column.
        """
        return cls.from_file(path, joint_names, columns, **options)

    @classmethod
    def from_file(
        cls,
        path: str | os.PathLike[str],
        joint_names: Sequence[str] | None = None,
        columns: Mapping[str, str | Column] | None = None,
        **options: Unpack[ReadOptions],
    ) -> Recording:
        """Read a log of any format: its first bytes say which.

        * CSV, as :meth:`from_csv`.
        * Parquet, columns named as in CSV (needs ``exoid[io]``).
        * NumPy ``.npz`` and MATLAB ``.mat`` (up to version 7; variables, or the fields of one struct): arrays ``time``,
          ``q``, ``v``, ``a``, ``tau`` of (samples, joints) and text ``joint_names``, or one array per column. If the
          file has no ``joint_names``, the argument names the columns of the matrices. Columns of other matrices are
          called ``pos[0]``, ``pos[1]``, …; fields in structs ``log.pos[0]``.
        * OpenSim ``.mot`` and ``.sto``; the header says whether q, v and a are in degrees. ``columns`` names the
          coordinates. :func:`exoid.signals.read_opensim` reads forces and pelvis too.
        * ``sensor_msgs/JointState`` in a rosbag2 (folder, ``.mcap`` or ``.db3``) or a ROS 1 bag (needs ``exoid[io]``),
          joints in any order; effort is torque. Time starts at the first message.

        Args:
            path: The file, or the folder of a rosbag2.
            joint_names: See :meth:`from_csv`.
            columns: See :meth:`from_csv`.
            **options: Options of :class:`exoid.signals.ReadOptions`, such as ``topic="/joints"``.

        Returns:
            The recording.

        Raises:
            ExoidError: The file cannot be read, or its data fail a check. The error names file, row and column.

        Example:
            >>> Recording.from_file("walk.mcap", columns={"q_hip": "q_left_hip_joint"})  # doctest: +SKIP
        """
        mapped = {name: Column(one) if isinstance(one, str) else one for name, one in (columns or {}).items()}
        headers = {name: column.header for name, column in mapped.items()}
        with in_file(os.fsdecode(path)):
            refuse_unknown_options(options)
            table = open_table(path, {**options, "joint_names": joint_names, "columns": headers})
            if options.get("beside"):
                table = join(table, options["beside"], mapped.get("time", Column("time")))
            recording = cls(**read_log(table, joint_names, mapped, options))
            refuse_contradictions(recording.time, recording.wrenches, recording.contacts)
            return recording.resampled() if options.get("resample", True) else recording
