"""Checks of a recording: each function raises one kind of error, or does nothing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike, BoolArray, FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError

from .quantities import PREFIXES, UNITS
from .source import ARRAY, Evidence, SourceLocation

FEWEST_SAMPLES = 10  # of a recording
SLOWEST = 0.5
"""Sampling interval from which on time is not in seconds [s]: 2 Hz show no motion of a leg, and are 2 kHz in ms."""

FASTEST = 50.0
"""Speed that no leg reaches [rad/s]: an angle that changes faster jumped."""


def as_numbers(values: ArrayLike, name: str) -> FloatArray:
    """Copy values to a C-contiguous, read-only float64 array."""
    try:
        masked = isinstance(values, np.ma.MaskedArray)
        raw = np.ma.filled(np.ma.asarray(values, dtype=np.float64), np.nan) if masked else np.asarray(values)
        if raw.dtype.kind not in "iufO":
            raise TypeError(f"its elements are {raw.dtype}")
        numbers = np.array(raw, dtype=np.float64, order="C")
    except (TypeError, ValueError) as problem:
        raise BadArgumentError(
            f"{name} is not an array of real numbers: {problem}", remedy=f"pass {name} as a float array in SI units"
        ) from None
    numbers.flags.writeable = False
    return numbers


def as_mask(values: ArrayLike, what: str = "mask") -> BoolArray:
    """Copy a mask to a read-only array of bools; numbers must be 0 or 1."""
    raw = np.asarray(values)
    if raw.dtype.kind not in "biuf" or not np.isin(raw, (0, 1)).all():
        raise BadArgumentError(
            f"{what} has values other than 0 and 1",
            remedy="pass a bool for each sample",
            command="map a column of 0 and 1, or scale it: NAME=HEADER:SCALE (--column)",
        )
    mask = np.array(raw, dtype=np.bool_)
    mask.flags.writeable = False
    return mask


def as_direction(up: ArrayLike) -> FloatArray:
    """Normalise the direction against gravity, (3,)."""
    vector = as_numbers(up, "up")
    refuse_shape(vector, (3,), "up")
    size = float(np.linalg.norm(vector))
    if not 1e-9 < size < np.inf:
        raise BadArgumentError("up has no direction", remedy="pass the direction against gravity, such as (0, 0, 1)")
    return np.asarray(vector / size)


def as_names(names: Sequence[str], argument: str) -> tuple[str, ...]:
    """Refuse a string where several names are expected."""
    if isinstance(names, str):
        raise BadArgumentError(f"{argument} is the string {names!r}", remedy=f"pass {argument}=({names!r},)")
    return tuple(names)


def as_joints(names: Sequence[str], joints: tuple[str, ...], argument: str) -> tuple[str, ...]:
    """Check that names are names of joints."""
    for name in as_names(names, argument):
        if name not in joints:
            raise BadArgumentError(
                f"{argument} names {name!r}, which is not in the recording",
                remedy=f"its joints are {', '.join(map(str, joints))}",
            )
    return tuple(names)


def with_zero_torque(measured: Mapping[str, Any], shape: tuple[int, int]) -> FloatArray:
    """Set the torque of passive joints to zero; refuse one that is not, and what a drive there measured."""
    places = {joint: measured["joint_names"].index(joint) for joint in measured["passive"]}
    for field in ("tau", "current", "force", "motor_torque"):
        values: Any = measured.get(field)
        for joint, place in places.items() if np.shape(values) == shape else ():  # checks of shapes refuse any other
            name, largest = f"{PREFIXES[field]}_{joint}", np.nan_to_num(np.abs(values[:, place])).max(initial=0.0)
            if largest > 0.0:
                raise BadArgumentError(
                    f"joint {joint} is declared passive, and {name} is up to {largest:.4g} {UNITS[field]}",
                    remedy=f"leave it out of passive if an actuator drives it, or drop {name} if that is noise",
                    command=f"leave it out of --passive if driven; if that is noise, give --unmeasured {joint} too",
                    joints=(joint,),
                )
    out = np.full(shape, np.nan) if measured.get("tau") is None else measured["tau"].copy()
    if out.shape == shape:
        out[:, [*places.values()]] = 0.0
    out.flags.writeable = False
    return out


def _cell(
    rank: FloatArray | BoolArray, values: FloatArray, columns: Sequence[str], where: SourceLocation
) -> tuple[float, str, Evidence]:
    """Value, name and place of the cell of the highest rank."""
    row, column = np.unravel_index(int(rank.argmax()), rank.shape)
    name = columns[int(column)]
    return float(values[row, column]), name, where.evidence(int(row), name)


def refuse_not_finite(values: FloatArray, columns: Sequence[str], where: SourceLocation = ARRAY) -> None:
    """Refuse NaN and infinity."""
    bad = ~np.isfinite(values)
    if bad.any():
        value, _, place = _cell(bad, values, columns, where)
        raise UnreadableInputError(
            f"{value} is not a finite number ({np.count_nonzero(bad)} such values in all)",
            **place,
            remedy="drop those rows, or fill them by a documented method",
        )


def refuse_implausible(field: str, values: FloatArray, columns: Sequence[str], where: SourceLocation = ARRAY) -> None:
    """Refuse values that no leg has: arithmetic would overflow, or currents in mA."""
    size = np.abs(values)
    if size.size and size.max() > 1e9:
        value, _, place = _cell(size, values, columns, where)
        raise UnreadableInputError(
            f"{value:.6g} is not plausible for a leg (limit 1e+09, SI)",
            **place,
            remedy="check unit and logger, or drop those rows",
        )
    if field == "current" and size.size and size.max() > 500.0:
        value, name, place = _cell(size, values, columns, where)
        raise UnreadableInputError(
            f"a current of {value:.6g} A (limit 500 A) looks like mA",
            **place,
            remedy=f'pass columns={{"{name}": exoid.signals.Column(<header>, unit="mA")}} where the file is read, or '
            "divide by 1000",
            command=f"give its unit: --column {name}=HEADER:mA",
        )


def refuse_degrees(q: FloatArray, columns: Sequence[str], largest: float, where: SourceLocation = ARRAY) -> None:
    """Refuse angles that look like degrees."""
    if not largest > 0.0:
        raise BadArgumentError(f"largest_angle is {largest}", remedy="pass a positive angle in rad, or math.inf")
    size = np.abs(q)
    if size.size and size.max() > largest:
        value, name, place = _cell(size, q, columns, where)
        raise UnreadableInputError(
            f"an angle of {value:.6g} rad (limit {largest:.4g} rad) looks like degrees, or a slide in mm",
            **place,
            remedy='pass angle_unit="deg" where the file is read (--degrees) or np.deg2rad(q) to Recording; '
            "if the joint really turns that far, largest_angle=math.inf",
            command=f"give --degrees, --column {name}=HEADER:0.001 for mm, or --radians if it really turns so far",
        )


def as_segments(segments: Iterable[tuple[float, float]]) -> FloatArray:
    """Check segments of a recording."""
    pairs = list(segments)
    times = as_numbers(pairs, "segments") if pairs else np.zeros((0, 2))
    if times.ndim != 2 or times.shape[1] != 2 or not len(times):
        raise BadArgumentError(
            "segments are not pairs of start and stop", remedy="pass [(start, stop), ...] in seconds"
        )
    wrong = ~(times[:, 0] < times[:, 1]) | ~np.isfinite(times).all(axis=1)
    if wrong.any():
        start, stop = times[int(wrong.argmax())]
        raise BadArgumentError(
            f"a segment from {start:.6g} s to {stop:.6g} s", remedy="give start before stop, in seconds"
        )
    return times


def refuse_names(names: tuple[object, ...], kind: str = "joint") -> None:
    """Refuse names of joints or links that are not unique, printable strings that can head a column."""
    if not names and kind == "joint":
        raise BadArgumentError("joint_names is empty", remedy="name at least one joint")
    for name in names:
        if not isinstance(name, str) or not name.isprintable() or not name.strip() or name != name.strip():
            raise BadArgumentError(
                f"{kind} name {name!r} is not a printable, non-empty string without outer spaces",
                remedy="pass joint_names as a tuple such as ('hip', 'knee')"
                if kind == "joint"
                else f"name each {kind} as the URDF does",
            )
        if set(name) & set(',;"'):
            raise BadArgumentError(
                f'{kind} name {name!r} contains one of , ; "', remedy="rename it: names head CSV columns"
            )
        if names.count(name) > 1:
            raise BadArgumentError(
                f"{kind} name {name!r} occurs {names.count(name)} times", remedy=f"name each {kind} once"
            )


def refuse_shape(values: FloatArray | BoolArray, shape: tuple[int, ...], name: str) -> None:
    """Refuse an array that does not have the expected shape."""
    if values.shape == shape:
        return
    remedy = "give every array one row per time stamp and one column per joint name"
    if len(shape) == 2 and values.ndim == 1:
        remedy = f"for one joint pass {name}[:, np.newaxis]; arrays are (samples, joints)"
    elif len(shape) == 2 and values.shape == shape[::-1]:
        remedy = f"pass {name}.T; arrays are (samples, joints)"
    raise BadArgumentError(f"{name} has shape {values.shape}, expected {shape}", remedy=remedy)


def refuse_too_few(samples: int, where: SourceLocation = ARRAY) -> None:
    """Refuse a recording of fewer than `FEWEST_SAMPLES` samples."""
    if samples < FEWEST_SAMPLES:
        raise UnreadableInputError(
            f"too few samples: {samples}, at least {FEWEST_SAMPLES} are needed",
            **where.evidence(),
            remedy="record longer, or pass the whole log",
            command="record longer, or leave out --start and --stop",
        )


def refuse_time_disorder(time: FloatArray, where: SourceLocation = ARRAY) -> None:
    """Refuse time stamps that do not strictly increase, or cannot be seconds."""
    wrong = time[1:] <= time[:-1]
    if wrong.any():
        row = int(wrong.argmax()) + 1
        before, stamp = time[row - 1], time[row]
        kind = "is repeated" if stamp == before else "runs backwards"
        raise UnreadableInputError(
            f"time {kind}: {float(stamp)!r} s after {float(before)!r} s",
            **where.evidence(row),
            remedy="drop repeated rows; split a log of several runs and pass the parts separately",
        )
    interval = float(np.median(np.diff(time)))
    if interval >= SLOWEST:
        raise UnreadableInputError(
            f"the median interval of {interval:.4g} s (limit {SLOWEST:g} s) is that of milli-, micro- or nanoseconds",
            **where.evidence(column="time"),
            remedy='pass columns={"time": exoid.signals.Column(<header>, unit="ms")} (or "us", "ns"), or divide them; '
            "pass torques that hold a leg still as exoid.signals.Poses",
            command="give their unit: --column time=HEADER:ms, or us, or ns",
        )
    if interval < 1e-9:
        what = f"the median interval of {interval:.3g} s is too short for a log"
        raise UnreadableInputError(what, **where.evidence(column="time"), remedy="give time in seconds")


def refuse_velocity_in_other_unit(
    time: FloatArray, q: FloatArray, v: FloatArray, joints: tuple[str, ...], where: SourceLocation = ARRAY
) -> None:
    """Refuse velocities that are 180/π or π/180 times the rate of change of their angles."""
    # The check compares q with ∫v dt, because differences of a quantised angle are mostly noise. It skips
    # joints that do not move, and joints whose two signals are not correlated.
    for joint, angle, velocity in zip(joints, q.T, v.T, strict=True):
        travelled = scipy.integrate.cumulative_trapezoid(velocity, time)
        angle_size, travelled_size = float(np.std(angle[1:])), float(np.std(travelled))
        if min(angle_size, travelled_size) < 1e-3:  # rad; it may be noise
            continue
        correlation = float(np.corrcoef(angle[1:], travelled)[0, 1])
        ratio = travelled_size / angle_size
        if correlation < 0.9 or abs(abs(np.log(ratio)) - np.log(180.0 / np.pi)) > np.log(1.2):
            continue
        culprit, mend = ("v", "np.deg2rad(v)") if ratio > 1.0 else ("q", "np.deg2rad(q)")
        raise UnreadableInputError(
            f"v of joint {joint} is {ratio:.3g} times the rate of its q: {culprit} looks like degrees",
            **where.evidence(),
            remedy=f'give both in rad and rad/s ({mend}); angle_unit="deg" takes both as degrees',
            command="write both in rad and rad/s, or both in degrees and give --degrees",
            joints=(joint,),
        )
