"""Plans as files: motions for the controller of a rig, and static poses."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from exoid.errors import ExoidError
from exoid.experiments.protocol_files import write_static_protocol
from exoid.experiments.static import StaticProtocol

from .plan import Plan


def write_plan(path: str | os.PathLike[str], plan: Plan) -> tuple[Path, ...]:
    """Write motions as ``time, q_<joint>, v_<joint>, a_<joint>, tau_<joint>`` at the rate of the plan, and poses."""
    # tau is the expected torque. With several torso tilts each motion has its own file, `plan_tilt+20.csv`. Poses are
    # written to `plan_poses.csv` by `exoid.experiments.write_static_protocol`.
    pitches = [motion.pitch for motion in plan.motions]
    files = plan_files(path, pitches, poses=bool(plan.poses))
    for file, recording in zip(files, plan.recordings, strict=False):
        recording.to_csv(file)
    for file, poses in zip(files[len(pitches) :], plan.poses, strict=True):
        write_static_protocol(file, plan.model.leg, poses.q, StaticProtocol().distance)
    return files


def plan_files(path: str | os.PathLike[str], pitches: Sequence[float], *, poses: bool) -> tuple[Path, ...]:
    """Name the files of a plan."""
    path = refuse_plan_name(path)
    return tuple(_named(path, kind, pitch, len(pitches)) for kind in ("", "_poses")[: 1 + poses] for pitch in pitches)


def refuse_plan_name(path: str | os.PathLike[str]) -> Path:
    """Refuse a file name under which a plan cannot be written."""
    path = Path(path)
    if path.suffix != ".csv":
        raise ExoidError(f"a plan in {path.name}", remedy="name the file .csv")
    if not os.path.isdir(path.parent):  # noqa: PTH112 - no error if a folder cannot be read
        raise ExoidError(f"there is no folder {path.parent}", where=str(path), remedy="create it, or use another")
    return path


def _named(path: Path, kind: str, pitch: float, count: int) -> Path:
    tilt = f"_tilt{np.rad2deg(pitch):+g}" if count > 1 else ""
    return path.with_name(f"{path.stem}{kind}{tilt}.csv")
