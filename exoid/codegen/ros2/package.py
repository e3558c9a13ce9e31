"""A control law as a package for ROS 2: a chainable controller and a node around its C, from the templates here."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from exoid._version import __version__
from exoid.codegen.dialect import ABSURD, Dialect, identifier
from exoid.codegen.law_in_c import LawInC, law_in_c
from exoid.codegen.law_source import law_source
from exoid.codegen.safety import Safety
from exoid.codegen.source import CSource
from exoid.codegen.templates import fill
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.leg.joint_numbers import for_joints

from .folder import write_folder

DISTRIBUTION = "Jazzy"
"""Distribution of ROS 2 whose interfaces the C++ uses."""

CHANNELS = {
    "q_d": ("position", "positions"),
    "v_d": ("velocity", "velocities"),
    "a_d": ("acceleration", "accelerations"),
}
"""Reference interface of each input of a law that is one number for each joint, and its field of a trajectory point."""

DEPENDENCIES = (
    *("controller_interface", "hardware_interface", "pluginlib", "rclcpp", "rclcpp_lifecycle", "realtime_tools"),
    *("sensor_msgs", "trajectory_msgs"),
)
"""Packages of ROS 2 that the C++ uses."""

TEMPLATES = {
    "CMakeLists.txt": "",
    "README.md": "",
    "controllers.yaml": "config/",
    "law.hpp": "include/{p}/",
    "package.xml": "",
    "plugin.xml": "",
    "controller.cpp": "src/",
    "joint_state_node.cpp": "src/",
}
"""Templates, and the folder of each file."""


def write_ros2(
    folder: str | os.PathLike[str],
    law: object,
    *,
    precision: str = "double",
    safety: Safety | None = None,
    provenance: Sequence[str] = (),
    warnings: Sequence[str] = (),
) -> CSource:
    """Write a law as a package for ROS 2: a chainable controller of ros2_control, and a node.

    Args:
        folder: Folder to write, whole or not at all; its name is that of the package. An existing folder is replaced
            only if it is empty or an earlier export that was not changed.
        law: A law with or without memory that has a form in C; see :func:`exoid.codegen.c_source`.
        precision: "double" or "float".
        safety: Watchdog and safe torque; None for damping and 50 ms.
        provenance: Lines on the origin of the model, for the comment.
        warnings: Warnings about the model, for the result.

    Returns:
        The files that were written.

    Raises:
        ExoidError: The law has no form in C or ROS 2, or the folder cannot be written or has other files.
    """
    name, dialect, safety = identifier(Path(folder).resolve().name).lower(), Dialect(precision), safety or Safety()
    form = law_in_c(law, dialect)
    _refuse(form)
    source = law_source(form, dialect, name, safety, provenance, tuple(warnings))
    values = _values(form, name, safety)
    files = {f"{place.format(p=name)}{file}": fill(f"ros2/{file}.jinja", dialect, **values)
             for file, place in TEMPLATES.items()}  # fmt: skip
    include = f'#include "{name}.h"'
    files[f"include/{name}/{name}.h"] = source.header
    files[f"src/{name}.c"] = source.text.replace(include, f'#include "{name}/{name}.h"')
    write_folder(folder, files)
    facts = {"schema": "exoid-ros2-package-1", "package": name, "distribution": DISTRIBUTION, "law": source.to_json()}
    summary = (
        f"package {name} for ROS 2 {DISTRIBUTION}, {form.equation}",
        f"controller {name}/Controller and program {name}_node, {form.rate:g} times a second",
        f"joints: {', '.join(form.joints)}",
        "the C++ is tested against stub headers: it was not built with ROS 2, see README.md",
    )
    return replace(source, files=dict(sorted(files.items())), facts=facts, summary=summary, path=Path(folder))


def _refuse(law: LawInC) -> None:
    """Refuse what has no form in ROS 2, by name."""
    if law.gives != LawInC.gives:
        what = f"it gives the {law.gives}, which no drive must follow"
        raise NotSupportedError(what, remedy="write a control law for ROS 2; an observer has a form in C (--c)")
    for each in law.inputs:
        if each.name not in CHANNELS:
            raise NotSupportedError(
                f"the law needs {each.name} ({each.what}), for which ROS 2 has no standard interface",
                remedy="write it as C (--c), and call it in a controller of your own",
            )
    if law.rate != round(law.rate):
        what = f"a rate of {law.rate:g} Hz: ros2_control takes whole numbers"
        raise BadArgumentError(what, remedy="choose another rate")
    for joint in law.joints:
        if not re.fullmatch(r"[A-Za-z0-9_.-]+", joint):
            raise BadArgumentError(
                f"{joint!r} is no name of a joint in ROS 2",
                remedy="rename the joint: letters, digits, _, . and -",
                joints=(joint,),
            )


def _values(law: LawInC, name: str, safety: Safety) -> dict[str, Any]:
    """Values of the templates."""
    inputs = [each.name for each in law.inputs]
    kinds = [CHANNELS[each][0] for each in inputs]
    limits = np.minimum(for_joints(law.limit, len(law.joints), "limit"), ABSURD)
    return {
        "p": name,
        "P": name.upper(),
        "space": f"{name}_ros2",
        "real": f"{name}_real",
        "version": __version__,
        "dependencies": DEPENDENCIES,
        "equation": law.equation,
        "rate": round(law.rate),
        "joints": law.joints,
        "references": inputs,
        "kinds": kinds,
        "channels": dict(CHANNELS.values()),
        "fields": [CHANNELS[each][1] for each in inputs],
        "interfaces": [f"{joint}/{kind}" for kind in kinds for joint in law.joints],
        "limits": [repr(float(limit)) for limit in limits],
        "limit_text": ", ".join("none" if x >= ABSURD else f"{x:g} N·m" for x in limits),
        "patience": safety.steps(law.rate),
        "safety": safety.describe(law.damping),
    }
