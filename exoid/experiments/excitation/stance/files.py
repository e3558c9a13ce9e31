"""Plans of motions on the ground as files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from exoid.experiments.excitation.plan_files import refuse_plan_name

from .plan import StancePlan


def write_stance_plan(path: str | os.PathLike[str], plan: StancePlan) -> tuple[Path, ...]:
    """Write motions as ``time, q_, v_, a_, tau_`` of each joint and ``contact_`` of each foot."""
    # tau is the expected torque. With several supports each motion has its own file, `plan_both.csv`.
    files = stance_files(path, [support.name for support in plan.supports])
    for file, recording in zip(files, plan.recordings, strict=True):
        recording.to_csv(file)
    return files


def stance_files(path: str | os.PathLike[str], supports: Sequence[str]) -> tuple[Path, ...]:
    """Name the files of a plan."""
    path = refuse_plan_name(path)
    if len(supports) == 1:
        return (path,)
    return tuple(path.with_name(f"{path.stem}_{name}.csv") for name in supports)
