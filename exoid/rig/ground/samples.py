"""Samples of a simulated machine at the rate of its log."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.base_kinematics import BaseKinematics
from exoid.signals import Wrench

from .audit import Audit
from .engine import Engine, Load, Pose
from .holder import Holder
from .run import Footing, GroundRun


class Samples:
    """Samples of a run so far.

    Args:
        engine: The machine.
        holder: Spring that holds its torso; None without.
    """

    def __init__(self, engine: Engine, holder: Holder | None) -> None:
        self._engine, self._holder = engine, holder
        self._rows: list[tuple[FloatArray | float, ...]] = []
        self._base: list[tuple[FloatArray, ...]] = []
        self._torso: list[Pose] = []
        self._feet: dict[str, list[tuple[FloatArray | int, ...]]] = {link: [] for link in engine.plant.soles}
        self._held: list[FloatArray] = []
        self._before: tuple[FloatArray, FloatArray] = (engine.q, engine.rate)

    def begin(self) -> None:
        """Note the state that the step begins with."""
        self._before = self._engine.q.copy(), self._engine.rate.copy()

    def finish(self, time: float, torque: FloatArray) -> None:
        """Note acceleration and forces of the step.

        Args:
            time: Time [s].
            torque: Torque of the actuators [N·m], (n,).
        """
        engine, (q, rate), base = self._engine, self._before, self._engine.base
        acceleration = engine.data.qacc.copy()
        self._rows.append((time, q, rate[base:], acceleration[base:], torque))
        self._base.append(engine.base_motion(rate, acceleration))
        self._torso.append(engine.pose())
        for link, load in engine.loads().items():
            self._feet[link].append(_footing(load, engine.pose(link), engine.twist(link)))
        self._held.append(engine.rail_wrench if self._holder is None else self._holder.wrench)

    def run(self, audit: Audit) -> GroundRun:
        """Return all samples.

        Args:
            audit: Balance of energy and momentum.

        Returns:
            The run.
        """
        time, q, v, a, tau = (np.array(x, dtype=np.float64) for x in zip(*self._rows, strict=True))
        base = BaseKinematics(*(np.array(x) for x in zip(*self._base, strict=True)))
        torso = Pose(*(np.array(x) for x in zip(*self._torso, strict=True)))
        feet = {link: Footing(*(np.array(x) for x in zip(*rows, strict=True))) for link, rows in self._feet.items()}
        wrenches = {link: foot.wrench for link, foot in feet.items()}
        engine, held = self._engine, np.array(self._held)
        if engine.has_rail or self._holder is not None:
            point = (0.0, 0.0, 0.0) if self._holder is None else self._holder.spring.point
            force, moment = (np.einsum("nij,ni->nj", torso.rotation, held[:, part]) for part in (0, 1))
            wrenches[engine.plant.root_link] = Wrench(force, moment, np.array(point))
        return GroundRun(engine.plant, time, q, v, a, tau, base, torso.position, torso.rotation, wrenches, feet, audit)


def _footing(load: Load, place: Pose, twist: FloatArray) -> tuple[FloatArray | int, ...]:
    """Force on a foot, the moment about its origin, and how fast its centre of pressure slips."""
    moment = load.moment - np.cross(place.position, load.force)
    slip = np.zeros(3)
    if load.force[2] > 0.0:
        arm = np.array([-moment[1], moment[0], 0.0]) / load.force[2]  # from the origin, in the height of the ground
        arm[2] = -place.position[2]
        arm[:2] += arm[2] * load.force[:2] / load.force[2]
        slip = twist[3:] + np.cross(twist[:3], arm)
    return load.force, moment, place.position, place.rotation, load.points, np.hypot(slip[0], slip[1])
