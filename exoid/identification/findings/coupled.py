"""Coupled joints: does the log fit by far better if two logged torques are those of motors that move both joints?

Motors of a coupling have the torques τ_m = Aᵀ τ, so that τ = B τ_m with B = A⁻ᵀ. A common factor of B is one of the
masses. Near a guess of B, corrections b and b' to τ_i + b τ_k = W_i β and τ_k + b' τ_i = W_k β are linear beside β.
Friction of the motors depends on B, which is therefore found in a few rounds, from several guesses.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.actuators import Coupling, motor_terms
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding
from exoid.signals import Poses, Recording
from exoid.torques import CoupledTerm, TorqueModel

from .factors import TorqueFactors
from .sample import FittedLeg

GUESSES = (
    ((1.0, 1.0), (1.0, -1.0)),
    ((1.0, 1.0), (-1.0, 1.0)),
    ((1.0, -1.0), (1.0, 1.0)),
    ((-1.0, 1.0), (1.0, 1.0)),
    ((1.0, 1.0), (0.0, 1.0)),
    ((1.0, -1.0), (0.0, 1.0)),
    ((1.0, 0.0), (1.0, 1.0)),
    ((1.0, 0.0), (-1.0, 1.0)),
)
"""B of differentials and of belts, from which the search starts."""


class Coupled(NamedTuple):
    """Two joints whose logged torques are mixed."""

    joints: tuple[int, int]  # indices of both
    matrix: FloatArray  # B, with the largest entry of each row 1 or −1, (2, 2)
    misfit: float  # mean logarithm of residual over torque of the joints


def coupled_joints(fitted: FittedLeg, factors: TorqueFactors, reference: float) -> Coupled | None:
    """Look for two joints whose torques are mixed."""
    driven = [pair for pair in pairs_of(len(factors.driven)) if factors.driven[pair[0]] and factors.driven[pair[1]]]
    found = [
        better for pair in driven for guess in GUESSES for better in _corrected(fitted, pair, np.array(guess), rounds=1)
    ]
    found.sort(key=lambda one: one.misfit)
    # the three guesses that fit best after a round are followed for three more
    ends = [end for one in found[:3] for end in _corrected(fitted, one.joints, one.matrix, rounds=3)]
    best = min(ends, key=lambda one: one.misfit, default=None)
    # A joint has a tenth of the other torque at least, in whatever order, and residuals are 2.5 times smaller.
    if best is None or np.sort(np.abs(best.matrix), axis=1)[:, 0].max() <= 0.1:
        return None
    return best if best.misfit < reference - np.log(2.5) else None


def pairs_of(joints: int) -> Iterable[tuple[int, int]]:
    """Pairs of joints that may be confused: beyond four joints only neighbours."""
    return combinations(range(joints), 2) if joints <= 4 else ((j, j + 1) for j in range(joints - 1))


def _corrected(fitted: FittedLeg, pair: tuple[int, int], B: FloatArray, *, rounds: int) -> Iterator[Coupled]:
    """Correct B, with friction of motors as it would be; nothing where that fails."""
    try:
        for _ in range(rounds):
            trial = _with_motors(fitted, pair, B)
            data = [_unmixed(one, pair, B) for one in fitted.data]
            fit = TorqueFactors.of(trial, data).fit(trial, mixed=pair)
            B = np.array([[1.0, fit.shares[0]], [fit.shares[1], 1.0]]) @ B
            B = B / np.abs(B).max(axis=1, keepdims=True)
    except (ExoidError, np.linalg.LinAlgError):
        return
    if np.isfinite(B).all():
        yield Coupled(pair, B, fit.misfit)


def _with_motors(fitted: FittedLeg, pair: Sequence[int], B: FloatArray) -> FittedLeg:
    """Add terms of the motors of a coupling, A = B⁻ᵀ."""
    model = fitted.model
    joints = tuple(model.joint_names[k] for k in pair)
    coupling = Coupling((joints[0], joints[1]), tuple(map(tuple, np.linalg.inv(B).T.tolist())))
    terms = (*(term for term in model.terms if not isinstance(term, CoupledTerm)), *motor_terms(coupling))
    known = {name: value for name, value in zip(model.names, fitted.fixed, strict=True) if np.isfinite(value)}
    trial = TorqueModel(model.leg, terms, separate=tuple(known))
    return fitted._replace(model=trial, fixed=np.array([known.get(name, np.nan) for name in trial.names]))


def _unmixed(one: Recording | Poses, pair: Sequence[int], B: FloatArray) -> Recording | Poses:
    """Torques of the joints, if those logged were of motors: τ = B τ_m."""
    if one.tau is None:
        return one
    tau = one.tau.copy()
    tau[:, list(pair)] = tau[:, list(pair)] @ B.T
    return replace(one, tau=tau)


def coupling_finding(model: TorqueModel, coupled: Coupled, reference: float) -> Finding:
    """Describe two joints whose torques are mixed."""
    one, other = (model.joint_names[k] for k in coupled.joints)
    ratio = float(np.exp(reference - coupled.misfit))
    sums = [f"{row[0]:+.2g} τ({one}) {row[1]:+.2g} τ({other})" for row in coupled.matrix.tolist()]
    message = (
        f"the torques logged for {one} and {other} are mixed, as those of motors of a differential or a belt are: "
        f"residuals are {ratio:.2g} times smaller with {sums[0]} for {one} and {sums[1]} for {other}, in some unit"
    )
    remedy = (
        'describe the coupling, q = A θ_m (exoid.actuators.Coupling, or type = "coupling" in the file for '
        "--actuators), and read these columns as motor torques, tm_<joint>"
    )
    return Finding("coupled-joints", f"{one}, {other}", ratio, "1", "error", message, remedy, parameters=model.names)
