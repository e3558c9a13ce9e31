"""Walk on level ground or a slope, by the documents' stride or a CSV file."""

from __future__ import annotations

import os

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError, in_file
from exoid.experiments.ground.walking import healthy_flexion
from exoid.signals.readers.formats import open_table
from exoid.tools.numbers import checked

from .body import SIDES, Body
from .function import PHASE, Function

STRIDE = ("phase", "hip_deg", "knee_deg", "ankle_deg")  # columns of a stride; a leg may have no ankle


def stride_flexion(reference: str | os.PathLike[str], scale: float) -> FloatArray:
    """Tabulate hip, knee and ankle over a stride from heel contact, flexion at :data:`PHASE` [rad], (K, 3)."""
    if reference == "healthy":
        return healthy_flexion(PHASE % 1.0, scale)
    path = os.fsdecode(reference)
    with in_file(path):
        table = open_table(path)
        if lacking := [name for name in STRIDE[:3] if name not in table.header]:
            what = f"no column {lacking[0]!r}, so no table of a stride"
            remedy = "give columns phase (0 to 1), hip_deg, knee_deg, and perhaps ankle_deg, below a header"
            raise UnreadableInputError(what, remedy=remedy)
        columns = table.numbers([name for name in STRIDE if name in table.header]).T
    phase, angles = np.unwrap(columns[0], period=1.0), np.zeros((columns.shape[1], 3))
    angles[:, : len(columns) - 1] = np.deg2rad(columns[1:].T)
    rises = len(phase) >= 8 and (np.diff(phase) > 0.0).all() and 0.9 <= phase[-1] - phase[0] <= 1.0 + 1e-6
    if not rises or not np.isfinite(angles).all():
        raise UnreadableInputError(
            "the stride is not finite, has fewer than 8 phases, or they do not rise over one whole stride",
            where=path,
            remedy="check its rows",
        )
    again = slice(0, -1) if phase[-1] - phase[0] > 1.0 - 1e-6 else slice(None)  # the last row may be the first one
    t, x = np.append(phase[again], phase[0] + 1.0), np.vstack([angles[again], angles[:1]])
    found = scipy.interpolate.CubicSpline(t, x, bc_type="periodic")(t[0] + (PHASE - t[0]) % 1.0)
    mean = found[:-1].mean(axis=0)
    return np.asarray(mean + scale * (found - mean))


def walk(
    body: Body,
    *,
    reference: str | os.PathLike[str] = "healthy",
    scale: float = 0.9,
    period: float = 1.4,
    angle: float = 0.0,
) -> Function:
    """Walk: both legs follow a stride, half a period apart, and the lowest point of the soles rests.

    Args:
        body: The wearer.
        reference: "healthy" for :func:`exoid.experiments.healthy_gait`, or a CSV file with columns ``phase`` (0 to 1,
            from heel contact), ``hip_deg``, ``knee_deg`` and perhaps ``ankle_deg``, flexion positive.
        scale: Factor of the amplitudes about the mean.
        period: Time of a stride [s].
        angle: Angle by which the ground rises forward [rad]. The walk turns with it, and the torso keeps its pitch.

    Returns:
        The function, "walk" or "slope"; phase 0 is the heel contact of the left foot.

    Raises:
        ExoidError: There is no such file, or no stride in it, a leg is too short, or the slope is above 0.3 rad.
    """
    checked(abs(angle), "the angle of a slope [rad]", most=0.3)
    one = stride_flexion(reference, scale)
    both = np.stack([one, np.vstack([one[100:], one[1:101]])], axis=1)
    if body.ankle == 0.0:
        both[..., 2] = 0.0
    soles = [body.sole(np.zeros(len(PHASE), dtype=np.complex128), 0.0, both[:, k]) for k in range(2)]
    low = np.array([sole.imag.min(axis=1) for sole in soles])
    smooth = 0.02 * len(PHASE)
    up = scipy.ndimage.gaussian_filter1d(-low.min(axis=0)[:-1], smooth, mode="wrap")
    load = np.exp(-(low - low.min(axis=0)) / 0.01)[:, :-1]  # passes from foot to foot over 1 cm
    middle = np.array([s.real.mean(axis=1) for s in soles])[:, :-1]
    speed = -((np.roll(middle, -1, axis=1) - np.roll(middle, 1, axis=1)) * 0.5 * load).sum(axis=0) / load.sum(axis=0)
    speed = scipy.ndimage.gaussian_filter1d(speed, smooth, mode="wrap")
    hip = np.append(0.0, np.cumsum(speed)) + 1j * np.append(up, up[0])
    flexion = []
    for k in range(2):
        sole = body.sole(hip, 0.0, both[:, k])
        height = np.maximum(sole.imag.min(axis=1), 0.0)
        raised = sole.mean(axis=1) + 1j * 0.015 * height / (height + 0.01)  # [m] higher
        tilt = np.angle(sole[:, 1] - sole[:, 0])
        found = body.reach(hip, 0.0, raised, tilt if body.ankle else np.zeros(len(PHASE)))
        found[:, 2] *= bool(body.ankle)
        flexion.append(found)
    lowest = np.array([body.sole(hip, 0.0, each).imag.min(axis=1) for each in flexion])
    down = lowest < 0.004 + low.min(axis=0) + hip.imag
    down |= ~down.any(axis=0) & (low == low.min(axis=0))  # never in the air
    sets = [frozenset(side for side, flag in zip(SIDES, flags, strict=True) if flag) for flags in down.T]
    order = tuple((float(PHASE[k]), one) for k, one in enumerate(sets) if k == 0 or one != sets[k - 1])
    hip = hip * np.exp(1j * angle)
    torso = np.column_stack([hip.real, hip.imag, np.zeros(len(PHASE))])
    both = np.stack(flexion, axis=1) + np.array([angle, 0.0, 0.0])
    return Function("slope" if angle else "walk", period, both, torso, order, cyclic=True)
