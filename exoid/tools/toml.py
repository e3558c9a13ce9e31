"""Files of settings that a person writes, in TOML."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from exoid.errors import UnreadableInputError

from .files import read_bounded

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

BARE = re.compile("[A-Za-z0-9_-]+")
"""Key that needs no quotes."""

parse_toml = tomllib.loads


def read_toml(path: Path, example: str) -> dict[str, Any]:
    """Read a file; the example says what to write."""
    remedy = f"write {example}"
    try:  # nobody writes more than 1 MB by hand, and its content takes hundreds of times as much
        content = read_bounded(path, 2**20, f"give the path of a TOML file; {remedy}")
        data = tomllib.loads(content.decode("utf-8-sig"))
        _refuse_long_integers(data)
    except (ValueError, RecursionError) as error:  # also not UTF-8
        raise UnreadableInputError(f"not TOML ({error})", file=str(path), remedy=remedy) from None
    return data


def _refuse_long_integers(value: Any) -> None:  # noqa: ANN401 - any value of a file
    """Refuse integers that TOML does not have, though Python does: no float holds those of 400 digits."""
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        raise ValueError("an integer of more than 64 bits")
    for each in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        _refuse_long_integers(each)


def to_toml(data: Mapping[str, Any]) -> str:
    """Write values and tables, each key in a line; values come before tables."""
    plain = [f"{_key(name)} = {_value(value)}\n" for name, value in data.items() if not isinstance(value, Mapping)]
    tables = [
        f"[{_key(name)}]\n" + "".join(f"{_key(key)} = {_value(each)}\n" for key, each in table.items())
        for name, table in data.items()
        if isinstance(table, Mapping)
    ]
    return "\n".join(filter(None, ["".join(plain), *tables]))


def _key(name: str) -> str:
    return name if BARE.fullmatch(name) else _text(name)


def _value(value: Any) -> str:  # noqa: ANN401 - any value of a file
    """Write a value in one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return _text(value) if isinstance(value, str) else repr(value)


def _text(text: str) -> str:
    """Write a text as a basic string of TOML, which JSON's are but for one character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
