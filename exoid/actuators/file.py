"""Actuators as TOML files, beside the URDF of the leg."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from exoid.errors import UnreadableInputError, within
from exoid.leg.leg import Leg
from exoid.tools.files import write_whole

from .actuators import Actuators
from .drive_data import actuators_from_data, actuators_to_data

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

BARE = re.compile("[A-Za-z0-9_-]+")
"""Key that needs no quotes in TOML."""

BUILT_IN = {"bleex": "bleex.toml"}
"""Files of exoid, by name: the cylinders of BLEEX, whose attachment points are assumed."""


def read_actuators(path: str | os.PathLike[str], leg: Leg) -> Actuators:
    """Read the drives of a leg from a TOML file.

    A table for each joint, and for each coupling by any name, has the key ``type`` and the arguments of the drive:

    * ``type = "motor"``: ``torque_constant``, ``ratio``, ``efficiency``, … of :class:`exoid.actuators.Motor`;
    * ``type = "linear"``: ``first`` and ``second``, each ``{ link = "thigh", point = [x, y, z] }`` [m]; or ``angle``
      (``angle_deg``) and ``moment_arm`` [m];
    * ``type = "series-elastic"``: ``stiffness`` and ``ratio``;
    * ``type = "coupling"``: ``joints``, ``matrix``, and ``motors`` if currents are logged.

    Args:
        path: The file, or "bleex" for the assumed cylinders of BLEEX.
        leg: The leg.

    Returns:
        The actuators.

    Raises:
        ExoidError: The file cannot be read or is not TOML, a table has a wrong key or value, or a drive does not fit
            the leg: names file, table and key.

    Example:
        >>> read_actuators("bleex", exoid.load_leg("bleex")).units
        ('N', 'N', 'N')
    """
    name = os.fspath(path)
    with within(str(name)):
        return actuators_from_data(_content(str(name)), leg)


def write_actuators(actuators: Actuators, path: str | os.PathLike[str]) -> None:
    """Write the drives of a leg to a TOML file, which :func:`read_actuators` reads.

    Args:
        actuators: The actuators.
        path: The file; an existing one is replaced only when the new one is complete.

    Raises:
        ExoidError: A drive is not of exoid, or the file cannot be written.
    """
    write_whole(path, ["\n".join(_lines(actuators_to_data(actuators)))])


def _content(name: str) -> Mapping[str, Any]:
    """Content of a file, or of a built-in one where no file has its name."""
    try:
        if name in BUILT_IN and not Path(name).is_file():
            text = resources.files(__package__).joinpath(BUILT_IN[name]).read_text(encoding="utf-8")
        else:
            text = Path(name).read_text(encoding="utf-8")
    except (OSError, ValueError) as error:  # a name with a null character, not UTF-8
        reason = getattr(error, "strerror", None) or str(error)
        raise UnreadableInputError(
            f"cannot be read ({reason})", remedy=f"give the path of a TOML file, or {', '.join(BUILT_IN)}"
        ) from None
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise UnreadableInputError(
            f"not TOML ({error})", remedy='write [left_hip] and below it type = "motor" …'
        ) from None


def _lines(data: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    for name, table in data.items():
        yield f"[{name if BARE.fullmatch(name) else _text(name)}]"
        yield from (f"{key} = {_value(value)}" for key, value in table.items())
        yield ""


def _value(value: Any) -> str:  # noqa: ANN401 - any value of a file
    """Write a value in one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return _text(value) if isinstance(value, str) else repr(value)


def _text(text: str) -> str:
    """Write a text as a basic string of TOML, which JSON's are but for one character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
