"""Checks of a wrench's units, by the sizes that a leg can have."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import ExoidError

LARGEST_FORCE = 2e4
"""Largest plausible force on a link [N]; a runner of 150 kg has 5 kN."""

LARGEST_MOMENT = 2e4
"""Largest plausible moment [N·m]; 1 kN that is 10 m from the origin of the laboratory has 10 kN·m."""

FARTHEST = {"link": 5.0, "world": 100.0}
"""Largest distance of the point from the origin of the axes [m]."""

LONGEST_ARM = 20.0
"""Largest median distance of the line of force from the point [m]."""

SMALLEST_FORCE = 0.2
"""Largest force of a log below which it has no line [N]: a plate in kN reads at least as much under a wearer."""


def refuse_wrong_units(force: FloatArray, moment: FloatArray, point: FloatArray, axes: str) -> None:
    """Refuse forces, moments and points of a size that only another unit explains."""
    # The line of a force f with moment m is |f × m| / |f|² from the point. Its median, over the samples with at least
    # half of the largest force, is centimetres on a foot: 1000 times as much in N·mm, or with a force in kN.
    size = np.linalg.norm(force, axis=1)
    largest = float(size.max(initial=0.0))
    if largest > LARGEST_FORCE:
        raise ExoidError(
            f"a wrench has a force of {largest:.4g} N in row {int(size.argmax())} (limit {LARGEST_FORCE:g} N)",
            remedy="give forces in N; a file's unit is given by exoid.signals.Column(..., unit='mN')",
            command="give its unit: --column wrench_<link>_fz=HEADER:mN, and so for x and y",
        )
    moments = np.linalg.norm(moment, axis=1)
    if moments.max(initial=0.0) > LARGEST_MOMENT:
        raise _moment_error(
            f"a wrench has a moment of {moments.max():.4g} N·m in row {int(moments.argmax())} "
            f"(limit {LARGEST_MOMENT:g} N·m)"
        )
    away = np.linalg.norm(np.atleast_2d(point), axis=1).max(initial=0.0)
    if away > FARTHEST[axes]:
        raise ExoidError(
            f"the point of a wrench is {away:.4g} m from the origin of its axes (limit {FARTHEST[axes]:g} m)",
            remedy="give the point in m",
        )
    if largest < SMALLEST_FORCE:
        return
    loaded = size >= 0.5 * largest
    arm = np.linalg.norm(np.cross(force[loaded], moment[loaded]), axis=1) / size[loaded] ** 2
    if (middle := float(np.median(arm))) > LONGEST_ARM:
        raise _moment_error(
            f"the force of a wrench acts {middle:.4g} m from its point (median), with up to {largest:.4g} N"
        )


def _moment_error(what: str) -> ExoidError:
    return ExoidError(
        f"{what}: moments look like N·mm, or forces like kN",
        remedy="give forces in N and moments in N·m; a file's unit is given by exoid.signals.Column(..., unit='N·mm')",
        command="give their units: --column wrench_<link>_mx=HEADER:N·mm, or --column wrench_<link>_fx=HEADER:kN, and "
        "so for the others",
    )
