"""What a law on the ground reads while the machine moves, faults of these readings, and the wearer's own torques."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.floating_base import planar_coordinates
from exoid.tools.numbers import checked

from .engine import Engine, Holder
from .motion import JointGains, JointTargets, per_joint
from .sensors import GroundSensors


class GroundReading(NamedTuple):
    """Readings at a sample of the controller.

    Attributes:
        time: Time [s].
        q: Joint angles [rad], (n,).
        v: Joint velocities [rad/s], (n,).
        pitch: Pitch of the torso against the vertical [rad].
        pitch_rate: Its rate [rad/s].
        switches: Switches at the points of each sole, such as heel and toe, by the link of the sole, (K,) each.
        push: Force on the torso of what holds it, which is measured, in the rows of the base, (3,).
        specific_force: Specific force at the origin of the root link [m/s²], (3,), the mean since the last sample.
        interaction: Torque of the wearer on the joints as cuffs measure it [N·m], (n,), that of the last step.
    """

    time: float
    q: FloatArray
    v: FloatArray
    pitch: float
    pitch_rate: float
    switches: Mapping[str, BoolArray]
    push: FloatArray
    specific_force: FloatArray
    interaction: FloatArray


GroundController = Callable[[GroundReading], FloatArray]
"""Controller of a machine on the ground: readings to torques [N·m], (n,)."""


@dataclass(frozen=True)
class Faults:
    """Faults of readings.

    Attributes:
        switch_delay: Time by which all switches are late [s].
        stuck: Switches that always read closed, or open, by the link of the sole.
        frozen: Time from which the reading of a joint, or of "pitch", does not change any more [s].

    Raises:
        ExoidError: The delay is negative.
    """

    switch_delay: float = 0.0
    stuck: Mapping[str, bool] = field(default_factory=dict)
    frozen: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the delay."""
        checked(self.switch_delay, "the delay of switches", least=0.0)


@dataclass(frozen=True)
class GroundWearer:
    """Torques of the wearer on the joints, beside those of the machine; the bodies are the machine's.

    τ = effort τ_planned + k_m (q_ref − q) + d_m (v_ref − v) − k (q − q_rest) − d v − spasm tanh(|v| / catch − 1)₊ sgn v

    Attributes:
        effort: Share of the planned torque that the muscles make: 1 healthy, 0.3 weak, 0 paralysed.
        tracking: Stiffness k_m of muscles that follow the reference [N·m/rad]; their damping is a tenth of it [s].
        stiffness: Stiffness k of passive tissue about the first pose [N·m/rad], like ``damping`` one for all joints.
        damping: Damping d of passive tissue [N·m·s/rad].
        spasm: Largest torque of a spastic muscle that is stretched fast [N·m].
        catch: Speed of a joint from which it is stretched fast [rad/s].

    Raises:
        ExoidError: A number is negative.
    """

    effort: float = 0.0
    tracking: float = 0.0
    stiffness: float = 2.0
    damping: float = 0.5
    spasm: float = 0.0
    catch: float = 1.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        numbers = (self.effort, self.tracking, self.stiffness, self.damping, self.spasm)
        checked(numbers, "numbers of a wearer", least=0.0)
        checked(self.catch, "the catch of a wearer", above=0.0)

    def torque(self, q: FloatArray, v: FloatArray, targets: JointTargets, step: int) -> FloatArray:
        """Compute the torque on the joints.

        Args:
            q: Joint angles [rad], (n,).
            v: Joint velocities [rad/s], (n,).
            targets: Reference at all steps.
            step: The step.

        Returns:
            Torque [N·m], (n,).
        """
        muscles = self.effort * targets.torque[step] + self.tracking * (
            targets.q[step] - q + 0.1 * (targets.v[step] - v)
        )
        fast = np.tanh((np.abs(v) - self.catch).clip(0.0) / self.catch) * np.sign(v)
        return np.asarray(muscles - self.stiffness * (q - targets.q[0]) - self.damping * v - self.spasm * fast)


HEALTHY = GroundWearer(effort=1.0, tracking=50.0)
"""Wearer who makes all of the planned torque, an assumption like the others."""

PASSIVE = GroundWearer()
"""Paralysed wearer with slack muscles."""

SPASTIC = GroundWearer(spasm=15.0, stiffness=5.0)
"""Paralysed wearer with spastic muscles."""


