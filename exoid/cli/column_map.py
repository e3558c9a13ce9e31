"""``--columns LAB.TOML``: columns and options of a laboratory's logs, written once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from exoid.errors import BadArgumentError, nearest, within
from exoid.tools.files import write_whole
from exoid.tools.toml import read_toml, to_toml

from .options import LogOptions

TABLES = {"columns": "column", "plates": "plate"}
"""Option that each table of the file stands for: headers by exoid's column, links by plate."""

KEYS = (
    "degrees",
    "gaps",
    "topic",
    "received",
    "mask",
    "names",
    "format",
    "passive",
    "unmeasured",
    "base_position",
    "wrench",
)
"""Options that are those of a laboratory; others are those of one log."""

EXAMPLE = '[columns] and below it q_hip = "pos1:deg", tau_hip = "current:0.118"'


def with_map(options: LogOptions, path: str) -> LogOptions:
    """Read a file of columns; what the command line says goes before it."""
    found: dict[str, Any] = {}
    with within(path):
        for key, value in read_toml(Path(path), EXAMPLE).items():
            if key in TABLES:
                if not isinstance(value, dict) or not all(isinstance(each, str) for each in value.values()):
                    raise BadArgumentError(f"{key} is no table of texts", remedy=f"write {EXAMPLE}")
                given = getattr(options, TABLES[key]) or []
                own = {pair.partition("=")[0].strip() for pair in given}
                found[TABLES[key]] = [*given, *(f"{name}={text}" for name, text in value.items() if name not in own)]
            else:
                name = key.replace("-", "_")
                _refuse_wrong(name, value)
                if getattr(options, name) == LogOptions._field_defaults[name]:
                    found[name] = value
    return options._replace(**found)


def _refuse_wrong(key: str, value: Any) -> None:  # noqa: ANN401 - any value of a file
    """Refuse a key that is no option of a laboratory, and a value of another kind."""
    if key not in KEYS:
        keys = (*TABLES, *KEYS)
        raise BadArgumentError(f"no key {key!r}", remedy=f"{nearest(key, keys)}keys are {', '.join(keys)}")
    fits, wanted = isinstance(value, str), "a text in quotes"
    if LogOptions._field_defaults[key] is False:
        fits, wanted = isinstance(value, bool), "true or false"
    elif key == "wrench":
        fits, wanted = isinstance(value, list) and all(isinstance(each, str) for each in value), "a list of texts"
    if not fits:
        raise BadArgumentError(f"{key} is {value!r}", remedy=f"give {wanted}")


def save_map(options: LogOptions, path: str) -> None:
    """Write the options of a call that are those of a laboratory."""
    said: dict[str, Any] = {key: getattr(options, key) for key in KEYS}
    said = {key: value for key, value in said.items() if value != LogOptions._field_defaults[key]}
    for table, option in TABLES.items():
        pairs = [pair.partition("=") for pair in getattr(options, option) or ()]
        if pairs:
            said[table] = {name.strip(): text.strip() for name, _, text in pairs}
    write_whole(path, [to_toml(said)])
