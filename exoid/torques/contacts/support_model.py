"""Torque model of rows that do not depend on unknown wrenches of links on the ground."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.leg.torso import MovingBase
from exoid.signals import Wrench
from exoid.torques.model import TorqueModel
from exoid.torques.motion import Motion, random_base, random_motion

from .elimination import eliminate, load_sharing, reference_axes

LOOP = "loop_"
"""Beginning of the names of rows of closed chains."""


@dataclass(frozen=True, eq=False, repr=False)
class SupportModel(TorqueModel):
    """Torque model while links rest on the ground, or the base is held, by wrenches that were not measured."""

    # [W_b; W_q] β = [0; τ] + Σ J_cᵀ w_c is projected on what the wrenches do no work on, see `eliminate`
    # (Aghili 2005; Mistry et al. 2010). Where the wrenches were measured, the other rows form a second model: those of
    # the base, which hold no torque, and those in which links share a load. The noise of plates is in these alone.

    links: tuple[str, ...] = ()  # links with an unknown wrench; none where all wrenches were measured
    axes: FloatArray | None = None  # reference of closed chains, see `reference_axes`
    plates: bool = False  # whether these are the rows that measured wrenches on the links add

    @classmethod
    def of(cls, model: TorqueModel, links: Sequence[str], q: FloatArray, *, plates: bool = False) -> SupportModel:
        """Let links of a model rest on the ground, at poses for which the reference of closed chains is chosen."""
        rest = (model.leg, model.terms, model.rigid, model.regrouped, model.separate, model.extras)
        axes = reference_axes(model.leg, links, q) if links else None
        return cls(*rest, links=tuple(links), axes=axes, plates=plates)

    @property
    def row_names(self) -> tuple[str, ...]:
        """Rows: those of the leg; joints where the base hangs on one link; directions of motion of closed chains."""
        if not self.links:
            return super().row_names
        rows, free = (0, 0) if self.axes is None else self.axes.shape
        if self.plates:
            base = super().row_names[: 0 if self._without_flat else self.leg.base_rows]
            return (*base, *(f"shared_{k + 1}" for k in range(rows - free if free else 0)))
        return tuple(f"{LOOP}{k + 1}" for k in range(free)) or self.leg.joint_names

    @property
    def row_joints(self) -> tuple[int, ...]:
        """Joint of each row; −1 for none."""
        if not self.links:
            return super().row_joints
        own = self.axes is None and not self.plates
        return tuple(range(len(self.leg.joint_names))) if own else (-1,) * len(self.row_names)

    @cached_property
    def acting(self) -> NDArray[np.bool_]:
        """Which parameters can act on which row, (R, P)."""
        q, v, a = random_motion(10, len(self.leg.joint_names), self.leg.closure)
        base = None if self.leg.base == "fixed" else random_base(10)
        return np.asarray(self.columns(self.motion(q, v, a, base)).any(axis=2).T)

    @property
    def _without_flat(self) -> bool:
        """Whether no link rests flat, so that base and joints form the rows together."""
        return self.axes is not None and len(self.axes) > len(self.leg.joint_names)

    def row_payload(self, payload: FloatArray, q: FloatArray, base: MovingBase | None = None) -> FloatArray:
        """Torque of payloads in the rows without the unknown wrenches."""
        return np.ascontiguousarray(self._reduced(payload.T[np.newaxis], q, base)[0].T)

    def columns(self, motion: Motion) -> FloatArray:
        """Form the columns of all parameters for a motion, and of extras for each joint alone: (P + n K, R, N)."""
        # payloads are torque of the rows that are left, and load no joint of the others
        whole = motion._replace(payload=None) if self.links else motion
        columns, extras = np.split(super().columns(whole), [len(self.names)])
        if len(extras):
            joints = len(self.leg.joint_names)
            apart = np.zeros((joints, *extras.shape))
            for joint, row in enumerate(range(-joints, 0)):
                apart[joint, :, row] = extras[:, row]
            columns = np.concatenate([columns, apart.reshape(-1, *extras.shape[1:])])
        return self._reduced(columns, motion.q, motion.torso)

    def row_torque(self, tau: FloatArray, motion: Motion, wrenches: Mapping[str, Wrench]) -> FloatArray:
        """Form the measured side of the equation."""
        full = super().row_torque(tau, motion, wrenches)
        return np.ascontiguousarray(self._reduced(full.T[np.newaxis], motion.q, motion.torso)[0].T)

    def row_shares(self, q: FloatArray) -> FloatArray | None:
        """Tell how the torque of each joint enters the rows."""
        loop = eliminate(self.leg, self.links, q, self.axes).loop if self.links else None
        return loop if loop is None else loop[:, -len(self.leg.joint_names) :]

    def measured_rows(self, measured: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Tell which rows have a measured side: joints of a closed chain share theirs."""
        if not self.links:
            return super().measured_rows(measured)
        return np.array([measured[joint] if joint >= 0 else measured.all() for joint in self.row_joints])

    def usable(self, v: FloatArray) -> NDArray[np.bool_]:
        """Select the samples from which the terms can be identified."""
        return self._on_rows(super().usable(v), np.all)

    def reversing(self, v: FloatArray) -> NDArray[np.bool_] | None:
        """Select the samples at which a joint turns round."""
        found = super().reversing(v)
        return None if found is None else self._on_rows(found, np.any)

    def _on_rows(self, of_joints: NDArray[np.bool_], together: Callable[..., NDArray[np.bool_]]) -> NDArray[np.bool_]:
        """Turn what holds for base rows and joints, (N, b + n), into what holds for rows, (N, R)."""
        if not self.links:
            return of_joints
        base = self.leg.base_rows
        joints, count = of_joints[:, base:], len(self.row_names)
        shared = np.repeat(together(joints, axis=1)[:, np.newaxis], count, axis=1)
        if self.plates and not self._without_flat:
            return np.hstack([of_joints[:, :base], shared[:, base:]])
        return joints if self.axes is None else shared

    def _reduced(self, rows: FloatArray, q: FloatArray, base: MovingBase | None) -> FloatArray:
        """Combine rows (K, b + n, N) into those without unknown wrenches, or into the others."""
        if not self.links:
            return rows
        elimination = eliminate(self.leg, self.links, q, self.axes, base)
        if not self.plates:
            return elimination.of(rows)
        free = rows[:, : self.leg.base_rows]
        if self.axes is None or elimination.loop is None:
            return free
        shared = elimination._replace(loop=load_sharing(elimination.loop, self.axes)).of(rows)
        return shared if self._without_flat else np.concatenate([free, shared], axis=1)
