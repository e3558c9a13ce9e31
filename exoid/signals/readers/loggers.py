"""Logs of actuators whose public code defines the columns: headers and units of Dephy ActPacks, moteus and OpenExo.

* ``dephy``: fields of DephyInc/Actuator-Package, ``Python/flexsea/flexsea/dev_spec/ActPackState.py`` at commit 1b035be,
  as ``Device.read`` returns them. Counts, degrees and milliamperes are those of neurobionics/opensourceleg,
  ``opensourceleg/actuators/dephy.py`` at commit 002120f. ``ank_vel`` is not read: public programs disagree on its unit.
* ``moteus``: names of registers as mjbots/moteus, ``lib/python/examples/csv_output.py`` at commit 4496cc9 writes them;
  units of ``docs/protocol/registers.md`` at commit 17fbf26.
* ``openexo``: files of naubiomech/OpenExo, ``Python_GUI/MainWindow.py`` at commit 0e9b70b: ``epoch``, ``mark`` and the
  titles of ``ExoCode/src/PlottingTitles.h`` (0bff1c5, ca74efe). Ankle angles are in degrees as the range of motion in
  ``SDCard/config.ini`` (185eb8c) that scales them. Log: ``Python_GUI/Saved_Data/trial_20260226_151930.csv`` (e8cefd0).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from exoid.errors import UnreadableInputError

from .options import ReadRequest
from .table import ArrayTable, Table
from .text import TextTable


@dataclass(frozen=True)
class Logger:
    """Program that logs one actuator in a file."""

    name: str  # name for `format="name:joint"`
    time: tuple[str, float]  # header of the time stamps, and seconds per unit
    # header and factor to SI, by quantity of exoid's column. A file may lack any but those of `marks`
    columns: Mapping[str, tuple[str, float]]
    marks: frozenset[str]  # headers by which a file is recognised
    repeats: bool = False  # whether its clock is coarser than its rows. Of rows with one stamp the first is read


def _openexo(name: str, torque: str) -> Logger:
    """Logger of OpenExo's program, by the title of the torque that is read. Titles have one ankle angle, of no side."""
    clock, angle = "Exoskeleton time (seconds)", "Ankle Angle"
    columns = {"q": (angle, math.radians(1.0)), "tau": (torque, 1.0)}
    return Logger(name, (clock, 1.0), columns, frozenset({"epoch", "mark", clock, angle, torque}), repeats=True)


LOGGERS = {
    logger.name: logger
    for logger in (
        Logger(
            "dephy",
            ("state_time", 1e-3),
            {
                "q": ("ank_ang", 2.0 * math.pi / 16384),
                "qm": ("mot_ang", 2.0 * math.pi / 16384),
                "i": ("mot_cur", 1e-3),
                "temp": ("temperature", 1.0),
            },
            frozenset({"state_time", "mot_ang", "mot_cur", "ank_ang"}),
        ),
        Logger(
            "moteus",
            ("time", 1.0),
            {
                "q": ("POSITION", 2.0 * math.pi),
                "v": ("VELOCITY", 2.0 * math.pi),
                "tau": ("TORQUE", 1.0),
                "i": ("Q_CURRENT", 1.0),
                "temp": ("MOTOR_TEMPERATURE", 1.0),
            },
            frozenset({"time", "MODE", "POSITION", "TORQUE"}),
        ),
        _openexo("openexo", "Measured Torque"),
        _openexo("openexo-left", "Measured Torque (L)"),
        _openexo("openexo-right", "Measured Torque (R)"),
    )
}
"""Loggers by name."""


def in_si(table: Table, request: ReadRequest) -> Table:
    """Turn the log of an actuator into exoid's columns, where the caller names the format or the header shows it."""
    # A header shows it where no columns are mapped and no column is exoid's own.
    asked = request.get("format")
    if not isinstance(table, TextTable):
        if asked is None:
            return table
        raise UnreadableInputError(
            f"the format {asked!r} is that of a text file",
            remedy="leave it out: this file says what it is",
            command="leave out --format",
        )
    if asked is None and (request.get("columns") or any(name.startswith("q_") for name in table.header)):
        return table
    name, _, joint = (asked or "").partition(":")
    if asked is not None and name not in LOGGERS:
        raise UnreadableInputError(
            f"no format {name!r}", remedy=f"use one of {', '.join(LOGGERS)}, with a joint: moteus:knee"
        )
    logger = _recognised(table) if asked is None else LOGGERS[name]
    if logger is None:
        return table
    missing = sorted(logger.marks - set(table.header))
    if missing:
        raise UnreadableInputError(
            f"no column {', '.join(missing)} of the format {logger.name!r}",
            remedy="leave out the format, and map the columns",
            command="leave out --format, and map the columns with --column",
        )
    return _converted(table, logger, joint.strip() or _only_joint(table, logger, request))


def _recognised(table: Table) -> Logger | None:
    """Logger whose headers the file has; None if there is none."""
    found = [each for each in LOGGERS.values() if each.marks <= set(table.header)]
    if len(found) > 1:
        names = " or ".join(each.name for each in found)
        raise UnreadableInputError(
            f"the header is that of {names}",
            remedy=f'name one, with the joint: format="{found[0].name}:ankle"',
            command=f"name one, with the joint: --format {found[0].name}:ankle",
        )
    return found[0] if found else None


def _only_joint(table: Table, logger: Logger, request: ReadRequest) -> str:
    """Joint of the actuator where the format does not say it: the only one that is requested."""
    requested = request.get("joint_names")
    if requested is not None and not isinstance(requested, str) and len(requested) == 1:
        return requested[0]
    raise UnreadableInputError(
        f"a log of one actuator ({logger.name}) whose joint is not named",
        remedy=f'name the joint: format="{logger.name}:knee"',
        command=f"name the joint: --format {logger.name}:knee",
    )


def _converted(table: Table, logger: Logger, joint: str) -> ArrayTable:
    header, second = logger.time
    found = {f"{quantity}_{joint}": each for quantity, each in logger.columns.items() if each[0] in table.header}
    headers = [header, *(each for each, _ in found.values())]
    numbers = table.numbers(headers) * np.array([second, *(factor for _, factor in found.values())])
    lines = table.lines
    if logger.repeats:
        first = np.diff(numbers[:, 0], prepend=-np.inf) != 0.0
        numbers, lines = numbers[first], None if lines is None else lines[first]
    columns = dict(zip(("time", *found), numbers.T, strict=True))
    return ArrayTable(table.file, table.source, columns, lines, table.row_name)
