"""Run of a machine on the ground: true motion, torques and wrenches, and its log."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from exoid._typing import BoolArray, FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.base_kinematics import BaseKinematics
from exoid.rig.sensors import noisy
from exoid.signals import Recording, Wrench

from .motion import per_joint
from .plant import GroundPlant
from .sensors import GroundSensors, Steps, read_imu, read_pose, read_switch


@dataclass(frozen=True, eq=False, repr=False)
class Footing:
    """True load and place of one foot at N samples, in the laboratory."""

    force: FloatArray  # force of the ground on the foot [N], (N, 3)
    moment: FloatArray  # its moment about the origin of the foot's link [N·m], (N, 3)
    position: FloatArray  # origin of the link [m], (N, 3)
    rotation: FloatArray  # axes of the link as columns, (N, 3, 3)
    points: NDArray[np.intp]  # number of points of the sole that bear load, (N,)
    slip: FloatArray  # speed of the centre of pressure along the ground [m/s], (N,); zero without load

    @property
    def wrench(self) -> Wrench:
        """Wrench in the axes of the link, about its origin."""
        return Wrench(*(np.einsum("nij,ni->nj", self.rotation, x) for x in (self.force, self.moment)))

    @property
    def touching(self) -> BoolArray:
        """Whether any point of the sole bears load, (N,)."""
        return np.asarray(self.points > 0)

    @property
    def centre_of_pressure(self) -> FloatArray:
        """Point of the ground about which the moment of the force is vertical [m], (N, 3); NaN without load."""
        with np.errstate(divide="ignore", invalid="ignore"):
            vertical = np.where(self.force[:, 2] > 0.0, self.force[:, 2], np.nan)
            height = self.position[:, 2]
            x = (-self.moment[:, 1] - height * self.force[:, 0]) / vertical
            y = (self.moment[:, 0] - height * self.force[:, 1]) / vertical
        return np.column_stack([self.position[:, 0] + x, self.position[:, 1] + y, np.where(np.isnan(x), np.nan, 0.0)])


def about_link(wrench: FloatArray, position: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Force, and moment about a place, of wrenches about the laboratory's origin, (N, 6)."""
    force, moment = np.hsplit(wrench, 2)
    return force, moment - np.cross(position, force)


