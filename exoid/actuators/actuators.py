"""Actuators: the drives of a leg's joints, which turn recordings of currents and forces into recordings of torque."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError, UnreadableInputError, within
from exoid.leg.leg import Leg
from exoid.signals import Poses, Recording, Recordings
from exoid.signals.differentiation import difference, smooth_motion
from exoid.signals.external import ReadOnlyDict
from exoid.signals.quantities import PREFIXES
from exoid.signals.torque_delay import DRIVE_CHANNELS
from exoid.tools.numbers import checked

from .coupling import Coupling
from .drive import Drive, joints_of
from .motor import Motor


@dataclass(frozen=True, eq=False, repr=False)
class Actuators:
    """Drives of a leg's joints, in the order of the joints.

    Make them with :meth:`of`. Joints without a drive keep the torque that was measured. A measured torque is never
    replaced: a drive gives the torque of joints that have none.

    Attributes:
        joint_names: Joints of the leg, (n,).
        joint_labels: Joint names as they occur in parameter names, (n,).
        drives: Drive of each joint that has one of its own, by the joint's name.
        couplings: Couplings of several joints, by the names that they were given.

    Example:
        >>> from exoid.actuators import Motor
        >>> leg = exoid.load_leg("cuhk")
        >>> actuators = Actuators.of(leg, {"hip": Motor(0.07, ratio=50.0), "knee": Motor(0.05, ratio=50.0)})
        >>> actuators.command([[35.0, -5.0]], [[0.0, 0.0]], [[0.0, 0.0]])
        array([[10., -2.]])
    """

    joint_names: tuple[str, ...]
    joint_labels: tuple[str, ...]
    drives: Mapping[str, Drive]
    couplings: Mapping[str, Coupling] = field(default_factory=dict)

    @classmethod
    def of(cls, leg: Leg, drives: Mapping[str, Drive | Coupling] | Actuators) -> Actuators:
        """Mount drives on a leg; drives of joints of its robot that it does not move are left out.

        Args:
            leg: The leg.
            drives: Drive of each joint, by its name (or label: "hip" for "left_hip"), and couplings by any name; or
                actuators of the same joints.

        Returns:
            The actuators.

        Raises:
            ExoidError: A joint is not the leg's or occurs twice, or a drive does not fit its joint.
        """
        if isinstance(drives, Actuators):
            if drives.joint_names != leg.joint_names:
                what = f"actuators of {', '.join(drives.joint_names)} for a leg of {', '.join(leg.joint_names)}"
                raise BadArgumentError(what, remedy="describe the drives of this leg")
            return drives
        mounted: dict[str, Drive] = {}
        couplings: dict[str, Coupling] = {}
        every: list[str] = []
        for given, drive in _of_leg(drives, leg).items():
            if isinstance(drive, Coupling):
                couplings[given] = drive.on(leg)
                every += couplings[given].joints
                continue
            (joint,) = joints_of(leg, [given], "a drive")
            with within(joint):
                mounted[joint] = drive.on(leg, joint)
            every.append(joint)
        twice = [joint for joint in leg.joint_names if every.count(joint) > 1]
        if twice:
            raise BadArgumentError(f"two drives of {', '.join(twice)}", remedy="describe each joint once")
        ordered = {joint: mounted[joint] for joint in leg.joint_names if joint in mounted}
        return cls(leg.joint_names, leg.joint_labels, ReadOnlyDict(ordered), ReadOnlyDict(couplings))

    def __repr__(self) -> str:
        """Write one line."""
        parts = [f"{name}: {drive!r}" for name, drive in (*self.drives.items(), *self.couplings.items())]
        return f"Actuators({', '.join(parts)})"

    @property
    def units(self) -> tuple[str, ...]:
        """Unit of each joint's command, (n,); N·m for a joint without a drive."""
        units = {joint: drive.unit for joint, drive in self.drives.items()}
        units |= {joint: coupling.unit for coupling in self.couplings.values() for joint in coupling.joints}
        return tuple(units.get(name, "N·m") for name in self.joint_names)

    def torque(self, recording: Recording) -> Recording:
        """Compute the torque of the joints whose drives were measured.

        A torque that was measured, or is known to be zero at a passive joint, stays as it is. A joint whose drive was
        not recorded stays without torque, and gives no rows.

        Args:
            recording: Recording with currents, forces, motor torques or motor angles of some joints.

        Returns:
            The recording with these torques; the same one if there is nothing to compute.

        Raises:
            ExoidError: Nothing was recorded of any drive and there is no torque either, another quantity was recorded
                than a drive needs, or readings cannot be those of the drive.
        """
        columns = self._columns(recording)
        wanted = [one for one in self._parts() if one.is_wanted(recording, columns)]
        if not wanted:
            return recording
        found = [one for one in wanted if one.readings(recording, columns) is not None]
        if not found:
            if recording.tau is None:
                raise _nothing_recorded(recording, wanted, columns)
            return recording
        recording, joints = recording.resampled(), list(recording.computed)
        velocity = self._velocity(recording, found)
        tau = np.full((len(recording), recording.n_joints), np.nan) if recording.tau is None else recording.tau.copy()
        for one in found:
            places, reading = [columns[joint] for joint in one.joints], one.readings(recording, columns)
            assert reading is not None
            with within(recording.file_name), within(one.name):
                torque = one.torque(reading, recording.q[:, places], velocity[:, places], recording.sample_rate)
            new = ~recording.measured[places]  # of a coupling, some joints may have a sensor
            tau[:, np.array(places)[new]] = torque[:, new]
            joints += [recording.joint_names[place] for place in np.array(places)[new]]
        return replace(recording, tau=tau, computed=tuple(dict.fromkeys(joints)))

    def torques(self, data: Sequence[Recording | Poses]) -> Sequence[Recording | Poses]:
        """Compute the torques of many recordings; those on disk stay there.

        Args:
            data: Recordings, and poses, which have torques already.

        Returns:
            The same recordings with torques.

        Raises:
            ExoidError: See :meth:`torque`.
        """
        if isinstance(data, Recordings):
            return data.changed(self.torque)
        return [self.torque(item) if isinstance(item, Recording) else item for item in data]

    def command(self, torque: ArrayLike, q: ArrayLike, v: ArrayLike) -> FloatArray:
        """Compute the commands of all drives that make torques at the joints.

        Args:
            torque: Requested torques [N·m], (N, n).
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).

        Returns:
            Commands in :attr:`units`, (N, n): amperes, newtons or motor angles; the torque itself at joints without a
            drive.

        Raises:
            ExoidError: Shapes do not fit, or a drive cannot make a torque.
        """
        return self._each(_Part.command, torque, q, v)

    def torque_of(self, command: ArrayLike, q: ArrayLike, v: ArrayLike) -> FloatArray:
        """Compute the torques at the joints of readings or commands of all drives, the inverse of :meth:`command`.

        Args:
            command: Readings or commands in :attr:`units`, (N, n).
            q: Joint angles [rad], (N, n).
            v: Joint velocities [rad/s], (N, n).

        Returns:
            Torques [N·m], (N, n).

        Raises:
            ExoidError: Shapes do not fit, or readings cannot be those of a drive.
        """
        return self._each(_Part.torque, command, q, v)

    def readings(self, recording: Recording) -> Recording:
        """Compute what the drives would have measured, in place of the torques: the inverse of :meth:`torque`.

        Args:
            recording: Recording with the torques of all driven joints, such as one of the virtual rig.

        Returns:
            The recording with currents, forces, motor torques or motor angles, and without the torques of these joints.

        Raises:
            ExoidError: A torque is missing, or a drive cannot make it.
        """
        columns = self._columns(recording)
        recording = recording.resampled()
        parts = self._parts()
        without = [joint for one in parts for joint in one.joints if joint not in columns]
        without = without or [joint for one in parts for joint in one.joints if not recording.measured[columns[joint]]]
        if without or recording.tau is None:
            raise BadArgumentError(
                f"no torque of {', '.join(without)} in the recording",
                where=recording.file_name,
                remedy="give a recording with the torques of all joints that have a drive",
            )
        velocity, tau = self._velocity(recording, parts), recording.tau.copy()
        channels: dict[str, Any] = {}
        for one in parts:
            channel, places = one.drive.channel, [columns[joint] for joint in one.joints]
            before = getattr(recording, channel)
            readings = channels.setdefault(channel, np.full(tau.shape, np.nan) if before is None else before.copy())
            with within(one.name):
                readings[:, places] = one.command(tau[:, places], recording.q[:, places], velocity[:, places])
            tau[:, places] = np.nan
        return replace(recording, tau=tau, computed=(), **channels)

    def _parts(self) -> list[_Part]:
        """Drives of one joint, and couplings, alike."""
        singles = [_Part(joint, (joint,), drive) for joint, drive in self.drives.items()]
        return [*singles, *(_Part(name, coupling.joints, coupling) for name, coupling in self.couplings.items())]

    def _each(
        self, work: Callable[[_Part, FloatArray, FloatArray, FloatArray], FloatArray], *given: ArrayLike
    ) -> FloatArray:
        """Let each drive turn its columns of the first array into others."""
        arrays = [np.atleast_2d(checked(x, "a torque, command or motion of drives", ndim=2)) for x in given]
        if any(x.shape != arrays[0].shape or x.shape[-1] != len(self.joint_names) for x in arrays):
            shapes = ", ".join(str(x.shape) for x in arrays)
            raise BadArgumentError(f"arrays of shapes {shapes}", remedy=f"pass (N, {len(self.joint_names)}) each")
        out = arrays[0].copy()
        for one in self._parts():
            places = [self.joint_names.index(joint) for joint in one.joints]
            with within(one.name):
                out[:, places] = work(one, *(x[:, places] for x in arrays))
        return out

    def _columns(self, recording: Recording) -> dict[str, int]:
        """Column of each joint of the leg in a recording, which may name joints with or without their side."""
        places = {name: k for k, name in enumerate(recording.joint_names)}
        by_name = set(self.joint_names) <= set(places)
        used = self.joint_names if by_name else self.joint_labels
        return {joint: places[n] for joint, n in zip(self.joint_names, used, strict=True) if n in places}

    def _velocity(self, recording: Recording, parts: Sequence[_Part]) -> FloatArray:
        """Velocity of the joints [rad/s], (N, n); zero if no drive needs it."""
        if recording.v is not None or not any(one.drive.needs_velocity for one in parts):
            return np.zeros_like(recording.q) if recording.v is None else recording.v
        return difference(_smooth(recording.q, recording.sample_rate), recording.sample_rate, 1, 4)


