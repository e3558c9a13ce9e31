"""A law as a package for ROS 2."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from exoid.codegen.laws import Safety
from exoid.codegen.ros2 import Ros2Package, ros2_package, write_folder
from exoid.codegen.ros2.package import package_name
from exoid.control.observers import TorqueObserver
from exoid.control.stateful import AnyLaw

from .write import c_source


def write_ros2(
    folder: str | os.PathLike[str],
    law: AnyLaw | TorqueObserver,
    *,
    precision: str = "double",
    safety: Safety | None = None,
    provenance: Sequence[str] = (),
    warnings: Sequence[str] = (),
) -> Ros2Package:
    """Write a law as a package for ROS 2: a chainable controller of ros2_control, and a node.

    Args:
        folder: Folder to write, whole or not at all; its name is that of the package. An existing folder is replaced
            only if it is empty or an earlier export that was not changed.
        law: A law with or without memory that has a form in C; see :func:`register_law_in_c`.
        precision: "double" or "float".
        safety: Watchdog and safe torque; None for damping and 50 ms.
        provenance: Lines on the origin of the model, for the comment.
        warnings: Warnings about the model, for the result.

    Returns:
        The files that were written.

    Raises:
        ExoidError: The law has no form in C or ROS 2, or the folder cannot be written or has other files.
    """
    name = package_name(Path(folder))
    source = c_source(law, precision=precision, name=name, safety=safety, provenance=provenance, warnings=warnings)
    package = ros2_package(source)
    write_folder(folder, package.files)
    return replace(package, folder=Path(folder))
