"""Check of closed loops: measured angles of dependent joints against those that the loops give."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from exoid.estimate.finding import Finding
from exoid.leg.closure import Closure
from exoid.leg.leg_data import without_side
from exoid.signals import Recording

LARGEST_GAP = 1e-3  # gap that is a finding [m], root mean square: encoders and play leave less
SAMPLES = 500  # samples of a recording that are compared, spread evenly


def loop_gaps(closure: Closure, recording: Recording) -> Iterator[Finding]:
    """Find loops that measured angles of dependent joints leave open; those of the others follow from the loops."""
    names = list(closure.model.names)[1:]
    used = names if {*closure.joint_names} <= {*recording.joint_names} else without_side(names)
    places = [recording.joint_names.index(name) if name in recording.joint_names else -1 for name in used]
    measured = [j for j in closure.dependent if places[j] >= 0]
    if not measured:
        return
    q = recording.q[:: 1 + len(recording) // SAMPLES]
    poses, closed = closure.solve(q[:, [places[j] for j in closure.independent]])
    poses[:, measured] = q[:, [places[j] for j in measured]]
    gaps = closure.gap(poses[closed])
    for loop, gap in zip(closure.loops.loops, gaps.T, strict=True):
        size, scatter = float(np.sqrt(np.mean(gap**2))), float(np.std(gap))
        if size > LARGEST_GAP:
            message = (
                f"loop {loop.name} is open by {1e3 * size:.2g} mm at the measured angles of "
                f"{', '.join(names[j] for j in measured)} ({1e3 * scatter:.1g} mm of it changes with the pose)"
            )
            remedy = "measure the points of the loop, and the zeros of these encoders; what changes may be play"
            yield Finding("loop-gap", "", size, "m", "warning", message, remedy)
