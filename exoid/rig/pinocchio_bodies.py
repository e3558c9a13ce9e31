"""Rigid-body dynamics of a single rig of any leg by Pinocchio's algorithms, with closed loops or without."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.closure import TreeMotion
from exoid.leg.model import configuration
from exoid.leg.torso import tilted_gravity

from .plant import Plant


class PinocchioBodies:
    """Rigid bodies of one rig, its parameters and the tilt of its torso."""

    def __init__(self, plant: Plant) -> None:
        if plant.count != 1:
            raise BadArgumentError(
                f"only planar legs are simulated in a batch, not {plant.count} rigs of this one",
                where=plant.leg.description.name,
                remedy="simulate one rig at a time: plant.take([k])",
            )
        leg = plant.leg.with_parameters(plant.parameters[:, 0])
        self.model = pin.Model(leg.model)
        self.model.gravity.linear = tilted_gravity(leg.plane, float(plant.pitch[0]))
        self.model.armature[:] = 0.0  # rotors are the stepper's
        self.data = self.model.createData()
        self._closure = leg.closure
        self._below = np.tri(self.model.nv, k=-1, dtype=np.bool_)

    def dynamics(self, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mass matrix, (n, n, 1), and bias torque, (n, 1)."""
        motion = self._motion(q, v)
        at = configuration(self.model, motion.q)[0]
        upper = pin.crba(self.model, self.data, at)
        M = np.where(self._below, upper.T, upper)  # some versions of Pinocchio compute the upper triangle alone
        bias = np.array(pin.rnea(self.model, self.data, at, motion.v[0], motion.a[0]))
        if motion.G is not None:
            M, bias = motion.project(motion.project(M[None]).swapaxes(1, 2))[0], motion.project(bias[None])[0]
        return M[..., None], bias[:, None]

    def energy(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Kinetic and potential energy, (1,)."""
        motion = self._motion(q, v)
        at = configuration(self.model, motion.q)[0]
        moving = pin.computeKineticEnergy(self.model, self.data, at, motion.v[0])
        return np.array([moving + pin.computePotentialEnergy(self.model, self.data, at)])

    def _motion(self, q: FloatArray, v: FloatArray) -> TreeMotion:
        """Motion of all joints at no acceleration of those of the leg; the next pose is looked for from this one."""
        if self._closure is None:
            return TreeMotion(q.T, v.T, np.zeros_like(v.T))
        motion = self._closure.motion(q.T, v.T, np.zeros_like(v.T))
        self._closure = replace(self._closure, reference=motion.q[0])
        return motion
