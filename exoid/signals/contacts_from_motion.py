"""Contacts found from the motion: which links, or which heels and toes of a foot, stand still on level ground."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import BoolArray
from exoid.leg.leg import Leg
from exoid.leg.link_frames import ball_radius

from .cutoff import white_noise
from .link_wrenches import link_placement
from .recording import Recording

WINDOW = 0.04
"""Time over which velocities are taken, and shortest contact [s]."""

SPEED, HEIGHT = 0.05, 0.02
"""A point that rests moves by less [m/s], and is no more above the ground [m]."""


def contacts_from_motion(leg: Leg, recording: Recording, links: Iterable[str]) -> dict[str, BoolArray]:
    """Find when the origins of links rest on level ground: they stand still, no more than 2 cm above it.

    A point stands still where its velocity over 40 ms is below 5 cm/s, or six standard deviations of the noise of its
    place; of a ball it is the point that touches. Links ``<foot>_heel`` and ``<foot>_toe`` say which part of a foot is
    down; both together are a flat foot. The ground is where points stand still at their lowest. A foot that hovers just
    above it without moving counts as down.

    Args:
        leg: The leg.
        recording: Motion, with the pose of the base if the base moves.
        links: Links of the URDF, whose origins touch the ground.

    Returns:
        Samples in contact by link, (N,), for ``contacts=`` of a recording.

    Raises:
        ExoidError: There is no such link, or the pose of the base is not known: an IMU does not measure it.

    Example:
        >>> flags = contacts_from_motion(leg, recording, ("foot",))  # doctest: +SKIP
        >>> recording = dataclasses.replace(recording, contacts=flags)  # doctest: +SKIP
    """
    wide, found = max(2, round(WINDOW * recording.sample_rate)), {}
    for link in links:
        rotation, place = link_placement(leg, recording, link)
        smooth = scipy.ndimage.uniform_filter1d(place, wide, axis=0, mode="nearest")
        smooth = scipy.ndimage.uniform_filter1d(smooth, wide, axis=0, mode="nearest")
        turning = np.einsum("nij,nj->ni", np.gradient(rotation, recording.time, axis=0), rotation[:, 2])
        velocity = np.gradient(smooth, recording.time, axis=0) - ball_radius(leg, link) * turning
        speed = np.linalg.norm(velocity, axis=1)
        noise = float(np.linalg.norm(white_noise(place))) * np.sqrt(2.0 / wide) / WINDOW
        still = speed < max(SPEED, 6.0 * noise)
        ground = np.quantile(smooth[still, 2], 0.02) if still.any() else np.inf
        down = still & (smooth[:, 2] < ground + HEIGHT)
        found[link] = np.asarray(scipy.ndimage.binary_opening(down, np.ones(wide, dtype=np.bool_)))
    return found
