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

from collections.abc import Mapping, Sequence

from exoid.errors import UnreadableInputError
from exoid.signals.column import Column

from .options import ReadOptions
from .table import Table

COUNT = 1.0 / 16384  # revolutions of Dephy's encoders
CLOCK = "Exoskeleton time (seconds)"

LOGGERS: Mapping[str, Mapping[str, Column]] = {
    "dephy": {
        "time": Column("state_time", unit="ms"),
        "q": Column("ank_ang", COUNT, unit="rev"),
        "qm": Column("mot_ang", COUNT, unit="rev"),
        "i": Column("mot_cur", unit="mA"),
        "temp": Column("temperature", unit="°C"),
    },
    "moteus": {
        "time": Column("time", unit="s"),
        "q": Column("POSITION", unit="rev"),
        "v": Column("VELOCITY", unit="rev/s"),
        "tau": Column("TORQUE", unit="N·m"),
        "i": Column("Q_CURRENT", unit="A"),
        "temp": Column("MOTOR_TEMPERATURE", unit="°C"),
    },
    **{
        name: {"time": Column(CLOCK), "q": Column("Ankle Angle", unit="deg"), "tau": Column(torque, unit="N·m")}
        for name, torque in (
            ("openexo", "Measured Torque"),
            ("openexo-left", "Measured Torque (L)"),
            ("openexo-right", "Measured Torque (R)"),
        )
    },
}
"""Columns of each logger by quantity of exoid's column; a file may lack any but those of :data:`MARKS`."""

MARKS: Mapping[str, frozenset[str]] = {
    "dephy": frozenset({"state_time", "mot_ang", "mot_cur", "ank_ang"}),
    "moteus": frozenset({"time", "MODE", "POSITION", "TORQUE"}),
    **{name: frozenset({"epoch", "mark", *(c.header for c in LOGGERS[name].values())}) for name in [*LOGGERS][2:]},
}
"""Headers by which a file is recognised."""


def with_logger(
    table: Table,
    joint_names: Sequence[str] | None,
    columns: Mapping[str, str | Column],
    options: ReadOptions,
) -> tuple[Mapping[str, str | Column], ReadOptions]:
    """Add the columns of an actuator's logger, where the caller names the format or the header shows it."""
    # A header shows it where no columns are mapped and no column is exoid's own.
    asked, is_text = options.get("format"), table.row_name == "line"
    if asked is not None and not is_text:
        raise UnreadableInputError(
            f"the format {asked!r} is that of a text file",
            remedy="leave it out: this file says what it is",
            command="leave out --format",
        )
    if asked is None and (not is_text or columns or any(name.startswith("q_") for name in table.header)):
        return columns, options
    name, _, joint = (asked or "").partition(":")
    if asked is not None and name not in LOGGERS:
        raise UnreadableInputError(
            f"no format {name!r}", remedy=f"use one of {', '.join(LOGGERS)}, with a joint: moteus:knee"
        )
    name = name or _recognised(table)
    if not name:
        return columns, options
    missing = sorted(MARKS[name] - set(table.header))
    if missing:
        raise UnreadableInputError(
            f"no column {', '.join(missing)} of the format {name!r}",
            remedy="leave out the format, and map the columns",
            command="leave out --format, and map the columns with --column",
        )
    joint = joint.strip()
    if not joint and joint_names is not None and not isinstance(joint_names, str) and len(joint_names) == 1:
        joint = joint_names[0]
    if not joint:
        raise UnreadableInputError(
            f"a log of one actuator ({name}) whose joint is not named",
            remedy=f'name the joint: format="{name}:knee"',
            command=f"name the joint: --format {name}:knee",
        )
    own = {
        "time" if quantity == "time" else f"{quantity}_{joint}": column
        for quantity, column in LOGGERS[name].items()
        if column.header in table.header
    }
    if own["time"].header == CLOCK:  # coarser than the rows, so that some stamps repeat
        options = {"gaps": "split", **options}
    return {**own, **columns}, options


def _recognised(table: Table) -> str:
    """Name of the logger whose headers the file has; "" if there is none."""
    found = [name for name, marks in MARKS.items() if marks <= set(table.header)]
    if len(found) > 1:
        raise UnreadableInputError(
            f"the header is that of {' or '.join(found)}",
            remedy=f'name one, with the joint: format="{found[0]}:ankle"',
            command=f"name one, with the joint: --format {found[0]}:ankle",
        )
    return found[0] if found else ""
