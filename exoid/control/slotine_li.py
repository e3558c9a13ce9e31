"""Linear model of an adaptive controller: regressor Y(q, v, v_r, a_r) of the documented parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.estimate import Estimate

from .friction import WIDTH
from .model import ControlModel, ModelSource, completed
from .other_term import torque_of
from .parameter_change import ExpectedChange, payload_covariance


@dataclass(frozen=True, eq=False)
class SlotineLiModel:
    """τ = Y(q, v, v_r, a_r) β = M(q) a_r + C(q, v) v_r + G(q) + s(q) + c0 tanh(v_r / w) + d v_r + Ia a_r."""

    # C is the Coriolis matrix of Christoffel's symbols, with ½Ṁ − C skew-symmetric. C(q, v) v_r is bilinear and
    # symmetric in both velocities, so it follows from the torque regressor W of the leg at two velocities
    # (polarisation):
    #
    #     Y = W(q, (v + v_r)/2, a_r) − W(q, (v − v_r)/2, 0) + W(q, 0, 0).
    #
    # Friction is a monotone function f, so (v − v_r)(f(v) − f(v_r)) ≥ 0: compensated at v_r, it only adds damping, and
    # the noise of the measured velocity does not make it chatter.

    model: ControlModel  # model with the initial values, the terms without a linear form among them
    names: tuple[str, ...]  # names of the adapted parameters, (P,)
    values: FloatArray  # initial values, (P,)
    covariance: FloatArray  # covariance of the initial values and of their expected changes, (P, P)
    kinds: tuple[tuple[str, int], ...]  # symbol and joint of each parameter that is not one of the bodies

    @classmethod
    def of(cls, source: ModelSource, change: ExpectedChange) -> SlotineLiModel:
        """Make the model: parameters of the bodies, and springs, friction and rotors whose coefficient is not zero."""
        model = ControlModel.of(source)
        labels, count = model.leg.joint_labels, len(model.leg.parameter_names)
        powers = range(len(model.spring) - 1, -1, -1)
        rows = {f"b{power}": row for power, row in zip(powers, model.spring, strict=True)}
        rows |= {"c0": model.coulomb, "d": model.viscous, "Ia": model.armature}
        kinds = tuple((symbol, joint) for symbol, row in rows.items() for joint in np.flatnonzero(row).tolist())
        values = np.append(model.leg.parameters, [rows[symbol][joint] for symbol, joint in kinds])
        names = (*model.leg.parameter_names, *(f"{symbol}_{labels[joint]}" for symbol, joint in kinds))
        covariance = np.zeros((len(names), len(names)))
        covariance[:count, :count] = payload_covariance(change.payload, model.leg)
        for k, (symbol, _) in enumerate(kinds, start=count):
            covariance[k, k] = (change.friction * values[k]) ** 2 if symbol in ("c0", "d") else 0.0
        if isinstance(source, Estimate):
            # The variance of a parameter that is not determined says nothing of the leg: as a gain it would be huge.
            classes = dict(zip(source.names, source.identifiability, strict=True))
            known = np.flatnonzero([classes.get(name, "not") != "not" for name in names])
            own = [source.names.index(names[k]) for k in known]
            covariance[np.ix_(known, known)] += completed(source).covariance[np.ix_(own, own)]
        if not np.isfinite(covariance).all() or not (np.diagonal(covariance) > 0.0).any():
            raise BadArgumentError(
                "no parameter may change, or its covariance is not finite",
                remedy="give an estimate with a covariance, or an ExpectedChange above zero",
            )
        return cls(model, names, values, covariance, kinds)

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.model.n

    @property
    def positive(self) -> NDArray[np.bool_]:
        """Whether each parameter behind those of the bodies is not negative, (P − p,)."""
        return np.array([symbol in ("c0", "d", "Ia") for symbol, _ in self.kinds], dtype=np.bool_)

    def regressor(self, q: FloatArray, v: FloatArray, v_r: FloatArray, a_r: FloatArray) -> FloatArray:
        """Compute Y of B legs from (n, B), (B, n, P); see the class."""
        still, count = np.zeros_like(v), len(self.model.leg.parameter_names)
        Y = np.zeros((q.shape[1], self.n, len(self.names)))
        angles, rates = np.hstack([q, q, q]).T, np.hstack([0.5 * (v + v_r), 0.5 * (v - v_r), still]).T
        W = self.model.leg.regressor(angles, rates, np.hstack([a_r, still, still]).T).reshape(3, *Y.shape[:2], count)
        Y[..., :count] = W[0] - W[1] + W[2]
        for k, (symbol, joint) in enumerate(self.kinds, start=count):
            if symbol.startswith("b"):
                Y[:, joint, k] = q[joint] ** int(symbol[1:])
            else:
                Y[:, joint, k] = {"c0": np.tanh(v_r[joint] / WIDTH), "d": v_r[joint], "Ia": a_r[joint]}[symbol]
        return Y

    def fixed(self, q: FloatArray, v_r: FloatArray, a_r: FloatArray) -> FloatArray:
        """Compute the torque of terms that are not adapted, such as friction that depends on the load."""
        others = self.model.others
        return torque_of(others, q, v_r, a_r, self.model.gravity(q)) if others else np.zeros_like(q)
