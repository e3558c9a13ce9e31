"""Wrenches and contacts among the columns of a log."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from exoid._typing import BoolArray, FloatArray
from exoid.errors import ExoidError, UnreadableInputError

from .csv_writer import LogPart
from .external import External
from .readers import Table
from .readers.text import WRENCH
from .wrench import WRENCH_PARTS, Wrench, WrenchFrame, as_frames, frame_of_link

POINT_PARTS = ("px", "py", "pz")
"""Coordinates of a point that moves, in the laboratory [m]."""

WRENCH_COLUMN = re.compile(r"wrench_(?P<link>.+)_(?P<part>[fmp][xyz])")
"""Name of a column of a wrench, such as ``wrench_left_foot_fz``."""

WRENCH_MATRIX = re.compile(r"wrench_(?P<link>.+)\[(?P<place>[0-5])\]")
"""Name of a column of a matrix ``wrench_left_foot`` of (samples, 6)."""

CONTACT = "contact_"
"""Beginning of the name of a column of 0 and 1."""


def is_external(name: str) -> bool:
    """Tell whether a name is that of a column of a wrench or a contact."""
    return WRENCH_COLUMN.fullmatch(name) is not None or (name.startswith(CONTACT) and name != CONTACT)


def external_columns(headers: Iterable[str], file: str) -> tuple[str, ...]:
    """Find the columns of wrenches and contacts."""
    found = [name for name in headers if is_external(name)]
    for link in _links(found):
        of_link = {name for name in found if _link(name) == link}
        for parts in (WRENCH_PARTS, POINT_PARTS):
            absent = [name for part in parts if (name := f"wrench_{link}_{part}") not in of_link]
            if absent and (len(absent) < len(parts) or parts is WRENCH_PARTS):
                raise UnreadableInputError(
                    f"the wrench on {link} lacks {', '.join(absent)}",
                    where=file,
                    remedy=f"give all of {', '.join(f'wrench_{link}_{part}' for part in parts)}; a column of zeros "
                    "says that a component is none",
                    command=f"give their headers: --column {absent[0]}=HEADER",
                )
    return tuple(found)


def wrench_headers(header: Sequence[str]) -> dict[str, str]:
    """Name the columns of matrices ``wrench_<link>`` of (samples, 6)."""
    matches = [(name, match) for name in header if (match := WRENCH_MATRIX.fullmatch(name))]
    return {f"wrench_{match['link']}_{WRENCH_PARTS[int(match['place'])]}": name for name, match in matches}


def read_external(
    table: Table, columns: Mapping[str, FloatArray], frames: Mapping[str, WrenchFrame | str] | None
) -> External:
    """Make the wrenches and contacts of a log."""
    said = _said_frames(table)
    try:
        given = as_frames(frames or {})
    except ExoidError as error:
        raise UnreadableInputError(f"wrench_frames: {error.what}", remedy=error.remedy) from None
    links = _links(columns)
    for link, frame in given.items():
        if link not in links:
            raise UnreadableInputError(
                f"axes of the wrench on {link}, which the log does not have",
                where=table.file,
                remedy=f"links with a wrench are {', '.join(links) or 'none'}: name one of them",
                command=f"links with a wrench are {', '.join(links) or 'none'}; map its columns, e.g. "
                f"--column wrench_{link}_fx=HEADER, or leave out --wrench {link}:…",
            )
        if said.get(link, frame) != frame:
            raise UnreadableInputError(
                f"the file gives the wrench on {link} as {said[link]}, and not as {frame}",
                where=table.file,
                remedy="leave out wrench_frames, or correct the line '# wrench:' of the file",
                command="leave out --wrench, or correct the line '# wrench:' of the file",
            )
    return external_of(columns, {**said, **given}, table.file)


def external_of(columns: Mapping[str, FloatArray], frames: Mapping[str, WrenchFrame], file: str = "") -> External:
    """Make wrenches and contacts of columns."""
    # Without a frame, a wrench is in the axes of its link, about its origin; one whose point moves is in the
    # laboratory.
    wrenches: dict[str, Wrench] = {}
    for link in _links(columns):
        try:
            wrenches[link] = _wrench(link, columns, frames.get(link))
        except ExoidError as error:
            raise error.within(", ".join(filter(None, (file, f"wrench on {link}")))) from None
    contacts = {
        name.removeprefix(CONTACT): _contact(name, values, file)
        for name, values in columns.items()
        if name.startswith(CONTACT)
    }
    return {"wrenches": wrenches, "contacts": contacts}


def log_of_external(wrenches: Mapping[str, Wrench], contacts: Mapping[str, BoolArray]) -> LogPart:
    """Name the columns of wrenches and contacts, and write axes and points as lines above the header."""
    names: list[str] = []
    columns: list[FloatArray] = []
    comments = []
    for link, wrench in wrenches.items():
        names += [f"wrench_{link}_{part}" for part in WRENCH_PARTS]
        columns.append(wrench.columns)
        if wrench.moving_point:
            names += [f"wrench_{link}_{part}" for part in POINT_PARTS]
            columns.append(wrench.point)
        point = None if wrench.moving_point else tuple(wrench.point.tolist())
        comments.append(f"{WRENCH} {link}:{WrenchFrame(wrench.axes, point)}")
    names += [f"{CONTACT}{link}" for link in contacts]
    columns += [contact.astype(np.float64)[:, np.newaxis] for contact in contacts.values()]
    return LogPart(names, columns, comments)


def _link(name: str) -> str | None:
    match = WRENCH_COLUMN.fullmatch(name)
    return match["link"] if match else None


def _links(names: Iterable[str]) -> tuple[str, ...]:
    """Links with a wrench, each once."""
    return tuple(dict.fromkeys(link for name in names if (link := _link(name)) is not None))


def _wrench(link: str, columns: Mapping[str, FloatArray], frame: WrenchFrame | None) -> Wrench:
    values = np.column_stack([columns[f"wrench_{link}_{part}"] for part in WRENCH_PARTS])
    names = [f"wrench_{link}_{part}" for part in POINT_PARTS]
    if names[0] not in columns:
        axes, point = frame or WrenchFrame("link")
        return Wrench(values[:, :3], values[:, 3:], (0.0, 0.0, 0.0) if point is None else point, axes)  # type: ignore[arg-type]
    if frame is not None and (frame.axes != "world" or frame.point is not None):
        raise UnreadableInputError(
            f"the point of the wrench is given by columns {', '.join(names)} in the laboratory, and as {frame}",
            remedy="leave out one of both; columns of a point belong to axes world",
        )
    point_columns = np.column_stack([columns[name] for name in names])
    return Wrench(values[:, :3], values[:, 3:], point_columns, "world")


def _contact(name: str, values: FloatArray, file: str) -> BoolArray:
    if not np.isin(values, (0.0, 1.0)).all():
        first = int(np.argmax(~np.isin(values, (0.0, 1.0))))
        raise UnreadableInputError(
            f"a contact of {values[first]:.6g} in sample {first}, which is neither 0 nor 1",
            where=", ".join(filter(None, (file, f"column {name}"))),
            remedy="write 0 and 1; exoid.signals.contacts_from_switch and contacts_from_wrench find contacts of a "
            "pressure or a force",
            command="map a column of 0 and 1, or scale it by --column "
            f"{name}=HEADER:SCALE; a pressure or a force needs exoid.signals.contacts_from_switch in Python",
        )
    return values.astype(np.bool_)


def _said_frames(table: Table) -> dict[str, WrenchFrame]:
    """Axes and points that lines of a text file give."""
    found: dict[str, WrenchFrame] = {}
    for text in getattr(table, "said", {}).get(WRENCH, ()):
        try:
            link, frame = frame_of_link(text)
        except ExoidError as error:
            raise error.within(f"{table.file}, line '{WRENCH}'") from None
        if found.setdefault(link, frame) != frame:
            raise UnreadableInputError(
                f"two frames of the wrench on {link}: {found[link]} and {frame}",
                where=f"{table.file}, line '{WRENCH}'",
                remedy="write one line for each link",
            )
    return found