class _Part(NamedTuple):
    """Drive of one joint, or coupling of several: both take (N, k) here."""

    name: str  # of the joint or coupling
    joints: tuple[str, ...]
    drive: Drive | Coupling

    def is_wanted(self, recording: Recording, columns: Mapping[str, int]) -> bool:
        """Whether the recording has its joints, and lacks the torque of one of them."""
        places = [columns[joint] for joint in self.joints if joint in columns]
        return len(places) == len(self.joints) and not recording.measured[places].all()

    def readings(self, recording: Recording, columns: Mapping[str, int]) -> FloatArray | None:
        """Readings of all its joints, (N, k); None if some were not recorded."""
        values = getattr(recording, self.drive.channel)
        if values is None:
            return None
        own = values[:, [columns[joint] for joint in self.joints]]
        return None if np.isnan(own).all(axis=0).any() else own

    def torque(self, reading: FloatArray, q: FloatArray, v: FloatArray, rate: float | None = None) -> FloatArray:
        """Torques of its joints [N·m], (N, k), from readings at a sampling rate [Hz]; None without noise."""
        if isinstance(self.drive, Coupling):
            return self.drive.torque(reading)
        if isinstance(self.drive, Motor) and self.drive.needs_velocity and rate is not None:
            # Noise around zero would change the direction of power from sample to sample, and pass for a lower
            # efficiency. The sign of the current is therefore that of its low-passed current.
            return self.drive.torque(reading[:, 0], q[:, 0], v[:, 0], _smooth(reading, rate)[:, 0])[:, None]
        return self.drive.torque(reading[:, 0], q[:, 0], v[:, 0])[:, None]

    def command(self, torque: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
        """Commands that make torques, (N, k)."""
        if isinstance(self.drive, Coupling):
            return self.drive.command(torque)
        return self.drive.command(torque[:, 0], q[:, 0], v[:, 0])[:, None]


def _smooth(signal: FloatArray, rate: float) -> FloatArray:
    """Low-pass what tells the direction of power: at 8 Hz, the fastest that a leg moves, or a fifth of the rate."""
    return smooth_motion(signal, rate, min(8.0, 0.2 * rate))


def _nothing_recorded(recording: Recording, parts: Sequence[_Part], columns: Mapping[str, int]) -> UnreadableInputError:
    """Make the error about a recording that has neither torque nor what the drives need."""
    needed = [f"{PREFIXES[p.drive.channel]}_{recording.joint_names[columns[j]]}" for p in parts for j in p.joints]
    units = dict.fromkeys(f"{PREFIXES[one.drive.channel]}_ in {one.drive.unit}" for one in parts)
    others = [quantity for quantity in DRIVE_CHANNELS if getattr(recording, quantity) is not None]
    has = f", but {' and '.join(others)}" if others else ""
    advice = f"record {', '.join(needed)} ({', '.join(units)}), or map"
    return UnreadableInputError(
        f"the recording has no torque, and not what its drives turn into torque{has}",
        where=recording.file_name,
        remedy=f"{advice} columns of the log to them",
        command=f"{advice} them, e.g. --column {needed[0]}=HEADER",
    )


def _of_leg(drives: object, leg: Leg) -> dict[str, Drive | Coupling]:
    """Check the names of drives, and leave out those of joints that the URDF has and the leg does not move."""
    remedy = 'give a drive for the name of each joint: {"left_hip": exoid.actuators.Motor(...)}'
    if not isinstance(drives, Mapping) or not drives:
        raise BadArgumentError(f"actuators are {drives!r}", remedy=remedy)
    others = {*leg.description.child_links} - {*leg.joint_names, *leg.joint_labels}
    found = {}
    for name, drive in drives.items():
        if not isinstance(name, str) or not isinstance(drive, Drive | Coupling):
            raise BadArgumentError(f"actuators have {drive!r} at {name!r}", remedy=remedy)
        if not set(drive.joints if isinstance(drive, Coupling) else (name,)) <= others:
            found[name] = drive
    if not found:
        what = f"drives of {', '.join(drives)}, and none of {', '.join(leg.joint_names)}"
        raise BadArgumentError(what, remedy="describe the drives of the joints of the leg")
    return found
