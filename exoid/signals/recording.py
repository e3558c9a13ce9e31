"""Recording: a checked, frozen log of one motion."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError
from exoid.torso import TorsoMotion

from . import checks, timebase
from .csv_writer import write_csv
from .formats import Table, Wanted, open_table, read_text_table
from .log import read_log
from .source import Source
from .source_location import SourceLocation


@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """A motion and the torques that made it, checked when it is made and unchangeable afterwards.

    Arrays are copied to float64, C-contiguous and read-only; samples are rows, joints are columns. Two
    recordings are equal only if they are the same object.

    Attributes:
        time: Stamps [s], (N,), strictly increasing, N ≥ 10.
        q: Joint angles [rad], (N, n).
        v: Joint velocities [rad/s], (N, n), or None: derived from ``q`` when needed.
        a: Joint accelerations [rad/s²], (N, n), or None: derived when needed.
        tau: Actuator torques [N·m], (N, n), or None: a motion without torques.
        joint_names: Names of the n columns.
        source: File the data came from, or None.
        torso: How the torso was held meanwhile, the same at all samples; None for upright and still.
        largest_angle: Angles beyond this [rad] are refused as degrees in disguise; ``math.inf`` for a joint
            that turns round and round.

    Raises:
        ExoidError: Shapes disagree, values are missing, time does not increase, units look wrong, or there
            are too few samples; says where and what to do.

    Example:
        >>> t = np.arange(100) / 50.0
        >>> Recording(time=t, q=0.3 * np.sin(t)[:, np.newaxis], joint_names=("knee",))
        Recording(100 samples at 50 Hz, 1.98 s; joints: knee; q)
    """

    time: FloatArray
    q: FloatArray
    v: FloatArray | None = None
    a: FloatArray | None = None
    tau: FloatArray | None = None
    _: KW_ONLY
    joint_names: tuple[str, ...]
    source: Source | None = None
    torso: TorsoMotion | None = None
    largest_angle: float = checks.LARGEST_ANGLE

    def __post_init__(self) -> None:
        self._freeze()
        self._check()

    def _freeze(self) -> None:
        if isinstance(self.joint_names, str):
            names = repr(self.joint_names)
            raise ExoidError(f"joint_names is the string {names}", remedy=f"pass joint_names=({names},)")
        object.__setattr__(self, "joint_names", tuple(self.joint_names))
        for name in ("time", "q", "v", "a", "tau"):
            values = getattr(self, name)
            if values is not None or name in ("time", "q"):
                object.__setattr__(self, name, checks.as_numbers(values, name))

    def _check(self) -> None:
        where, names, samples = SourceLocation(), self.joint_names, self.time.size
        checks.refuse_names(names)
        if not names:
            raise ExoidError("joint_names is empty", remedy="name each column of q")
        checks.refuse_shape(self.time, (samples,), "time")
        for quantity, values in self._arrays().items():
            checks.refuse_shape(values, (samples, len(names)), quantity)
        checks.refuse_too_few(samples, where)
        checks.refuse_not_finite(self.time[:, np.newaxis], ("time",), where)
        for quantity, values in self._arrays().items():
            columns = tuple(f"{quantity}_{name}" for name in names)
            checks.refuse_not_finite(values, columns, where)
            checks.refuse_absurd(values, columns, where)
        checks.refuse_time_disorder(self.time, where)
        checks.refuse_degrees(self.q, tuple(f"q_{name}" for name in names), self.largest_angle, where)
        checks.refuse_moving_torso(self.torso)
        if self.v is not None:
            checks.refuse_velocity_in_other_unit(self.time, self.q, self.v, names, where)

    def _arrays(self) -> dict[str, FloatArray]:
        arrays = {"q": self.q, "v": self.v, "a": self.a, "tau": self.tau}
        return {name: values for name, values in arrays.items() if values is not None}

    def _with(self, **changes: Any) -> Recording:  # noqa: ANN401 - fields of several types
        return replace(self, **changes)

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        size = f"{len(self)} samples at {self.sample_rate:.4g} Hz, {self.duration:.4g} s"
        uneven = "" if self.is_uniform else " (uneven)"
        return f"Recording({size}{uneven}; joints: {', '.join(self.joint_names)}; {', '.join(self._arrays())})"

    @property
    def n_joints(self) -> int:
        """Number of joints, n."""
        return len(self.joint_names)

    @property
    def duration(self) -> float:
        """Time from the first stamp to the last [s]."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def is_uniform(self) -> bool:
        """Whether every interval is the median one to within a thousandth of it."""
        return timebase.is_uniform(self.time)

    @cached_property
    def sample_rate(self) -> float:
        """Sampling rate [Hz]: the mean rate when uniform, else one over the median interval."""
        return timebase.sampling_rate(self.time)

    def select(self, joint_names: Sequence[str]) -> Recording:
        """Return the same motion with these joints, in this order.

        Raises:
            ExoidError: A name is not among `joint_names`; lists what exists.
        """
        names = (joint_names,) if isinstance(joint_names, str) else tuple(joint_names)
        for name in names:
            if name not in self.joint_names:
                raise ExoidError(
                    f"no joint {name!r} in the recording; it has: {', '.join(self.joint_names)}",
                    where=self.source.name if self.source else "",
                    remedy="select among those, or read the log with columns={'q_<joint>': <header>}",
                )
        chosen = [self.joint_names.index(name) for name in names]
        arrays = {quantity: values[:, chosen] for quantity, values in self._arrays().items()}
        return self._with(joint_names=names, **arrays)

    def slice(self, start: int | None = None, stop: int | None = None) -> Recording:
        """Return rows ``start`` to before ``stop``, counted as Python does.

        Raises:
            ExoidError: Fewer than 10 rows are left.
        """
        arrays = {quantity: values[start:stop] for quantity, values in self._arrays().items()}
        return self._with(time=self.time[start:stop], **arrays)

    def between(self, start: float, stop: float) -> Recording:
        """Return the rows stamped ``start`` ≤ time < ``stop`` [s].

        Raises:
            ExoidError: Fewer than 10 rows are left.
        """
        first, last = np.searchsorted(self.time, [start, stop])
        return self.slice(int(first), int(last))

    def resampled(self, rate: float | None = None) -> Recording:
        """Return the motion on even stamps, starting at the first one.

        Angles and velocities pass a cubic spline; accelerations and torques, which friction lets jump, a
        monotone cubic (PCHIP) that does not overshoot.

        Args:
            rate: New sampling rate [Hz], not below the present one: leaving samples out would fold fast
                signals onto slow ones. None keeps the present rate, and a uniform recording as it is.

        Raises:
            ExoidError: Time has a gap, or the rate is not between 0.99 and 100 times the recording's.
        """
        if rate is None and self.is_uniform:
            return self
        own = self.sample_rate
        new = own if rate is None else float(rate)
        if not 0.99 * own <= new <= 100.0 * own:
            raise ExoidError(
                f"cannot resample from {own:.4g} Hz to {new:.4g} Hz",
                remedy="keep the rate: a lower one folds fast signals onto slow ones",
            )
        timebase.refuse_gaps(self.time, SourceLocation())
        rows = timebase.uncrowded(self.time)
        time = self.time[rows]
        grid = timebase.even_grid(time, new)
        arrays = {
            quantity: timebase.interpolate(time, values[rows], grid, smooth=quantity in ("q", "v"))
            for quantity, values in self._arrays().items()
        }
        return self._with(time=grid, **arrays)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write ``time, q_<joint>, …`` so that `from_csv` reads it back bit by bit; whole or not at all.

        Raises:
            ExoidError: The file cannot be written.
        """
        arrays = self._arrays()
        header = ["time", *(f"{quantity}_{name}" for quantity in arrays for name in self.joint_names)]
        write_csv(path, header, np.column_stack([self.time, *arrays.values()]))

    @classmethod
    def from_csv(
        cls,
        path: str | os.PathLike[str],
        joint_names: Sequence[str] | None = None,
        columns: Mapping[str, str] | None = None,
        *,
        angle_unit: Literal["rad", "deg"] = "rad",
        largest_angle: float = checks.LARGEST_ANGLE,
        resample: bool = True,
    ) -> Recording:
        """Read a log with columns ``time, q_<joint>, v_<joint>, a_<joint>, tau_<joint>``.

        Text in UTF-8 with one header line; commas, semicolons or tabs; lines starting with ``#`` are
        skipped. Velocity, acceleration and torque may be absent, but each for all joints. Other columns
        are ignored.

        Args:
            path: The file.
            joint_names: Joints wanted, in order; None for those of the ``q_`` columns, in the file's order.
            columns: The file's header for exoid's column name where they differ, e.g.
                ``{"time": "t", "q_hip": "pos1"}``.
            angle_unit: Unit of angles in the file; "deg" applies to q, v and a.
            largest_angle: Larger angles [rad] are refused as degrees in disguise.
            resample: Bring uneven stamps onto an even grid, as `resampled` does.

        Raises:
            ExoidError: The file cannot be trusted; names file, line, column and remedy.
        """
        table = read_text_table(path)
        return cls._from_table(table, joint_names, columns, angle_unit, largest_angle, resample)

    @classmethod
    def from_file(
        cls,
        path: str | os.PathLike[str],
        joint_names: Sequence[str] | None = None,
        columns: Mapping[str, str] | None = None,
        *,
        angle_unit: Literal["rad", "deg"] = "rad",
        largest_angle: float = checks.LARGEST_ANGLE,
        resample: bool = True,
        topic: str | None = None,
        stamps: Literal["header", "received"] = "header",
    ) -> Recording:
        """Read a log of any kind: its first bytes say which, or an ending that :func:`register_format` made known.

        * CSV, as :meth:`from_csv`.
        * Parquet, columns named as in CSV (needs ``exoid[io]``).
        * NumPy ``.npz`` and MATLAB ``.mat`` (up to version 7; variables, or the fields of one struct): arrays ``time``,
          ``q``, ``v``, ``a``, ``tau`` of (samples, joints) and text ``joint_names``, or one array a column. Where the
          joints are not in the file, ``joint_names`` names the columns of the matrices, all of them. Columns of other
          matrices are called ``pos[0]``, ``pos[1]``, …; fields in structs ``log.pos[0]``.
        * ``sensor_msgs/JointState`` in a rosbag2 (folder, ``.mcap`` or ``.db3``) or a bag of ROS 1 (needs
          ``exoid[io]``), joints in any order; effort is torque. Time counts from the first message.

        Args:
            path: The file, or the folder of a rosbag2.
            joint_names: See :meth:`from_csv`.
            columns: See :meth:`from_csv`.
            angle_unit: See :meth:`from_csv`.
            largest_angle: See :meth:`from_csv`.
            resample: See :meth:`from_csv`.
            topic: Of a bag with several topics of joint states.
            stamps: Of a bag: "header", when the joints were measured, or "received", when the bag got the message.

        Raises:
            ExoidError: The file cannot be trusted; names file, row, column and remedy.

        Example:
            >>> Recording.from_file("walk.mcap", columns={"q_hip": "q_left_hip_joint"})  # doctest: +SKIP
        """
        table = open_table(path, Wanted(joint_names, dict(columns or {}), topic, stamps))
        return cls._from_table(table, joint_names, columns, angle_unit, largest_angle, resample)

    @classmethod
    def _from_table(
        cls,
        table: Table,
        joint_names: Sequence[str] | None,
        columns: Mapping[str, str] | None,
        angle_unit: Literal["rad", "deg"],
        largest_angle: float,
        resample: bool,
    ) -> Recording:
        """Check a table and make a recording of it."""
        log = read_log(table, joint_names, columns, angle_unit, largest_angle)
        if resample and not timebase.is_uniform(log.time):
            timebase.refuse_gaps(log.time, log.where)
        arrays: dict[str, Any] = dict(log.arrays)
        recording = cls(
            log.time,
            **arrays,
            joint_names=log.joint_names,
            source=log.source,
            largest_angle=largest_angle,
        )
        return recording.resampled() if resample else recording
