"""Actuators as TOML files, beside the URDF of the leg."""

from __future__ import annotations

import os
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from exoid.errors import in_file
from exoid.leg.leg import Leg
from exoid.tools.files import write_whole
from exoid.tools.toml import read_toml, to_toml

from .actuators import Actuators
from .drive_data import actuators_from_data, actuators_to_data

BUILT_IN = {"bleex": "bleex.toml"}
"""Files of exoid, by name: the cylinders of BLEEX, whose attachment points are assumed."""

EXAMPLE = '[left_hip] and below it type = "motor" …'


def read_actuators(path: str | os.PathLike[str], leg: Leg) -> Actuators:
    """Read the drives of a leg from a TOML file.

    A table for each joint, and for each coupling by any name, has the key ``type`` and the arguments of the drive:

    * ``type = "motor"``: ``torque_constant``, ``ratio``, ``efficiency``, … of :class:`exoid.actuators.Motor`;
    * ``type = "linear"``: ``first`` and ``second``, each ``{ link = "thigh", point = [x, y, z] }`` [m]; or ``angle``
      (``angle_deg``) and ``moment_arm`` [m];
    * ``type = "series-elastic"``: ``stiffness`` and ``ratio``;
    * ``type = "coupling"``: ``joints`` and ``matrix``.

    Args:
        path: The file, which may be one for ``--columns``, or "bleex" for the assumed cylinders of BLEEX.
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
    with in_file(str(name)):
        return actuators_from_data(read_drive_tables(str(name)), leg)


def write_actuators(actuators: Actuators, path: str | os.PathLike[str]) -> None:
    """Write the drives of a leg to a TOML file, which :func:`read_actuators` reads.

    Args:
        actuators: The actuators.
        path: The file; an existing one is replaced only when the new one is complete.

    Raises:
        ExoidError: A drive is not of exoid, or the file cannot be written.
    """
    write_whole(path, [to_toml(actuators_to_data(actuators))])


def read_drive_tables(name: str) -> Mapping[str, Any]:
    """Read the tables of a file, or of a built-in one where no file has its name."""
    if name in BUILT_IN and not Path(name).is_file():
        with resources.as_file(resources.files(__package__).joinpath(BUILT_IN[name])) as path:
            return read_toml(path, EXAMPLE)
    content = read_toml(Path(name), EXAMPLE)
    tables: Mapping[str, Any] = content.get("actuators", content)
    return tables
