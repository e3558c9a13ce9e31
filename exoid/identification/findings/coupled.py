"""Coupled joints: does the log fit by far better if two logged torques are those of motors that move both joints?

Motors of a coupling have the torques τ_m = Aᵀ τ, so that τ = B τ_m with B = A⁻ᵀ. A common factor of B is one of the
masses. Near a guess of B, corrections b and b' to τ_i + b τ_k = W_i β and τ_k + b' τ_i = W_k β are linear beside β.
Friction of the motors depends on B, which is therefore found in a few rounds, from several guesses.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
from .sample import Checked

MIXED = 0.1
"""Smallest share of the other torque in one of both joints."""

FAR_BETTER = 2.5
"""Residuals, relative to the torque, have to be so many times smaller (geometric mean of all joints)."""

MOST_JOINTS = 4
"""Up to so many joints all pairs are tried, beyond only neighbours."""

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

FOLLOWED, ROUNDS = 3, 3
"""Number of guesses that are followed, those that fit best after a round; and of rounds that follow."""


class Coupled(NamedTuple):
    """Two joints whose logged torques are mixed."""

    joints: tuple[int, int]  # indices of both
    matrix: FloatArray  # B, with the largest entry of each row 1 or −1, (2, 2)
    misfit: float  # mean logarithm of residual over torque of the joints


def coupled_joints(checked: Checked, factors: TorqueFactors, reference: float) -> Coupled | None:
    """Look for two joints whose torques are mixed."""
    joints = len(checked.model.joint_names)
    pairs = combinations(range(joints), 2) if joints <= MOST_JOINTS else ((j, j + 1) for j in range(joints - 1))
    driven = [pair for pair in pairs if factors.driven[pair[0]] and factors.driven[pair[1]]]
    first = [Coupled(pair, np.array(guess), np.inf) for pair in driven for guess in GUESSES]
    found = sorted((better for one in first for better in _corrected(checked, one, 1)), key=_misfit)
    best = min((b for one in found[:FOLLOWED] for b in _corrected(checked, one, ROUNDS)), key=_misfit, default=None)
    if best is None or not is_mixed(best.matrix):
        return None
    return best if best.misfit < reference - np.log(FAR_BETTER) else None


def is_mixed(B: FloatArray) -> bool:
    """Say whether a joint has a part of both logged torques, in whatever order."""
    return bool(np.sort(np.abs(B), axis=1)[:, 0].max() > MIXED)


def _misfit(one: Coupled) -> float:
    return one.misfit


def _corrected(checked: Checked, guess: Coupled, rounds: int) -> Iterator[Coupled]:
    """Correct B, with friction of motors as it would be; nothing where that fails."""
    pair, B, misfit = guess.joints, guess.matrix, np.inf
    try:
        for _ in range(rounds):
            trial = _with_motors(checked, pair, B)
            data = [_unmixed(one, pair, B) for one in checked.data]
            fit = TorqueFactors.of(trial, data).fit(trial, mixed=pair)
            B = np.array([[1.0, fit.shares[0]], [fit.shares[1], 1.0]]) @ B
            B, misfit = B / np.abs(B).max(axis=1, keepdims=True), fit.misfit
    except (ExoidError, np.linalg.LinAlgError):
        return
    if np.isfinite(B).all():
        yield Coupled(pair, B, misfit)


def _with_motors(checked: Checked, pair: Sequence[int], B: FloatArray) -> Checked:
    """Add terms of the motors of a coupling, A = B⁻ᵀ."""
    model = checked.model
    joints = tuple(model.joint_names[k] for k in pair)
    coupling = Coupling((joints[0], joints[1]), tuple(map(tuple, np.linalg.inv(B).T.tolist())))
    terms = (*(term for term in model.terms if not isinstance(term, CoupledTerm)), *motor_terms(coupling))
    known = {name: value for name, value in zip(model.names, checked.fixed, strict=True) if np.isfinite(value)}
    trial = TorqueModel(model.leg, terms, separate=tuple(known))
    return checked._replace(model=trial, fixed=np.array([known.get(name, np.nan) for name in trial.names]))


def _unmixed(one: Recording | Poses, pair: Sequence[int], B: FloatArray) -> Recording | Poses:
    """Torques of the joints, if those logged were of motors: τ = B τ_m."""
    if one.tau is None:
        return one
    tau = one.tau.copy()
    tau[:, list(pair)] = tau[:, list(pair)] @ B.T
    return replace(one, tau=tau)


def coupling_finding(checked: Checked, coupled: Coupled, reference: float) -> Finding:
    """Describe two joints whose torques are mixed."""
    model, (one, other) = checked.model, coupled.joints
    names, B = model.joint_names, coupled.matrix
    pair = (names[one], names[other])
    ratio = float(np.exp(reference - coupled.misfit))
    return Finding(
        "coupled-joints",
        f"{names[one]}, {names[other]}",
        ratio,
        "1",
        "error",
        f"the torques logged for {names[one]} and {names[other]} are mixed, as those of motors of a differential or a "
        f"belt are: residuals are {ratio:.2g} times smaller with {_sum(B[0], pair)} for {pair[0]} and "
        f"{_sum(B[1], pair)} for {pair[1]}, in some unit",
        'describe the coupling, q = A θ_m (exoid.actuators.Coupling, or type = "coupling" in the file for '
        "--actuators), and read these columns as motor torques, tm_<joint>",
        parameters=model.names,
    )


def _sum(row: FloatArray, names: Sequence[str]) -> str:
    """Write a sum of logged torques."""
    return " ".join(f"{share:+.2g} τ({name})" for share, name in zip(row.tolist(), names, strict=True))
