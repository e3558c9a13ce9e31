"""Force plates of a C3D file, read by ezc3d in a child process. Its markers are no joint angles."""

from __future__ import annotations

from importlib.util import find_spec
from itertools import count, takewhile
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError
from exoid.signals.wrench import Wrench
from exoid.tools.reader_process.bounds import reading
from exoid.tools.reader_process.child import Content, read_in_child

from .table import needs

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
"""Units of length that a trial may have; moments are in N times it."""

CHANNELS = {2: 6, 3: 8}
"""Number of channels of each type of plate that is read: force and moment, or eight forces (Kistler)."""

EXPORT = "export the forces for OpenSim (.mot), or correct the plates in the laboratory's software"


def read_c3d_plates(file: str, forward: str) -> tuple[FloatArray, dict[str, Wrench]]:
    """Time stamps, and the wrench of each plate on the foot, about the plate's middle; an axis becomes x, z is up."""
    if find_spec("ezc3d") is None:
        raise needs("ezc3d", "C3D")
    arrays = read_in_child(c3d_plates, file).arrays
    wrenches = {}
    for plate in takewhile(lambda name: f"force {name}" in arrays, map(str, count(1))):
        force, moment, corners = (arrays[f"{what} {plate}"] for what in ("force", "moment", "corners"))
        turn = _turn(corners, forward, plate)
        vertical = force @ turn[2]
        if (peak := float(vertical[np.abs(vertical).argmax()])) < -20.0:  # N; an empty plate has noise of both signs
            raise UnreadableInputError(
                f"plate {plate} pulls the foot down by up to {-peak:.0f} N: that is the force on the plate",
                remedy=f"C3D has the force on the foot; {EXPORT}",
            )
        wrenches[plate] = Wrench(force @ turn.T, moment @ turn.T, turn @ corners.mean(axis=0), axes="world")
    return arrays["time"], wrenches


def c3d_plates(file: str) -> Content:
    """Read forces, moments and corners of all plates in the axes of the laboratory, in this process."""
    import ezc3d  # noqa: PLC0415 - an extra

    with reading("C3D", "check that the file is complete; export it again"):
        trial = ezc3d.c3d(file)
        given, header = trial["parameters"], trial["header"]
        plates = given.get("FORCE_PLATFORM", {})
        used = int(plates["USED"]["value"][0]) if "USED" in plates else 0
        if not used:
            raise UnreadableInputError("no force plates", remedy="leave out --forces, or give the trial that has them")
        if header["points"]["first_frame"]:
            raise UnreadableInputError(
                f"the trial begins at frame {header['points']['first_frame'] + 1}: programs differ in its time 0",
                remedy="save the trial from its first frame on, or export the forces for OpenSim (.mot)",
            )
        unit = (given["POINT"]["UNITS"]["value"] or [""])[0].strip()
        if unit not in METRES:
            raise UnreadableInputError(f"positions in {unit!r}, not in {', '.join(METRES)}", remedy=EXPORT)
        for plate in range(used):
            _refuse_plate(given, plate, unit)
        arrays = {}
        for name, plate in enumerate(ezc3d.c3d(file, extract_forceplat_data=True)["data"]["platform"], start=1):
            arrays[f"force {name}"] = plate["force"].T
            arrays[f"moment {name}"] = METRES[unit] * plate["moment"].T  # ezc3d has moved it to the middle of the top
            arrays[f"corners {name}"] = METRES[unit] * plate["corners"].T
        return Content({"time": np.arange(len(arrays["force 1"])) / header["analogs"]["frame_rate"], **arrays})


def _refuse_plate(given: Any, plate: int, unit: str) -> None:  # noqa: ANN401 - ezc3d has no types
    """Refuse a plate of an unknown type, or with channels in other units: ezc3d takes N and N times that of length."""
    kind = int(given["FORCE_PLATFORM"]["TYPE"]["value"][plate])
    if kind not in CHANNELS:  # type 4 does not say the unit that its matrix gives; types from 5 on have other channels
        raise UnreadableInputError(f"plate {plate + 1} is of type {kind}, not 2 or 3", remedy=EXPORT)
    units = [text.strip() for name in ("UNITS", "UNITS2") for text in given["ANALOG"].get(name, {}).get("value", ())]
    found = [units[k - 1] for k in given["FORCE_PLATFORM"]["CHANNEL"]["value"][: CHANNELS[kind], plate]]
    moments = {f"N{unit}", f"N.{unit}", f"N*{unit}", f"N·{unit}"}
    if set(found[:3]) | set(found[6:]) != {"N"} or not set(found[3:6]) <= ({"N"} if kind == 3 else moments):
        raise UnreadableInputError(
            f"plate {plate + 1} has channels in {', '.join(found)}, beside positions in {unit}",
            remedy=f"forces are in N, moments in N{unit}; {EXPORT}",
        )


def _turn(corners: FloatArray, forward: str, plate: str) -> FloatArray:
    """Rotation from the laboratory to x forward, z up, (3, 3); up is against the z axis of the plate."""
    normal = np.cross(corners[0] - corners[3], corners[0] - corners[1])
    area = float(np.linalg.norm(normal))
    up, ahead = np.zeros(3), np.zeros(3)
    up[int(normal.argmax())], ahead["xyz".index(forward[1])] = 1.0, 1.0 if forward[0] == "+" else -1.0
    if not normal @ up > 0.9 * area > 1e-3:  # m²; a ramp of 25° leans as much
        raise UnreadableInputError(f"corners of plate {plate} are missing or in another order", remedy=EXPORT)
    if ahead @ up:
        raise UnreadableInputError(
            f"{forward} is the vertical of plate {plate}", remedy="name the axis that is forward"
        )
    return np.array([ahead, np.cross(up, ahead), up])
