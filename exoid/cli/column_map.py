"""``--columns LAB.TOML``: columns and options of a laboratory's logs, written once."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path
from typing import Any

from exoid.errors import BadArgumentError, within
from exoid.tools.files import write_whole
from exoid.tools.toml import read_toml, to_toml

from .options import LogOptions

COLUMNS = "columns"
"""Table of exoid's columns and the headers of the file; all other keys are options of logs."""

EXAMPLE = '[columns] and below it q_hip = "pos1:deg", tau_hip = "current:0.118"'


def with_map(options: LogOptions, path: str) -> LogOptions:
    """Read a file of columns; what the command line says goes before it."""
    with within(path):
        content = read_toml(Path(path), EXAMPLE)
        headers = content.pop(COLUMNS, {})
        if not isinstance(headers, dict) or not all(isinstance(header, str) for header in headers.values()):
            raise BadArgumentError("columns are no table of headers", remedy=f"write {EXAMPLE}")
        found = {key.replace("-", "_"): value for key, value in content.items()}
        for key, value in found.items():
            _refuse_wrong(key, value)
    own = {pair.partition("=")[0].strip() for pair in options.column or ()}
    pairs = [*(options.column or ()), *(f"{name}={header}" for name, header in headers.items() if name not in own)]
    usual = LogOptions._field_defaults
    kept = {key: value for key, value in found.items() if getattr(options, key) == usual[key]}
    return options._replace(**kept, column=pairs or None)


def _refuse_wrong(key: str, value: Any) -> None:  # noqa: ANN401 - any value of a file
    """Refuse a key that is no option of logs, and a value of another kind."""
    known = [name for name in LogOptions._fields if name not in (COLUMNS, "column")]
    if key not in known:
        close = get_close_matches(key, known, n=1)
        nearest = f"did you mean {close[0]!r}? " if close else ""
        raise BadArgumentError(f"no option {key!r} of logs", remedy=f"{nearest}options are {', '.join(known)}")
    is_list = key in ("payload", "wrench")
    kind: Any = str
    wanted = "a list of texts" if is_list else "a text in quotes"
    if LogOptions._field_defaults[key] is False:
        kind, wanted = bool, "true or false"
    elif key in ("start", "stop"):
        kind, wanted = int | float, "a number"
    items = value if is_list and isinstance(value, list) else [value]
    if is_list != isinstance(value, list) or not all(isinstance(each, kind) for each in items):
        raise BadArgumentError(f"{key} is {value!r}", remedy=f"give {wanted}")


def save_map(options: LogOptions, path: str) -> None:
    """Write the options of a call as a file of columns."""
    usual = LogOptions._field_defaults
    said = {key: value for key, value in options._asdict().items() if value != usual[key]}
    pairs = said.pop("column", None) or ()
    said.pop(COLUMNS, None)
    headers = {name.strip(): header.strip() for name, _, header in (pair.partition("=") for pair in pairs)}
    write_whole(path, [to_toml({**said, COLUMNS: headers})])
