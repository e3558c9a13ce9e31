"""Linearisation of a torque model in which friction depends on the rigid-body torque."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from exoid._typing import FloatArray

from .model import TorqueModel
from .motion import BLOCK, LoadedMotion, Motion
from .term import TermBlock, load_motion


@dataclass(frozen=True, eq=False, repr=False)
class Linearised(TorqueModel):
    """τ ≈ J β + rest about a point, with J = ∂τ/∂β."""

    # Rigid bodies contribute to ∂τ/∂β a second time where friction depends on their torque. The regressor has one
    # column more than there are names: the rest, which is known. Where the least-squares solution for J is the point
    # itself, it solves the nonlinear problem with the covariance of the Gauss-Newton method.

    point: FloatArray = field(kw_only=True)  # β at which the model is linearised, (P,)

    @classmethod
    def of(cls, model: TorqueModel, point: FloatArray) -> Linearised:
        """Linearise a model about a point."""
        rigid = point[: len(model.leg.parameter_names)]
        return cls(model.leg, model.terms, rigid, model.regrouped, model.separate, point=point)

    def columns(self, motion: Motion) -> FloatArray:
        """Form the columns ∂τ/∂β for a motion, or for some rows of one, and the rest of the torque."""
        plain, rigid = super().columns(motion), len(self.leg.parameter_names)
        out = np.concatenate([plain, np.zeros_like(plain[:1])])
        for start in range(0, len(motion.q), BLOCK):
            rows = slice(start, start + BLOCK)
            part, of_rows = out[:, self.leg.base_rows :, rows], motion.rows(rows)
            loaded = load_motion(self.blocks, of_rows, part, self.point[:rigid])
            by_load = np.zeros_like(loaded.load)
            for block in self.blocks:
                if block.term.loaded:
                    by_load[block.joints[0]] += self._slope_by_load(block, loaded)
            part[-1] -= by_load * (loaded.load - loaded.payload)
            part[:rigid] *= 1.0 + by_load
        return out

    def _slope_by_load(self, block: TermBlock, motion: LoadedMotion) -> FloatArray:
        """∂τ/∂τ_rb of one term, (N,)."""
        # Step of the differences by the load, relative to its largest value
        step = 1e-6 * float(np.abs(motion.load[block.joints[0]]).max())
        if step == 0.0:
            return np.zeros(motion.load.shape[1])
        known = dict(zip(self.names, self.point.tolist(), strict=True))
        values = np.array([known.get(name, 0.0) for name in block.names])
        above, below = (block.columns(motion._replace(load=motion.load + each)) for each in (step, -step))
        difference = np.tensordot(values, above, axes=1) - np.tensordot(values, below, axes=1)
        return np.asarray(difference[0] / (2.0 * step))
