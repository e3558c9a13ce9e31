"""Healthy gait: the stride of document 2's swing leg (Fig. 6), and gait for a given leg."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from exoid.errors import NotSupportedError
from exoid.leg.leg import Leg
from exoid.leg.leg_data import ROLES, joint_roles

from .references import Harmonics, from_coefficients

MEAN_DEG = np.array([7.4377, 22.5942])
"""Mean a0 of hip and knee flexion [deg]."""

COSINE_DEG = np.array(
    [[10.6017, -3.8939, -0.8879, -0.1671, -0.6595, 0.1313], [-8.0762, -15.0416, 0.2818, -1.0307, -0.2604, 0.3631]]
)
"""Cosine coefficients a1 … a6 of hip and knee [deg]."""

SINE_DEG = np.array(
    [[-6.8851, -2.0996, 1.9815, -0.1354, -0.2903, -0.0072], [-22.1204, 10.7759, 4.1605, 0.7560, 0.4598, 0.0265]]
)
"""Sine coefficients b1 … b6 of hip and knee [deg]; six harmonics fit a published stride to 0.2° rms."""


def healthy_gait(scale: float = 1.2, period: float = 10.0) -> Harmonics:
    """Make the hip and knee flexion of a stride, θ = a0 + Σ scale (a_k cos 2πkp + b_k sin 2πkp), p = t/period.

    The stride begins at heel contact. Document 2 scales the amplitudes by a factor that it does not print; its stride
    takes 10 s.

    Args:
        scale: Factor of the amplitudes about the mean.
        period: Period of the stride [s].

    Returns:
        Motion of one CUHK-EXO leg; both angles are positive in flexion.
    """
    mean, cosine, sine = (np.deg2rad(x) for x in (MEAN_DEG, COSINE_DEG, SINE_DEG))
    return from_coefficients(mean, scale * cosine, scale * sine, period)


def gait_for_leg(leg: Leg, flexion: Harmonics, roles: Mapping[str, str] | None = None) -> Harmonics:
    """Convert flexion of hip, knee and ankle to joint angles of a leg.

    Hip flexion is forward and knee flexion backward, for any direction of the axes in the URDF. An ankle without
    flexion data stays at zero.

    Args:
        leg: Planar leg with joints hip, knee and ankle, or some of them.
        flexion: Flexion of hip and knee, or of hip, knee and ankle.
        roles: "hip", "knee" or "ankle" for each joint that has another name.

    Returns:
        Motion of the leg.

    Raises:
        ExoidError: The leg is not planar, has other joints or another order of them, or a role does not fit.
    """
    labels, chain = joint_roles(leg, roles or {}), leg.chain
    if chain is None or [role for role in ROLES if role in labels] != [*labels]:  # from the torso outwards
        raise NotSupportedError(
            f"no gait for the joints {', '.join(labels)}",
            where=leg.description.name,
            remedy=f"use a planar leg with {', '.join(ROLES)}, name the role of each joint, or follow a log",
            command=f"name the role of each joint (--role {labels[0]}=hip), or follow a log with --reference"
            if chain
            else "follow a log with --reference: gaits are for planar legs whose joints all turn",
        )
    signs = [-sign if label == "knee" else sign for label, sign in zip(labels, chain.signs.tolist(), strict=True)]
    rows = [ROLES.index(label) for label in labels]
    known = flexion.amplitude.shape[1]
    shape = (len(flexion.amplitude), len(labels), flexion.amplitude.shape[2])
    centre, amplitude, phase = np.zeros(shape[1:]), np.zeros(shape), np.zeros(shape)
    for k, (row, sign) in enumerate(zip(rows, signs, strict=True)):
        if row < known:
            centre[k], amplitude[:, k] = sign * flexion.centre[row], sign * flexion.amplitude[:, row]
            phase[:, k] = flexion.phase[:, row]
    return Harmonics(centre, amplitude, flexion.frequency, phase)


def fit_to_limits(leg: Leg, motion: Harmonics) -> Harmonics:
    """Scale and shift joints that leave their limits until 5 % of the range of the joint is free at both ends."""
    time = 2.0 * np.pi / float(np.min(motion.frequency)) * np.arange(400) / 400
    angles = np.array([motion.at(float(t)).q for t in time])
    low, high = angles.min(axis=0), angles.max(axis=0)
    lower, upper, *_ = (limit[:, None] for limit in leg.limits)
    room = upper - lower
    free = np.where(np.isfinite(room), 0.05 * room, 0.0)
    beyond = (low < lower) | (high > upper)
    scale = np.where(
        beyond & (high - low > room - 2.0 * free), (room - 2.0 * free) / np.maximum(high - low, 1e-12), 1.0
    )
    below, above = motion.centre + scale * (low - motion.centre), motion.centre + scale * (high - motion.centre)
    shift = np.maximum(lower + free - below, 0.0) + np.minimum(upper - free - above, 0.0)
    return replace(motion, centre=motion.centre + np.where(beyond, shift, 0.0), amplitude=scale * motion.amplitude)
