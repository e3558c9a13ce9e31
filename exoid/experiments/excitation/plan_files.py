"""Plans as files: motions for the controller of a rig."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from exoid.errors import BadArgumentError

from .plan import Plan
from .stance import StancePlan


def write_plan(path: str | os.PathLike[str], plan: Plan | StancePlan) -> tuple[Path, ...]:
    """Write motions as ``time, q_<joint>, v_<joint>, a_<joint>, tau_<joint>`` at the rate of the plan."""
    # tau is the expected torque. With several torso tilts or supports each motion has its own file,
    # `plan_tilt+20.csv` or `plan_both.csv`.
    files = plan_files(path, plan.labels)
    for file, recording in zip(files, plan.recordings, strict=True):
        recording.to_csv(file)
    return files


def plan_files(path: str | os.PathLike[str], labels: Sequence[str]) -> tuple[Path, ...]:
    """Name the files of a plan; refuse a name under which it cannot be written."""
    path = Path(path)
    if path.suffix != ".csv":
        raise BadArgumentError("a plan in no table", file=str(path), remedy="name the file .csv")
    if not os.path.isdir(path.parent):  # noqa: PTH112 - no error if a folder cannot be read
        raise BadArgumentError(f"there is no folder {path.parent}", file=str(path), remedy="create it, or use another")
    return tuple(path.with_name(f"{path.stem}_{label}.csv") if len(labels) > 1 else path for label in labels)
