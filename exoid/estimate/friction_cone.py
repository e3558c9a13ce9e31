"""Feet that are said to stand, and whose force no ground bears: it leaves all friction cones, or pulls."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.signals.contacts import LEAST_LOAD
from exoid.signals.link_wrenches import link_placements
from exoid.signals.moving_base import vertical
from exoid.torques.contacts.kinds import foot_of
from exoid.torques.contacts.stretches import Stretch

from .data import EstimateData
from .finding import Finding
from .ground_prediction import level_axes, level_wrench, stretch_forces
from .ground_validation import Ground

STEEPEST = 1.2
"""Force along the ground over force on it that no sole holds: rubber on dry concrete slips at 0.6 to 1."""

SHARE, LASTING = 0.02, 0.1
"""Part of the time of a foot on the ground, and time [s], from which on forces outside of the cone are a finding."""


def cone_findings(estimate: EstimateData, stretches: Iterable[Stretch]) -> Iterator[Finding]:
    """Find feet whose force, estimated or measured, leaves the cone |f − n f·n| ≤ 1.2 f·n beyond its 95 % band."""
    # Such a force is eliminated like any other, so that no residual shows what holds the foot. Bands without the noise
    # of the motion cost a quarter. They are narrower: a foot that is within its cone by them is so by the whole ones.
    stretches = tuple(stretches)
    if not _held(estimate, stretches, noise=False):
        return
    for foot, part in _held(estimate, stretches, noise=True).items():
        text = (
            f"in {part:.1%} of the time in which {foot} is said to stand, its force leaves the friction "
            f"cone of any sole ({STEEPEST:g} times the normal force, upwards): it is held, or slips"
        )
        remedy = "check its contact, the signs of torques, and what else touches it"
        yield Finding("friction-cone", "", part, "1", "warning", text, remedy)


def _held(estimate: EstimateData, stretches: Iterable[Stretch], *, noise: bool) -> dict[str, float]:
    """Find the feet whose force leaves the cone for too long, each with the part of its time on the ground."""
    seconds = defaultdict[str, FloatArray](lambda: np.zeros(2))
    for stretch in stretches:
        for foot, outside in _outside(estimate, stretch, noise=noise):
            seconds[foot] += np.array([np.count_nonzero(outside), len(outside)]) / stretch.recording.sample_rate
    return {
        foot: float(beyond / down) for foot, (beyond, down) in seconds.items() if beyond > max(LASTING, SHARE * down)
    }


def _outside(estimate: EstimateData, stretch: Stretch, *, noise: bool) -> Iterator[tuple[str, BoolArray]]:
    """Tell for each foot at which of its samples in contact its force is outside of the cone."""
    leg, recording = estimate.model.leg, stretch.recording
    assert recording.mask is not None
    rows = np.flatnonzero(recording.mask)
    q, up = recording.q[rows], vertical(recording)[rows]
    held = {*stretch.links} & {leg.description.root_link, *recording.wrenches}
    feet = [] if held or recording.tau is None or not recording.measured.all() else stretch.links
    ground = Ground([stretch]) if noise else None
    found = dict(zip(feet, stretch_forces(estimate, ground, stretch, feet), strict=True)) if feet else {}
    for foot, wrench in recording.wrenches.items():
        found[foot] = level_wrench(leg, recording.q, foot, wrench, rows)
    for foot, force in found.items():
        parts = [flags for link, flags in recording.contacts.items() if foot in (link, foot_of(leg, link))]
        down = np.logical_or.reduce([flags[rows] for flags in parts]) if parts else np.zeros(len(rows), dtype=np.bool_)
        to_base = link_placements(leg, q, foot).rotation @ np.swapaxes(level_axes(leg, q, foot), 1, 2)
        of_base, seen = np.einsum("nij,nj->ni", to_base, force.force), np.isfinite(force.force_half)
        half = np.linalg.norm(np.where(seen, force.force_half, 0.0), axis=1)
        normal = np.einsum("ni,ni->n", of_base, up)
        along = np.linalg.norm(of_base - normal[:, np.newaxis] * up, axis=1)
        # a planar leg does not tell the force to its side
        known = (seen.sum(axis=1) > (1 if leg.limbs else 2)) & (np.linalg.norm(of_base, axis=1) > half + LEAST_LOAD)
        yield foot, (known & (along - half > STEEPEST * (normal + half)))[down]
