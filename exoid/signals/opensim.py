"""A trial of a gait laboratory in OpenSim's files: joint angles, pose of the pelvis and ground reaction forces."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import scipy  # its parts load when they are first used

from exoid.errors import UnreadableInputError, in_file

from . import timebase
from .base_motion import BaseMotion
from .base_pose import turn_upright
from .column import Column
from .joined import in_order
from .opensim_forces import UP, read_opensim_forces
from .readers import ReadOptions, Table
from .readers.formats import kind_of, open_table
from .recording import Recording

if TYPE_CHECKING:
    from typing_extensions import Unpack

PELVIS_TURNS = ("pelvis_tilt", "pelvis_list", "pelvis_rotation")
"""Angles of the pelvis in the order of gait2392 and its successors: about z, then the new x, then the new y."""

PELVIS_PLACES = ("pelvis_tx", "pelvis_ty", "pelvis_tz")
"""Position of the pelvis in the laboratory [m]."""


def read_opensim(
    path: str | os.PathLike[str],
    columns: Mapping[str, str | Column] | None,
    *,
    joint_names: Sequence[str] | None = None,
    forces: str | os.PathLike[str] | None = None,
    links: Mapping[str, str] | None = None,
    pelvis: bool = True,
    **options: Unpack[ReadOptions],
) -> Recording:
    """Read a trial: joint angles, and if given torques, the base motion of the pelvis and the wrenches on the feet.

    Args:
        path: Kinematics, a ``.mot`` or ``.sto`` file. Other logs are read as :meth:`exoid.Recording.from_file` does.
        columns: Column of the file for each of exoid's, such as ``{"q_hip": "hip_flexion_r"}``. Use ``Column("...",
            scale=-1.0)`` where the leg counts an angle the other way round.
        joint_names: See :meth:`exoid.Recording.from_csv`.
        forces: File of ground reaction forces, of any rate on the same clock; see :func:`read_opensim_forces`.
        links: Link that stands on each plate of ``forces``, such as ``{"1": "right_foot"}``.
        pelvis: Whether the base moves with the pelvis if the file has its columns.
        **options: Options of :class:`exoid.signals.ReadOptions` for the kinematics; ``beside`` names other files of the
            trial, such as torques by inverse dynamics, and ``base_position`` is that of the pelvis' origin.

    Returns:
        The recording.

    Raises:
        ExoidError: A file cannot be read, its data fail a check, or forces and links are not both given.

    Example:
        >>> read_opensim(
        ...     "walk_ik.mot",
        ...     {"q_right_knee": Column("knee_angle_r", scale=-1.0), "tau_right_knee": "knee_angle_r_moment"},
        ...     beside=["walk_id.sto"],
        ...     forces="walk_grf.mot",
        ...     links={"1": "right_foot"},
        ... )  # doctest: +SKIP
    """
    if (forces is None) != (not links):
        raise UnreadableInputError(
            "forces and links belong together",
            remedy='say which link stands on each plate: forces="grf.mot", links={"1": "right_foot"}',
        )
    given = (columns or {}).get("time", "time")
    stamps = Column(given) if isinstance(given, str) else given  # of all files: their clock is the same
    table, place = None, None
    if pelvis and kind_of(Path(path)) in ("mot", "sto"):
        with in_file(os.fsdecode(path)):
            table = open_table(path)
            if any(name in table.header for name in PELVIS_TURNS + PELVIS_PLACES):
                place = options.pop("base_position", None) or (0.0, 0.0, 0.0)
    recording = Recording.from_file(path, joint_names, columns, **options)
    if table is not None and place is not None and recording.base is None:
        with in_file(os.fsdecode(path)):
            base = read_pelvis(table, recording, place, stamps, split=options.get("gaps") == "split")
            recording = replace(recording, base=base)
    if forces is not None and links:
        found = read_opensim_forces(forces)
        recording = replace(found, time=stamps.read("time", found.time)).attached_to(recording, links)
    return recording


def read_pelvis(
    table: Table, recording: Recording, place: Sequence[float], stamps: Column, *, split: bool
) -> BaseMotion:
    """Read the motion of a base with the pelvis; that of a planar model neither lists, rotates nor goes sideways."""
    # With tilt α, list β and rotation γ of gait2392 and its successors, in OpenSim's axes (x forward, y up, z right),
    # R = Rz(α) Rx(β) Ry(γ).
    names = (stamps.header, *PELVIS_TURNS, *PELVIS_PLACES)
    absent = [name for name in names if name not in table.header]
    if absent and sorted(absent) != ["pelvis_list", "pelvis_rotation", "pelvis_tz"]:  # those of a planar model
        raise UnreadableInputError(
            f"no column {', '.join(map(repr, absent))}, but others of the pelvis",
            remedy="export all six (of a planar model pelvis_tilt, pelvis_tx and pelvis_ty), or pass pelvis=False",
            command="export all six (of a planar model pelvis_tilt, pelvis_tx and pelvis_ty), or delete the others",
        )
    there = [name for name in names if name in table.header]
    numbers = np.zeros((len(table), 7))
    numbers[:, [names.index(name) for name in there]] = table.numbers(there)
    numbers[:, 0] = stamps.read("time", numbers[:, 0])
    numbers = in_order(numbers, names, table, split=split)
    time, position, degrees = numbers[:, 0], numbers[:, 4:], PELVIS_TURNS[0] in table.in_degrees
    turns = scipy.spatial.transform.Rotation.from_euler("ZXY", numbers[:, 1:4], degrees=degrees)
    upright = scipy.spatial.transform.Rotation.from_matrix(turn_upright(np.array(UP)))
    position, rotation = upright.apply(position), upright * turns * upright.inv()
    grid = time
    if not timebase.is_uniform(time):
        grid = timebase.even_grid(time, timebase.sampling_rate(time))
        position = timebase.interpolate(time, position, grid, smooth=True)
        rotation = scipy.spatial.transform.Slerp(time, rotation)(grid)
    base = BaseMotion.from_pose(position, rotation.as_quat(), grid, at=place)
    return base if np.array_equal(grid, recording.time) else base.interpolated(grid, recording.time)