class Reader:
    """Readings of a run, with their memory."""

    def __init__(
        self,
        engine: Engine,
        holder: Holder | None,
        rate: float,
        sensors: GroundSensors | None,
        faults: Faults,
        seed: int,
    ) -> None:
        leg = engine.plant.leg
        if not engine.plant.is_planar:
            raise NotSupportedError("a controller of a machine in space", remedy="use a planar machine, or JointGains")
        unknown = (set(faults.stuck) - set(engine.plant.soles)) | (set(faults.frozen) - {"pitch", *leg.joint_names})
        if unknown:
            raise BadArgumentError(f"faults of {', '.join(sorted(unknown))}", remedy="name soles, joints or pitch")
        self._engine, self._holder, self._faults = engine, holder, faults
        self._noise, self._rng, self._period = sensors, np.random.default_rng(seed), 1.0 / rate
        self._step = float(engine.model.opt.timestep)
        self._last: tuple[FloatArray, FloatArray] | None = None
        self._switches: deque[dict[str, BoolArray]] = deque(maxlen=1 + round(faults.switch_delay * rate))
        self._force = np.zeros(sum(len(sole.points) for sole in engine.plant.soles.values()))
        self._muscles, self._speed = np.zeros(len(engine.q)), np.zeros(2)
        self._shaking = np.random.default_rng([seed, 1])  # of the accelerometer
        self._frozen: dict[str, tuple[float, float]] = {}
        self._base = planar_coordinates(leg.plane, leg.model.jointPlacements[1].translation)

    def command(self, controller: GroundController, start: float, step: int) -> FloatArray:
        """Ask a controller for the torque at a step; the run began at a time."""
        return controller(self.read(start + step * self._step))

    def read(self, time: float) -> GroundReading:
        """Read all sensors."""
        engine, lean = self._engine, self._engine.plant.ground_lean
        q, v, pitch, pitch_rate = engine.q.copy(), engine.v.copy(), engine.data.qpos[2] + lean, engine.rate[2]
        if self._noise is not None:
            q = q + self._noise.angle_noise * self._rng.standard_normal(len(q))
            pitch += self._noise.turn_noise * self._rng.standard_normal()
            pitch_rate += self._noise.gyro_noise * self._rng.standard_normal()
        for name, since in self._faults.frozen.items():
            if time < since:
                continue
            if name == "pitch":
                pitch, pitch_rate = self._frozen.setdefault(name, (float(pitch), float(pitch_rate)))
            else:
                joint = engine.plant.leg.joint_names.index(name)
                q[joint], v[joint] = self._frozen.setdefault(name, (float(q[joint]), 0.0))
        if self._noise is not None:
            old_q, old_v = self._last or (q, v)
            blend = 1.0 - np.exp(-2.0 * np.pi * 30.0 * self._period)  # a low-pass of 30 Hz, an assumption
            v = old_v + blend * ((q - old_q) / self._period - old_v) if self._last else v
            self._last = q.copy(), v.copy()
        pose = q, v, float(pitch), float(pitch_rate)
        return GroundReading(time, *pose, self._read_switches(), self._push(), self._accelerometer(), self._muscles)

    def feel(self, muscles: FloatArray) -> None:
        """Note the forces at the end of a step, those of the ground and of the wearer; MuJoCo has them only then."""
        self._force, self._muscles = self._engine.loads(), muscles

    def _accelerometer(self) -> FloatArray:
        """Specific force at the origin of the root link, in its axes."""
        plant, speed = self._engine.plant, self._engine.rate[:2].copy()
        acceleration = (speed - self._speed) / self._period @ np.array([plant.plane.forward, plant.plane.up])
        self._speed = speed
        noise = 0.0 if self._noise is None else self._noise.acceleration_noise * self._shaking.standard_normal(3)
        return np.asarray(self._engine.torso.rotation.T @ (acceleration - plant.gravity) + noise)

    def _read_switches(self) -> dict[str, BoolArray]:
        """Switches under the points of the soles, late, or stuck."""
        limit = 20.0 if self._noise is None else self._noise.switch_force
        self._switches.append({link: self._force[own] > 0.5 * limit for link, own in self._engine.spheres.items()})
        late, stuck = self._switches[0], self._faults.stuck
        return {link: np.full(len(x), stuck[link]) if link in stuck else x for link, x in late.items()}

    def _push(self) -> FloatArray:
        """Measured force of what holds the torso, in the rows of the base."""
        if self._holder is None:
            return np.zeros(3)
        rotation, (force, moment) = self._engine.torso.rotation, self._holder.wrench
        place = np.array(self._holder.spring.point)
        force, moment = rotation.T @ force, rotation.T @ moment
        return np.asarray(self._base.T @ np.concatenate([force, moment + np.cross(place, force)]))


def gains_about(gains: JointGains, targets: JointTargets, engine: Engine) -> Callable[[int], FloatArray]:
    """Make the function from a step to the torque of gains about the reference, which reads exact angles."""
    k, d = (per_joint(getattr(gains, name), len(engine.q), name) for name in ("stiffness", "damping"))
    return lambda step: targets.torque[step] + k * (targets.q[step] - engine.q) + d * (targets.v[step] - engine.v)