@dataclass(frozen=True, eq=False, repr=False)
class GroundRun:
    """Truth about a machine on the ground at N samples; its log is :meth:`recording`.

    Attributes:
        plant: The machine with its true parameters.
        time: Time [s], (N,).
        q: Joint angles [rad], (N, n).
        v: Joint velocities [rad/s], (N, n).
        a: Joint accelerations [rad/s²], (N, n).
        tau: Torques of the actuators, before friction and springs of the joints [N·m], (N, n).
        base: Motion of the root link as an IMU at its origin measures it.
        position: Origin of the root link in the laboratory [m], (N, 3).
        rotation: Axes of the root link as columns, (N, 3, 3).
        wrenches: Wrench on each foot, and on the root link where a spring holds it, in the axes of the link.
        feet: Load and place of each foot.
        steps: What sensors read at every step of the simulation.
        interaction: Torques of the wearer on the joints [N·m], (N, n); zero without one.
    """

    plant: GroundPlant
    time: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    tau: FloatArray
    base: BaseKinematics
    position: FloatArray
    rotation: FloatArray
    wrenches: Mapping[str, Wrench]
    feet: Mapping[str, Footing]
    steps: Steps
    interaction: FloatArray

    def fixed(self, link: str) -> BoolArray:
        """Find the samples at which a foot is flat on the ground and does not slip.

        Args:
            link: Link of the foot.

        Returns:
            Whether all points of its sole bear load at less than 5 mm/s, (N,).
        """
        foot = self.feet[link]
        return np.asarray((foot.points == len(self.plant.soles[link].points)) & (foot.slip < 0.005))

    def recording(
        self,
        sensors: GroundSensors | None = None,
        seed: int | np.random.Generator = 0,
        *,
        wrenches: Collection[str] | None = None,
    ) -> Recording:
        """Return the readings of the sensors.

        ``contacts`` are those of foot switches: closed while the foot bears load, also on its heel or its toe alone, so
        that an open one means no force. A torso that a spring holds is in ``contacts`` if its wrench is not
        logged: it is unknown at all samples.

        Args:
            sensors: Sensors; None for the default ones.
            seed: Seed or generator of noise, bias and mistakes.
            wrenches: Links whose wrench is logged; None for all, () for none.

        Returns:
            Log with angles, torques, IMU, wrenches and contacts.

        Raises:
            ExoidError: Nothing acts on one of the links, or the sensors do not fit the joints.
        """
        sensors, rng = sensors or GroundSensors(), np.random.default_rng(seed)
        logged = tuple(self.wrenches) if wrenches is None else tuple(wrenches)
        for link in logged:
            if link not in self.wrenches:
                known = ", ".join(self.wrenches)
                raise BadArgumentError(f"no wrench on {link!r} in the run", remedy=f"wrenches act on {known}")
        torque_noise = per_joint(sensors.torque_noise, self.tau.shape[1], "torque_noise")
        q = noisy(self.q, sensors.angle_noise, rng)
        tau = noisy(self.steps.read(self.steps.torque, sensors.window), torque_noise, rng)
        world = sensors.wrench_axes == "world"
        pose = read_pose(sensors, self.position, self.rotation, rng) if world else None
        rate = 1.0 / float(self.time[1] - self.time[0])
        contacts = {link: read_switch(sensors, foot.force[:, 2], rate, rng) for link, foot in self.feet.items()}
        for link in self.wrenches:
            if link not in logged and link not in contacts:
                contacts[link] = np.ones(len(self.time), dtype=np.bool_)
        base = self.steps.base_motion(sensors.window) if sensors.window else self.base
        imu, measured = read_imu(sensors, base, rng, pose), {}
        read, root = dict(self.wrenches), self.plant.root_link
        for link, foot in self.feet.items():
            force, moment = about_link(self.steps.read(self.steps.ground[link], sensors.window), foot.position)
            read[link] = replace(foot, force=force, moment=moment).wrench
        if root in read and (root not in self.feet or self.steps.hold.any()):  # of a held seat, what holds it counts
            force, moment = np.hsplit(self.steps.read(self.steps.hold, sensors.window), 2)
            read[root] = Wrench(force, moment, self.wrenches[root].point)
        behind = replace(self, wrenches=read)
        for link in logged:
            true = behind.wrench(link, world=world)
            force, moment = noisy(true.force, sensors.force_noise, rng), noisy(true.moment, sensors.moment_noise, rng)
            measured[link] = Wrench(force, moment, true.point, true.axes)
        return Recording(
            self.time,
            q,
            tau=tau,
            joint_names=self.plant.leg.joint_names,
            base=imu,
            wrenches=measured,
            contacts=contacts,
            largest_angle=np.inf,
        )

    def wrench(self, link: str, *, world: bool = False) -> Wrench:
        """Return the true wrench on a link.

        Args:
            link: The link.
            world: Whether force and moment are in the laboratory, about its origin, as of a force plate; otherwise they
                are in the axes of the link.

        Returns:
            The wrench.
        """
        own = self.wrenches[link]
        if not world:
            return own
        foot = self.feet.get(link)
        position, rotation = (self.position, self.rotation) if foot is None else (foot.position, foot.rotation)
        force, moment = (np.einsum("nij,nj->ni", rotation, x) for x in (own.force, own.moment))
        return Wrench(force, moment + np.cross(position + rotation @ own.point, force), axes="world")

    def __repr__(self) -> str:
        """Name the machine and the size of the log."""
        rate = 1.0 / (self.time[1] - self.time[0])
        return (
            f"GroundRun({self.plant.leg.description.name}: {len(self.time)} samples at {rate:.4g} Hz, "
            f"{self.time[-1]:.4g} s; on {', '.join(self.plant.soles)})"
        )
