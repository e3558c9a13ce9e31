"""Plans as files: motions for the controller of a rig, and static poses."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import BadArgumentError
from exoid.experiments.limits import refuse_poses_beyond_limits
from exoid.experiments.static import StaticProtocol
from exoid.leg.leg import Leg
from exoid.signals.csv_writer import write_csv

from .plan import Plan
from .stance import StancePlan


def write_plan(path: str | os.PathLike[str], plan: Plan | StancePlan) -> tuple[Path, ...]:
    """Write motions as ``time, q_<joint>, v_<joint>, a_<joint>, tau_<joint>`` at the rate of the plan, and poses."""
    # tau is the expected torque. With several torso tilts or supports each motion has its own file,
    # `plan_tilt+20.csv` or `plan_both.csv`. Poses are written to `plan_poses.csv`.
    files = plan_files(path, plan.labels, poses=bool(plan.poses))
    for file, recording in zip(files, plan.recordings, strict=False):
        recording.to_csv(file)
    for file, poses in zip(files[len(plan.motions) :], plan.poses, strict=True):
        write_static_protocol(file, plan.model.leg, poses.q, StaticProtocol().distance)
    return files


def plan_files(path: str | os.PathLike[str], labels: Sequence[str], *, poses: bool = False) -> tuple[Path, ...]:
    """Name the files of a plan; refuse a name under which it cannot be written."""
    path = Path(path)
    if path.suffix != ".csv":
        raise BadArgumentError("a plan in no table", file=str(path), remedy="name the file .csv")
    if not os.path.isdir(path.parent):  # noqa: PTH112 - no error if a folder cannot be read
        raise BadArgumentError(f"there is no folder {path.parent}", file=str(path), remedy="create it, or use another")
    ends = [f"_{label}" for label in labels] if len(labels) > 1 else [""]
    return tuple(path.with_name(f"{path.stem}{kind}{end}.csv") for kind in ("", "_poses")[: 1 + poses] for end in ends)


def write_static_protocol(path: str | os.PathLike[str], leg: Leg, poses: ArrayLike, distance: float) -> None:
    """Write poses to approach from both sides: ``pose, approach, start_<joint>, q_<joint>`` [rad]."""
    refuse_poses_beyond_limits(leg, poses)
    if not 0.0 < distance < np.inf:
        raise BadArgumentError(f"a distance of {distance:g} rad", remedy="pass a positive distance")
    angles = np.repeat(np.asarray(poses, dtype=np.float64), 2, axis=0)
    number = np.repeat(np.arange(len(angles) // 2), 2)
    side = np.tile([1.0, -1.0], len(angles) // 2)
    start = np.clip(angles - side[:, None] * distance, leg.limits.lower, leg.limits.upper)
    write_csv(
        path,
        ["pose", "approach", *(f"{quantity}_{name}" for quantity in ("start", "q") for name in leg.joint_names)],
        np.column_stack([number, side, start, angles]),
    )
