"""Ground reaction forces in files of OpenSim: wrenches on the feet in the laboratory, z up."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError, in_file

from . import timebase
from .base_pose import turn_upright
from .joined import in_order, values_at
from .readers import Table
from .readers.formats import open_table
from .recording import Recording
from .wrench import Wrench

UP = (0.0, 1.0, 0.0)
"""Direction against gravity in OpenSim: x forward, y up, z to the right."""


@dataclass(frozen=True, eq=False)
class GroundForces:
    """Wrenches of force plates by name of the plate, at time stamps of their own.

    Attributes:
        time: Time stamps [s], (K,), those of the clock of the kinematics.
        wrenches: Wrench that each plate exerts on what stands on it, in axes of the laboratory, z up.
        file: Path of the file.
    """

    time: FloatArray
    wrenches: Mapping[str, Wrench]
    file: str = ""

    def attached_to(self, recording: Recording, links: Mapping[str, str]) -> Recording:
        """Give a recording the wrenches, at its own time stamps.

        Wrenches are recorded faster than motions. Before a lower rate they pass a zero-phase low-pass at 0.4 of it, as
        impacts would alias, about one point: a centre of pressure jumps where the foot leaves the ground.

        Args:
            recording: Recording of the motion, on the same clock.
            links: Link of the leg that stands on each plate, such as ``{"1": "right_foot", "2": "left_foot"}``. Other
                plates are left out.

        Returns:
            The recording with these wrenches, beside those that it had.

        Raises:
            ExoidError: There is no such plate, a link is named twice, or the forces do not cover the recording.
        """
        with in_file(self.file):
            for plate in links:
                if plate not in self.wrenches:
                    raise UnreadableInputError(
                        f"no plate {plate!r}", remedy=f"plates of the file are {', '.join(self.wrenches)}"
                    )
            if len(set(links.values())) < len(links) or set(links.values()) & set(recording.wrenches):
                raise UnreadableInputError(
                    f"a link has two wrenches: {', '.join(links.values())}", remedy="name one link for each plate"
                )
            time, (begin, end) = recording.time, self.time[[0, -1]].tolist()
            half = 0.5 / min(timebase.sampling_rate(time), timebase.sampling_rate(self.time))
            if time[0] < begin - half or time[-1] > end + half:
                span = f"from {time[0]:g} s to {time[-1]:g} s"
                raise UnreadableInputError(
                    f"forces from {begin:g} s to {end:g} s do not cover the recording, {span}",
                    remedy="give both files of one trial, or cut the recording: recording.between(start, stop)",
                )
            own, grid = {}, np.clip(time, begin, end)
            for plate, link in links.items():
                wrench = self.wrenches[plate].about_one_point
                columns = values_at(self.time, wrench.columns, grid, smooth=False)
                own[link] = Wrench(columns[:, :3], columns[:, 3:], wrench.point, axes="world")
            return replace(recording, wrenches={**recording.wrenches, **own})

    def __repr__(self) -> str:
        return f"GroundForces({len(self.time)} samples; plates: {', '.join(self.wrenches)})"


def read_opensim_forces(path: str | os.PathLike[str]) -> GroundForces:
    """Read the ground reaction forces of a ``.mot`` or ``.sto`` file.

    Columns of a plate are ``ground_force_1_vx…z`` [N], the force on the foot, ``ground_force_1_px…z`` [m], the centre
    of pressure, and ``ground_torque_1_x…z`` [N·m], the free moment about it (``ground_moment_1_mx…z`` too; zero if
    there are none). The name of the plate may stand elsewhere (``1_ground_force_vx``, ``r_ground_force_vx``,
    ``ground_force_calcn_r_vx``) or be missing: such a plate is called "ground". OpenSim's y axis points up; here z
    does, x stays forward, and y points to the left.

    Args:
        path: The file.

    Returns:
        A wrench for each plate. Its point is the centre of pressure; one without a force may have none (NaN).

    Raises:
        ExoidError: There are no such columns, some of a plate are missing, or numbers are.
    """
    with in_file(os.fsdecode(path)):
        table = open_table(path)
        if "time" not in table.header:
            raise UnreadableInputError("no column 'time'", remedy="name the column of the time stamps 'time'")
        plates = plates_in(table)
        names = ["time", *(name for columns in plates.values() for of_part in columns.values() for name in of_part)]
        by_name = dict(zip(names, table.numbers(names).T, strict=True))
        for columns in plates.values():
            unloaded = np.all([by_name[name] == 0.0 for name in columns["force"]], axis=0)
            for name in columns["point"]:  # a plate without a force has no centre of pressure
                by_name[name] = np.where(unloaded & np.isnan(by_name[name]), 0.0, by_name[name])
        in_order(np.column_stack([by_name[name] for name in names]), names, table)
        turn, wrenches = turn_upright(np.array(UP)), {}
        for plate, columns in plates.items():
            vectors = {part: turn @ [by_name[name] for name in of_part] for part, of_part in columns.items()}
            moment = vectors.get("moment", 0.0 * vectors["force"])
            wrenches[plate] = Wrench(vectors["force"].T, moment.T, vectors["point"].T, axes="world")
        return GroundForces(by_name["time"], wrenches, table.file)


def plates_in(table: Table) -> dict[str, dict[str, list[str]]]:
    """Find the columns of force plates."""
    found: dict[str, dict[str, dict[str, str]]] = {}
    for name in table.header:
        meant = _meaning(name)
        if meant is not None:
            plate, part, axis = meant
            if axis in found.setdefault(plate, {}).setdefault(part, {}):
                raise UnreadableInputError(
                    f"{found[plate][part][axis]} and {name} are both {part} {axis} of plate {plate!r}",
                    remedy="rename one of them",
                )
            found[plate][part][axis] = name
    if not found:
        raise UnreadableInputError(
            f"no ground reaction forces; the file has: {', '.join(table.header[:20])}",
            remedy="name the columns as OpenSim does: ground_force_1_vx, ground_force_1_px, ground_torque_1_x, …",
        )
    for plate, parts in found.items():
        for part in ("force", "point", *parts):
            absent = [axis for axis in "xyz" if axis not in parts.get(part, {})]
            if absent:
                raise UnreadableInputError(
                    f"plate {plate!r} has no {part} {', '.join(absent)}",
                    remedy="export force (vx, vy, vz), centre of pressure (px, py, pz) and free moment of each plate",
                )
    return {
        plate: {part: [axes[axis] for axis in "xyz"] for part, axes in parts.items()} for plate, parts in found.items()
    }


def _meaning(name: str) -> tuple[str, str, str] | None:
    """Plate, part and axis of a column; None if it is none of a plate."""
    words, kinds = name.split("_"), {"force", "torque", "moment"}
    said, last = kinds & set(name.lower().split("_")), re.fullmatch("([vpm]?)([xyz])", words[-1].lower())
    if last is None or not said or (not last[1] and said == {"force"}):
        return None
    plate = "_".join(word for word in words[:-1] if word.lower() not in {"ground", *kinds})
    return plate or "ground", {"v": "force", "p": "point"}.get(last[1], "moment"), last[2]
