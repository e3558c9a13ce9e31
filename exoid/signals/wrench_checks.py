"""Checks of a wrench's units, by the sizes that a leg can have."""

from __future__ import annotations

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError


def refuse_wrong_units(force: FloatArray, moment: FloatArray, point: FloatArray, axes: str) -> None:
    """Refuse forces, moments and points of a size that only another unit explains."""
    # The line of a force f with moment m is |f × m| / |f|² from the point. Its median, over the samples with at least
    # half of the largest force, is centimetres on a foot: 1000 times as much in N·mm, or with a force in kN.
    size = np.linalg.norm(force, axis=1)
    largest = float(size.max(initial=0.0))
    if largest > 2e4:  # a runner of 150 kg has 5 kN
        raise UnreadableInputError(
            f"a wrench has a force of {largest:.4g} N in row {int(size.argmax())} (limit 20000 N)",
            remedy="give forces in N; a file's unit is given by exoid.signals.Column(..., unit='mN')",
            command="give its unit: --column wrench_<link>_fz=HEADER:mN, and so for x and y",
        )
    moments = np.linalg.norm(moment, axis=1)
    if moments.max(initial=0.0) > 2e4:  # 1 kN that is 10 m from the origin of the laboratory has 10 kN·m
        raise _moment_error(
            f"a wrench has a moment of {moments.max():.4g} N·m in row {int(moments.argmax())} (limit 20000 N·m)"
        )
    away = np.linalg.norm(np.atleast_2d(point), axis=1).max(initial=0.0)
    farthest = {"link": 5.0, "world": 100.0}[axes]
    if away > farthest:
        raise UnreadableInputError(
            f"the point of a wrench is {away:.4g} m from the origin of its axes (limit {farthest:g} m)",
            remedy="give the point in m",
        )
    if largest < 0.2:  # it has no line: a plate in kN reads at least as much under a wearer
        return
    loaded = size >= 0.5 * largest
    arm = np.linalg.norm(np.cross(force[loaded], moment[loaded]), axis=1) / size[loaded] ** 2
    if (middle := float(np.median(arm))) > 20.0:
        raise _moment_error(
            f"the force of a wrench acts {middle:.4g} m from its point (median), with up to {largest:.4g} N"
        )


def _moment_error(what: str) -> UnreadableInputError:
    return UnreadableInputError(
        f"{what}: moments look like N·mm, or forces like kN",
        remedy="give forces in N and moments in N·m; a file's unit is given by exoid.signals.Column(..., unit='N·mm')",
        command="give their units: --column wrench_<link>_mx=HEADER:N·mm, or --column wrench_<link>_fx=HEADER:kN, and "
        "so for the others",
    )
