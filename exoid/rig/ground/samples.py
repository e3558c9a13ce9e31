"""Samples of a simulated machine at the rate of its log."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.reduction.planar import GRAVITY
from exoid.signals import Wrench

from .audit import Audit
from .base_steps import BaseSteps
from .engine import Engine
from .holder import Holder
from .run import Footing, GroundRun


class Samples:
    """Samples of a run so far."""

    def __init__(self, engine: Engine, holder: Holder | None) -> None:
        self._engine, self._holder = engine, holder
        self._states: list[tuple[FloatArray, ...]] = []
        self._steps: list[tuple[FloatArray, ...]] = []
        self._times: list[float] = []
        self._places: list[int] = []
        self._base: list[tuple[FloatArray, ...]] = []
        self._begun: tuple[FloatArray, FloatArray]

    def begin(self) -> None:
        """Note the state that a step of the log begins with."""
        self._places.append(len(self._base))
        self._states.append((self._engine.q.copy(), self._engine.rate.copy()))

    def begin_step(self) -> None:
        """Note how the torso turns as any step begins."""
        engine = self._engine
        self._begun = engine.rate[: engine.base].copy(), engine.torso.rotation.copy()

    def finish_step(self) -> None:
        """Note the acceleration of the torso in that step."""
        rate, turn = self._begun
        self._base.append((rate, self._engine.acceleration[: self._engine.base].copy(), turn))

    def finish(self, time: float, torque: FloatArray) -> None:
        """Note acceleration and forces of the step."""
        engine = self._engine
        held = engine.rail_wrench if self._holder is None else self._holder.wrench
        self._times.append(time)
        self._steps.append((engine.acceleration.copy(), torque, held, *engine.placements(), *engine.loads()))

    def run(self, audit: Audit) -> GroundRun:
        """Return all samples."""
        engine, plant, b = self._engine, self._engine.plant, self._engine.base
        q, rate = (np.array(x) for x in zip(*self._states, strict=True))
        a, tau, held, position, rotation, twist, force, place = (np.array(x) for x in zip(*self._steps, strict=True))
        feet = {
            link: _footing(position[:, i], rotation[:, i], twist[:, i], force[:, own], place[:, own])
            for i, (link, own) in enumerate(engine.spheres.items(), start=1)
        }
        torso, turn = position[:, 0], rotation[:, 0]
        wrenches = {link: foot.wrench for link, foot in feet.items()}
        if engine.has_rail or self._holder is not None:
            point = (0.0, 0.0, 0.0) if self._holder is None else self._holder.spring.point
            pulled, moment = (np.einsum("nij,ni->nj", turn, held[:, part]) for part in (0, 1))
            wrenches[plant.root_link] = Wrench(pulled, moment, np.array(point))
        base = _base_kinematics(engine, rate[:, :b], a[:, :b], turn)
        motion = _base_kinematics(engine, *(np.array(x) for x in zip(*self._base, strict=True)))
        steps = BaseSteps(motion, np.array(self._places), float(engine.model.opt.timestep))
        time = np.array(self._times)
        return GroundRun(plant, time, q, rate[:, b:], a[:, b:], tau, base, torso, turn, wrenches, feet, audit, steps)


def _base_kinematics(engine: Engine, rate: FloatArray, change: FloatArray, turn: FloatArray) -> BaseKinematics:
    """Motion of the root link as an IMU at its origin measures it."""
    plane = engine.plant.plane
    if engine.plant.is_planar:
        linear = change[:, :2] @ np.array([plane.forward, plane.up])
        spin, turning = (np.outer(x[:, 2], -plane.lateral) for x in (rate, change))
    else:  # MuJoCo's free joint: linear in the laboratory, angular in the axes of the body
        linear, spin, turning = change[:, :3], rate[:, 3:], change[:, 3:]
    return BaseKinematics(spin, turning, np.einsum("nij,ni->nj", turn, linear + GRAVITY * plane.up))


def _footing(
    position: FloatArray, rotation: FloatArray, twist: FloatArray, forces: FloatArray, places: FloatArray
) -> Footing:
    """Sum up the forces on the points of a sole, (N, K, 3) at places (N, K, 3)."""
    force = forces.sum(axis=1)
    moment = np.cross(places - position[:, None], forces).sum(axis=1)
    points = np.count_nonzero(forces[..., 2] > 0.0, axis=1)
    foot = Footing(force, moment, position, rotation, points, np.zeros(len(force)))
    arm = foot.centre_of_pressure - position
    slip = np.nan_to_num(twist[:, 3:] + np.cross(twist[:, :3], arm))
    return Footing(force, moment, position, rotation, points, np.hypot(slip[:, 0], slip[:, 1]))
