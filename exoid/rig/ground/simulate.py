"""Simulation of a machine on the ground: MuJoCo in small steps, a controller, true motion and wrenches."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.base_kinematics import BaseKinematics
from exoid.rig.simulate import DIVERGED_SPEED, Rates
from exoid.signals import Wrench

from .control import Faults, GroundController, GroundWearer, Reader, gains_about
from .engine import Engine, Holder
from .motion import GroundMotion, JointGains, Spring
from .plant import GroundPlant
from .run import Footing, GroundRun, about_link
from .sensors import GroundSensors, Steps

RATES = Rates(control=2000.0, log=500.0, step=5e-4)
"""Default rates: the controller acts at every step, so that torque and motion of a sample are of one time."""


def simulate_on_ground(
    plant: GroundPlant,
    motion: GroundMotion,
    gains: JointGains | GroundController,
    *,
    spring: Spring | None = None,
    rates: Rates = RATES,
    wearer: GroundWearer | None = None,
    sensors: GroundSensors | None = None,
    faults: Faults | None = None,
    seed: int = 0,
) -> GroundRun:
    """Let a machine follow a motion on the ground, or on what stands there.

    MuJoCo computes bodies and contact, by a leapfrog. The acceleration a of a sample obeys the equation of motion with
    the q, v, torque and wrenches of that sample, and is the second difference of q. The controller reads exact angles.
    The same input gives the same bytes.

    Args:
        plant: The machine.
        motion: Reference that begins before time zero, or at it. Its first pose, at rest, is the start; its last time
            ends the run.
        gains: Gains of the joints; or a controller, such as :class:`exoid.control.ground.GroundLoop` makes of a law.
        spring: Spring and damper that hold the torso, whose carriage moves as ``motion.base``; None for none.
        rates: Rates of controller and log, and step of the simulation.
        wearer: Torques of a wearer on the joints; None for none.
        sensors: Noise of what a controller reads; None for exact readings. Gains act on exact angles.
        faults: Faults of what a controller reads; None for none.
        seed: Seed of the noise of the readings.

    Returns:
        True motion, torque and wrenches at the rate of the log.

    Raises:
        ExoidError: MuJoCo is not installed, rates do not fit, the motion is too short, or the machine diverges.
    """
    every_control, every_log = rates.steps()
    first, last = (round(float(t) / rates.step) for t in motion.time[[0, -1]])
    if first > 0 or last < 1:
        what = f"the reference is from {motion.time[0]:g} to {motion.time[-1]:g} s"
        raise BadArgumentError(what, remedy="begin at zero or before, and end after zero")
    targets = motion.at(rates.step * np.arange(first, last + 1, dtype=np.float64))
    engine = Engine(plant, rates.step)
    engine.place(targets.q[0], targets.base[0])
    holder = None if spring is None else Holder(engine, spring, targets)
    limit = plant.leg.limits.effort
    reader: Reader | None = None
    if isinstance(gains, JointGains):
        command = gains_about(gains, targets, engine)
    else:
        reader = Reader(engine, holder, rates.control, sensors, faults or Faults(), seed)
        command = partial(reader.command, gains, first * rates.step)
    muscles = np.zeros(len(engine.q))
    torque, books = np.zeros(len(engine.q)), _Books(engine, holder)
    for k in range(last - first + 1):
        now = k + first
        engine.begin()
        q, v = engine.q, engine.v
        if k % every_control == 0:
            torque = np.clip(command(k), -limit, limit)
        if wearer is not None:
            muscles = wearer.torque(q, v, targets, k)
        applied = engine.applied
        applied[engine.base :] = torque + muscles - plant.resistance(q, v)
        applied[: engine.base] = 0.0
        held = None if holder is None else holder.force(k)
        if held is not None:
            applied += held
        if now < 0:
            engine.finish()
        else:
            books.finish(torque, muscles, logs=now % every_log == 0)
        if reader is not None and (k + 1) % every_control == 0:
            reader.feel(muscles)
        if not engine.rate @ engine.rate < DIVERGED_SPEED**2:
            what = f"the machine diverged before {now * rates.step:.3g} s"
            raise BadArgumentError(what, remedy="lower the gains, slow the motion, or shorten the step")
    return books.run(rates.step)


class _Books:
    """States and forces of a run: what sensors with a low-pass read at every step, all else of the log's samples."""

    def __init__(self, engine: Engine, holder: Holder | None) -> None:
        self._engine, self._holder = engine, holder
        self._steps: list[tuple[FloatArray, ...]] = []
        self._samples: list[tuple[FloatArray, ...]] = []
        self._logged: list[int] = []

    def finish(self, torque: FloatArray, muscles: FloatArray, *, logs: bool) -> None:
        """Finish a step: note the state that it begins with, then its acceleration and forces."""
        engine, b = self._engine, self._engine.base
        rate, turn, q = engine.rate.copy(), engine.torso.rotation.copy(), engine.q.copy()
        between = engine.between[:b].copy()
        hold = np.zeros(6) if self._holder is None else (self._holder.wrench @ turn).ravel()
        engine.finish()
        if logs:
            self._logged.append(len(self._steps))
            moved = q, rate, engine.acceleration.copy(), muscles
            self._samples.append((*moved, *engine.placements(), engine.loads()))
        self._steps.append((between, engine.acceleration[:b].copy(), turn, torque, hold, *engine.ground()))

    def run(self, dt: float) -> GroundRun:
        """Return samples, and motion of the root link at every step."""
        engine, plant, b = self._engine, self._engine.plant, self._engine.base
        between, change, turn, torque, hold, ground, about = (np.array(x) for x in zip(*self._steps, strict=True))
        kept = np.array(self._logged)
        q, rate, acceleration, muscles, position, rotation, twist, loads = (
            np.array(x) for x in zip(*self._samples, strict=True)
        )
        moment, force = np.split(ground.transpose(1, 0, 2), 2, axis=2)
        wrench = np.concatenate([force, moment + np.cross(about, force)], axis=2)
        of_feet = dict(zip(engine.spheres, wrench, strict=True))
        feet = {
            link: _footing(position[:, i], rotation[:, i], twist[:, i], of_feet[link][kept], loads[:, own])
            for i, (link, own) in enumerate(engine.spheres.items(), start=1)
        }
        wrenches = {link: foot.wrench for link, foot in feet.items()}
        if self._holder is not None:
            point = np.array(self._holder.spring.point)
            wrenches[plant.root_link] = Wrench(hold[kept, :3], hold[kept, 3:], point)
        return GroundRun(
            plant,
            kept * dt,
            q,
            rate[:, b:],
            acceleration[:, b:],
            torque[kept],
            _base_kinematics(plant, rate[:, :b], change[kept], turn[kept]),
            position[:, 0],
            rotation[:, 0],
            wrenches,
            feet,
            Steps(_base_kinematics(plant, between, change, turn), torque, hold, of_feet, kept, dt),
            muscles,
        )


