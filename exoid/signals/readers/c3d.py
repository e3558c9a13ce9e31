"""Force plates of a C3D file, read by ezc3d in a child process. Its markers are no joint angles."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import numpy as np

from exoid._typing import FloatArray
from exoid.errors import UnreadableInputError
from exoid.signals.quantities import factor_of, spelled
from exoid.signals.wrench import Wrench
from exoid.tools.reader_process.bounds import MOST_EXPANSION, reading
from exoid.tools.reader_process.child import Content, read_in_child

from .table import needs

REMEDY = "export the forces for OpenSim (.mot), or correct plates and units in the laboratory's software"


def read_c3d_plates(file: str, forward: str) -> tuple[FloatArray, dict[str, Wrench]]:
    """Time stamps, and the wrench of each plate on the foot, about its middle: ``forward`` becomes x, up is z."""
    if find_spec("ezc3d") is None:
        raise needs("ezc3d", "C3D")
    size = Path(file).stat().st_size if Path(file).is_file() else 0  # its objects, not what a damaged file claims
    content, wrenches = read_in_child(c3d_plates, file, beside=2**25 + MOST_EXPANSION * size), {}
    for plate in map(str, range(1, content.facts["plates"] + 1)):
        force, moment, corners = (content.arrays[f"{what} {plate}"] for what in ("force", "moment", "corners"))
        turn = _turn(corners, forward, plate)
        vertical = force @ turn[2]
        if (peak := float(vertical[np.abs(vertical).argmax()])) < -20.0:  # N; an empty plate has noise of both signs
            raise UnreadableInputError(f"plate {plate} pulls by {-peak:.0f} N: it has the force on it", remedy=REMEDY)
        wrenches[plate] = Wrench(force @ turn.T, moment @ turn.T, turn @ corners.mean(axis=0), axes="world")
    return content.arrays["time"], wrenches


def c3d_plates(file: str) -> Content:
    """Read forces, moments and corners of all plates in the axes of the laboratory, in this process."""
    import ezc3d  # noqa: PLC0415 - an extra

    with reading("C3D", "check that the file is complete; export it again"):
        trial = ezc3d.c3d(file)
        given, header = trial["parameters"], trial["header"]
        plates, first = given["FORCE_PLATFORM"], header["points"]["first_frame"]
        count, length = int(plates["USED"]["value"][0]), given["POINT"]["UNITS"]["value"][0]
        scale = factor_of(length, "wrench_p")
        units = [text for name in ("UNITS", "UNITS2") for text in given["ANALOG"].get(name, {}).get("value", ())]
        wrong = [] if count and trial["data"]["analogs"].size else ["it has no force plates, or no sample of them"]
        if first:
            wrong.append(f"it begins at frame {first + 1}, and programs differ in its time 0")
        for plate in range(count if scale else 0):
            kind = int(plates["TYPE"]["value"][plate])  # type 4 does not say the units behind its matrix
            expected = {2: ["N"] * 3 + [f"N{spelled(length)}"] * 3, 3: ["N"] * 8}.get(kind, [])
            found = [units[k - 1] for k in plates["CHANNEL"]["value"][: len(expected), plate]]
            if not found or list(map(spelled, found)) != expected:
                wrong.append(f"plate {plate + 1} of type {kind} has channels in {found}, positions in {length}")
        if wrong or scale is None:
            what = "; ".join(wrong) or f"positions are in {length!r}"
            raise UnreadableInputError(f"plates that are not read: {what}", remedy=REMEDY)
        arrays = {}
        for number, plate in enumerate(ezc3d.c3d(file, extract_forceplat_data=True)["data"]["platform"], 1):
            arrays[f"force {number}"] = plate["force"].T
            arrays[f"moment {number}"] = scale * plate["moment"].T  # ezc3d has moved it to the middle of the top
            arrays[f"corners {number}"] = scale * plate["corners"].T
        time = np.arange(len(arrays["force 1"])) / header["analogs"]["frame_rate"]
        return Content({"time": time, **arrays}, {"plates": count})


def _turn(corners: FloatArray, forward: str, plate: str) -> FloatArray:
    """Rotation from the laboratory to x forward, z up, (3, 3); up is against the z axis of the plate."""
    normal = np.cross(corners[0] - corners[3], corners[0] - corners[1])
    up, ahead = np.eye(3)[int(normal.argmax())], float(f"{forward[0]}1") * np.eye(3)["xyz".index(forward[1])]
    if not normal @ up > 0.9 * float(np.linalg.norm(normal)) > 1e-3:  # m²; a ramp of 25° leans as much
        raise UnreadableInputError(f"corners of plate {plate} are missing or in another order", remedy=REMEDY)
    if ahead @ up:
        raise UnreadableInputError(f"{forward} is the vertical of plate {plate}", remedy="name the forward axis")
    return np.array([ahead, np.cross(up, ahead), up])
