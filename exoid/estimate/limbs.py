"""Limbs of one machine that are alike: a test whether they are equal, and one set of parameters if they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import BadArgumentError
from exoid.leg.leg import Leg
from exoid.leg.model import joint_axis
from exoid.torques.model import TorqueModel

from .comparison import holm, hotelling
from .estimate import Estimate
from .finding import Finding, Severity, ordered

CLOSE = 2e-3
"""Largest difference of lengths [m] and of axes between limbs of one design: URDFs round to a millimetre."""

LEVEL = 0.01
"""Probability with which limbs that are equal are called different, all together."""

MIRRORS = np.array(list(product((1.0, -1.0), repeat=3)))
"""Limbs that are the same, first, and mirror images in one to three axes of their links."""


class _Pair(NamedTuple):
    """Two limbs: their joints, and the signs of the second one's ten parameters per link beside the first one's."""

    joints: tuple[tuple[int, int], ...]
    signs: FloatArray


def share_alike(estimate: Estimate, limbs: Sequence[str]) -> Estimate:
    """Let limbs share their parameters, after a Wald test that they do; those that differ keep their own."""
    # Limbs that are alike have link parameters and friction of one limb: β = F D x with the symmetric vectors x. All
    # else is R β = 0 with R F D = 0. Restricted least squares is β − C Rᵀ (R C Rᵀ)⁻¹ R β, and Wald's statistic is
    # (R β)ᵀ (R C Rᵀ)⁻¹ R β.
    model = estimate.model
    if isinstance(limbs, str) or len(limbs) < 2 or len(set(limbs)) < len(limbs):
        raise BadArgumentError(f"alike limbs {limbs!r}", remedy='name two or more, such as alike=("LF", "RF")')
    first, *others = limbs
    pairs = {limb: _pair(model.leg, first, limb) for limb in others}
    tests = {limb: _restricted(estimate, [pair]) for limb, pair in pairs.items()}
    p_values = holm(np.array([p for _, _, p in tests.values()]))
    findings, equal = list(estimate.findings), []
    for limb, p in zip(others, p_values.tolist(), strict=True):
        moved = np.abs(tests[limb][0] - estimate.values) / np.where(estimate.std > 0.0, estimate.std, np.inf)
        most, same = estimate.names[int(np.argmax(moved))], p >= LEVEL
        equal += [limb] if same else []
        says = "share their parameters" if same else f"differ, most in {most}, and keep their own"
        remedy = "nothing to do" if same else "look for what was mounted or repaired on one of them"
        message = f"{first} and {limb} {says}: Wald test of equal limbs p = {p:.2g}"
        severity: Severity = "info" if same else "warning"
        kind, which = ("alike-limbs", ()) if same else ("unlike-limbs", (most,))
        findings.append(Finding(kind, "", p, "1", severity, message, remedy, parameters=which))
    if equal:
        values, covariance, _ = _restricted(estimate, [pairs[limb] for limb in equal])
        estimate = replace(estimate, values=values, covariance=covariance)
    return replace(estimate, findings=ordered(findings))


def _restricted(estimate: Estimate, pairs: Sequence[_Pair]) -> tuple[FloatArray, FloatArray, float]:
    """Restrict an estimate to limbs that are alike: values and covariance under R β = 0, and p-value of that."""
    scale = np.where(estimate.std > 0.0, estimate.std, 1.0)
    R = _restrictions(estimate.model, pairs)
    C = estimate.covariance / np.outer(scale, scale)
    R = R * scale
    R /= np.linalg.norm(R, axis=1, keepdims=True)
    spread, apart = R @ C @ R.T, R @ (estimate.values / scale)
    gain = np.linalg.lstsq(spread, R @ C, rcond=1e-12)[0].T
    values = estimate.values - scale * (gain @ apart)
    covariance = (C - gain @ R @ C) * np.outer(scale, scale)
    return values, 0.5 * (covariance + covariance.T), hotelling(apart, spread, estimate.dof)[1]


def _restrictions(model: TorqueModel, pairs: Sequence[_Pair]) -> FloatArray:
    """Form R of limbs that are alike, (restrictions, P)."""
    K, terms = model.leg.reduction.collect, model.every_name[len(model.leg.parameter_names) :]
    rigid, root = len(model.leg.parameter_names), K.shape[1] // 10 - len(model.leg.joint_names)
    F = np.zeros((len(model.names), K.shape[1] + len(terms)))
    F[:rigid, : K.shape[1]] = K
    shares = {one.name: one.into for one in model.regrouped}
    for k, name in enumerate(terms, start=K.shape[1]):
        for into, share in shares.get(name, {name: 1.0}).items():
            F[model.names.index(into), k] += share
    D = np.eye(F.shape[1])
    never = {symbol for term in model.terms for symbol in term.nonnegative}
    for pair in pairs:
        for a, b in pair.joints:
            of_a, of_b = (slice(10 * (root + joint), 10 * (root + joint + 1)) for joint in (a, b))
            D[of_b, of_a], D[of_b, of_b] = np.diag(pair.signs), 0.0
            for symbol in never:  # friction and rotors are alike whatever the sense of a joint; offsets are not
                of_terms = [f"{symbol}_{model.leg.joint_labels[joint]}" for joint in (a, b)]
                if set(of_terms) <= set(terms):
                    i, j = (K.shape[1] + terms.index(name) for name in of_terms)
                    D[j, i], D[j, j] = 1.0, 0.0
    FD = F @ D
    sizes = np.linalg.norm(FD, axis=0)
    # lengths that a URDF rounds differently for two limbs leave singular values of their difference
    return np.asarray(scipy.linalg.null_space((FD[:, sizes > 0.0] / sizes[sizes > 0.0]).T, rcond=CLOSE).T)


def _pair(leg: Leg, first: str, other: str) -> _Pair:
    """Find the joints of two limbs, and whether they are mirror images."""
    names = leg.joint_names
    of_limb = [[k for k, name in enumerate(names) if name.startswith(limb)] for limb in (first, other)]
    ends = [[names[k][len(limb) :] for k in joints] for limb, joints in zip((first, other), of_limb, strict=True)]
    if not ends[0] or ends[0] != ends[1]:
        raise BadArgumentError(
            f"limbs {first} and {other} have joints {', '.join(names[k] for k in of_limb[0]) or 'of no name'} and "
            f"{', '.join(names[k] for k in of_limb[1]) or 'of no name'}: they are not alike",
            where=leg.description.name,
            remedy=f"name limbs by how their joints begin; joints are {', '.join(names)}",
        )
    joints = tuple(zip(*of_limb, strict=True))
    for signs in sorted(MIRRORS, key=lambda signs: _apart(leg, signs, joints[:1], moved=False)):
        if _apart(leg, signs, joints, moved=True) < CLOSE:
            x, y, z = signs
            return _Pair(joints, np.array([1.0, x, y, z, 1.0, x * y, 1.0, x * z, y * z, 1.0]))
    raise BadArgumentError(
        f"limbs {first} and {other} have other lengths or axes, also as mirror images",
        where=leg.description.name,
        remedy="share parameters of limbs of one design only",
    )


def _apart(leg: Leg, signs: FloatArray, joints: Sequence[tuple[int, int]], *, moved: bool) -> float:
    """Largest difference of places and axes of joints and mirror images; the first may be anywhere if moved."""
    M, apart = np.diag(signs), 0.0
    for k, pair in enumerate(joints):
        (at_a, at_b), (axis_a, axis_b) = zip(
            *((leg.model.jointPlacements[j + 1], joint_axis(leg.model.joints[j + 1])) for j in pair), strict=True
        )
        apart = max(apart, np.abs(at_b.rotation - M @ at_a.rotation @ M).max())
        turned = np.concatenate([M @ axis_a[:3], M @ axis_a[3:]])
        apart = max(apart, min(np.abs(axis_b - turned).max(), np.abs(axis_b + turned).max()))
        if k or not moved:
            apart = max(apart, np.abs(at_b.translation - M @ at_a.translation).max())
    return float(apart)