def _base_kinematics(plant: GroundPlant, rate: FloatArray, change: FloatArray, turn: FloatArray) -> BaseKinematics:
    """Motion of the root link as an IMU at its origin measures it."""
    plane = plant.plane
    if plant.is_planar:
        linear = change[:, :2] @ np.array([plane.forward, plane.up])
        spin, turning = (np.outer(x[:, 2], -plane.lateral) for x in (rate, change))
    else:  # MuJoCo's free joint: linear in the laboratory, angular in the axes of the body
        linear, spin, turning = change[:, :3], rate[:, 3:], change[:, 3:]
    return BaseKinematics(spin, turning, np.einsum("nij,ni->nj", turn, linear - plant.gravity))


def _footing(
    position: FloatArray, rotation: FloatArray, twist: FloatArray, wrench: FloatArray, loads: FloatArray
) -> Footing:
    """Describe a foot by its wrench about the laboratory's origin, (N, 6), and what its points bear, (N, K)."""
    force, moment = about_link(wrench, position)
    points = np.count_nonzero(loads > 0.0, axis=1)
    foot = Footing(force, moment, position, rotation, points, np.zeros(len(force)))
    arm = foot.centre_of_pressure - position
    slip = np.nan_to_num(twist[:, 3:] + np.cross(twist[:, :3], arm))
    return replace(foot, slip=np.hypot(slip[:, 0], slip[:, 1]))
