"""``--columns LAB.TOML``: columns and options of a laboratory's logs, written once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import exoid
from exoid.errors import BadArgumentError, in_file, nearest
from exoid.tools.toml import read_toml

from .inputs import delays_of, drive_tables
from .legs import DATASETS
from .messages import note
from .options import LogOptions

if TYPE_CHECKING:
    from exoid.estimate import Estimate

EXAMPLE = '[columns] and below it q_hip = "pos1:deg", tau_hip = "current:0.118"'

TABLES: dict[str, tuple[str, Any, str]] = {
    "columns": ("column", str, EXAMPLE),
    "plates": ("plate", str, '[plates] and below it 1 = "right_foot"'),
    "delays": ("late", int | float, "[delays] and below it knee = 0.02, in seconds"),
}
"""Option that each table of the file stands for, kind of its values, and what to write."""

DRIVES = "actuators"
"""Tables of the drives, as in a file for ``--actuators``: ``[actuators.knee]``."""

KEYS = ("degrees", "gaps", "topic", "received", "mask", "passive", "unmeasured", "base_position", "wrench")
"""Options that are those of a laboratory; others are those of one log."""

AS_THEY_STAND = "none"
"""In place of a file: read logs as they stand, also if an estimate remembers another way."""


def with_map(options: LogOptions, path: str) -> LogOptions:
    """Read a file of columns, or what an estimate remembers; what the command line says goes before it."""
    if path == AS_THEY_STAND:
        return options
    with in_file(path):
        known = exoid.Estimate.load(path).columns if path.endswith(".json") else read_toml(Path(path), EXAMPLE)
        return _before(options, known, path)


def with_remembered(options: LogOptions, estimate: Estimate, name: str, logs: Sequence[str]) -> LogOptions:
    """Read logs like those of an estimate, unless a file of columns was given or a log is a dataset."""
    if options.actuators == options.columns and estimate.actuators is not None:
        options = options._replace(actuators=None)  # drives of an estimate have the constants that were identified
    if options.columns is not None or not estimate.columns or any(log.partition(":")[0] in DATASETS for log in logs):
        return options
    note(f"columns and units of the logs as {name} remembers them; --columns {AS_THEY_STAND} reads them as they stand")
    with in_file(name):
        return _before(options, {key: value for key, value in estimate.columns.items() if key != DRIVES})


def _before(options: LogOptions, known: Mapping[str, Any], path: str = "") -> LogOptions:
    """Put options of a command before those of a laboratory, whose file has the tables of the drives."""
    found: dict[str, Any] = {}
    for key, value in known.items():
        if key in TABLES:
            option, kind, example = TABLES[key]
            if not isinstance(value, dict) or not all(isinstance(each, kind) for each in value.values()):
                what = f"{key} is no table of {'texts' if kind is str else 'numbers'}"
                raise BadArgumentError(what, remedy=f"write {example}")
            given = getattr(options, option) or []
            own = {pair.partition("=")[0].strip() for pair in given}
            found[option] = [*given, *(f"{name}={text}" for name, text in value.items() if name not in own)]
        elif key == DRIVES:
            if not isinstance(value, dict):
                remedy = '[actuators.knee] and below it type = "motor" …, or give a file of drives to --actuators'
                raise BadArgumentError(f"{key} is {value!r}", remedy=f"write {remedy}")
            found[DRIVES] = options.actuators or path
        else:
            name = key.replace("-", "_")
            _refuse_wrong(name, value)
            if getattr(options, name) == LogOptions._field_defaults[name]:
                found[name] = value
    return options._replace(**found)


def _refuse_wrong(key: str, value: Any) -> None:  # noqa: ANN401 - any value of a file
    """Refuse a key that is no option of a laboratory, and a value of another kind."""
    if key not in KEYS:
        keys = (*TABLES, DRIVES, *KEYS)
        raise BadArgumentError(f"no key {key!r}", remedy=f"{nearest(key, keys)}keys are {', '.join(keys)}")
    fits, wanted = isinstance(value, str), "a text in quotes"
    if key == "degrees" or LogOptions._field_defaults[key] is False:
        fits, wanted = isinstance(value, bool), "true or false"
    elif key == "wrench":
        fits, wanted = isinstance(value, list) and all(isinstance(each, str) for each in value), "a list of texts"
    if not fits:
        raise BadArgumentError(f"{key} is {value!r}", remedy=f"give {wanted}")


def columns_of(options: LogOptions) -> dict[str, Any]:
    """Options of a call that are those of a laboratory."""
    said: dict[str, Any] = {k: v for k in KEYS if (v := getattr(options, k)) != LogOptions._field_defaults[k]}
    for table in ("columns", "plates"):
        if pairs := [pair.partition("=") for pair in getattr(options, TABLES[table][0]) or ()]:
            said[table] = {name.strip(): text.strip() for name, _, text in pairs}
    if delays := delays_of(options):
        said["delays"] = delays
    if options.actuators is not None:
        said[DRIVES] = drive_tables(options.actuators)
    return said
