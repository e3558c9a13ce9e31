"""Test whether anything acts on a joint beyond its actuator: torque larger than noise and model error explain."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

LEVEL = 0.01
"""Largest probability that a recording without a wearer is called worn."""

ALLOWANCE = 1.5
"""Residuals of an unworn leg may be so many times larger than in the training: friction changes from day to day.

Logs of legs that are not worn reach 1.1 (real ones) and 1.3 (friction of another form at twice the speed of the
training, ``scripts/study_interaction.py --unworn``)."""


class Evidence(NamedTuple):
    """What the residuals of one recording say of each joint, (n,) each."""

    # mean square of the torque about its mean [N²·m²]; not a number where the torque was not measured
    power: FloatArray
    mean: FloatArray  # mean of the torque [N·m]
    noise: FloatArray  # variance that the noise of the training gives it [N²·m²]
    systematic: FloatArray  # mean variance by errors of the parameters and of the form of friction [N²·m²]
    effective: FloatArray  # independent samples that say as much on the power of the noise
    trained: FloatArray  # independent samples behind the variance of the noise


class JointAction(NamedTuple):
    """Result of the test of one joint.

    Attributes:
        p_value: Largest probability of so large a torque where nothing acts; not a number where that was not tested.
        acts: Whether something acts, at the level of the test.
        least: Smallest rms of a torque about its mean that the test would notice [N·m].
        steady: Whether the mean of the torque is beyond its error.
    """

    p_value: float
    acts: bool
    least: float
    steady: bool


def judge(evidence: Evidence, level: float = LEVEL) -> tuple[JointAction, ...]:
    """Test each joint of a recording."""
    # Where nothing acts, the torque about its mean has the power E = σ² + s², noise and systematic error. The noise is
    # that of the training, with N independent samples here and M there. The systematic error has few degrees of
    # freedom: it counts as one. By Satterthwaite the power over A² E then follows F with
    # ν = E² / (σ⁴/N + s⁴) and M degrees of freedom, or less: A is `ALLOWANCE`. All joints together are wrong with
    # the probability `level` at most (Bonferroni).
    #
    # The mean is left out, as a sensor's zero that moved looks like a wearer who pushes evenly.
    tested = ~np.isnan(evidence.power) & (evidence.noise > 0.0)
    E = np.where(tested, evidence.noise + evidence.systematic, 1.0)
    count, behind = np.maximum(evidence.effective, 1.0), np.maximum(evidence.trained, 1.0)
    spread = evidence.noise**2 / count + evidence.systematic**2
    dof = np.maximum(np.divide(E**2, spread, out=np.ones_like(E), where=tested & (spread > 0.0)), 1.0)
    share = level / max(1, int(tested.sum()))
    allowed = ALLOWANCE**2 * E
    p_values = np.where(tested, scipy.stats.f.sf(evidence.power / allowed, dof, behind), np.nan)
    least = np.sqrt(np.maximum(allowed * scipy.stats.f.isf(share, dof, behind) - E, 0.0))
    of_mean = 2.0 * evidence.noise / count + evidence.systematic  # 2: correlation counts more for a mean than a power
    beyond = scipy.stats.t.isf(0.5 * share, np.minimum(count, behind)) * ALLOWANCE * np.sqrt(of_mean)
    steady = tested & (np.abs(np.nan_to_num(evidence.mean)) > beyond)
    columns = (p_values, tested & (p_values < share), np.where(tested, least, np.nan), steady)
    return tuple(
        JointAction(float(p), bool(acts), float(small), bool(constant))
        for p, acts, small, constant in zip(*columns, strict=True)
    )


def together(parts: tuple[tuple[JointAction, ...], ...]) -> tuple[JointAction, ...]:
    """Join the tests of several recordings: something acts on a joint if it does in one of them."""
    joined = []
    for of_joint in zip(*parts, strict=True):
        p_values = [each.p_value for each in of_joint if not np.isnan(each.p_value)]
        least = [each.least for each in of_joint if not np.isnan(each.least)]
        p_value = min(1.0, len(p_values) * min(p_values)) if p_values else np.nan
        acts, steady = any(each.acts for each in of_joint), any(each.steady for each in of_joint)
        joined.append(JointAction(p_value, acts, min(least, default=np.nan), steady))
    return tuple(joined)
