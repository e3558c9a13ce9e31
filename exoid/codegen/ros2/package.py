"""Files of a package for ROS 2 around the C of a law: fills the templates of this folder."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from exoid._version import __version__
from exoid.codegen.dialect import identifier
from exoid.codegen.laws import LawInC, LawSource
from exoid.codegen.laws.safety import per_joint
from exoid.codegen.laws.write import ABSURD, describe_safety
from exoid.codegen.templates import fill
from exoid.errors import ExoidError
from exoid.tools.tables import to_text

SCHEMA = "exoid-ros2-package-1"

DISTRIBUTION = "Jazzy"
"""Distribution of ROS 2 whose interfaces the C++ uses."""

KINDS = {"q_d": "position", "v_d": "velocity", "a_d": "acceleration"}
"""Reference interface of each input of a law that is one number for each joint."""

TIME = "time"
"""Input that is the time since the reference began; it comes last."""

CHANNELS = {"position": "positions", "velocity": "velocities", "acceleration": "accelerations"}
"""Field of a trajectory point for each kind of reference."""

COMMAND = "torque to hold until the next step"
"""What a law gives that commands torque."""

TEMPLATES = {
    "CMakeLists.txt": "CMakeLists.txt",
    "README.md": "README.md",
    "config/controllers.yaml": "controllers.yaml",
    "include/{p}/controller.hpp": "controller.hpp",
    "include/{p}/joint_state_node.hpp": "joint_state_node.hpp",
    "include/{p}/law.hpp": "law.hpp",
    "include/{p}/messages.hpp": "messages.hpp",
    "package.xml": "package.xml",
    "plugin.xml": "plugin.xml",
    "src/controller.cpp": "controller.cpp",
    "src/joint_state_main.cpp": "joint_state_main.cpp",
    "src/joint_state_node.cpp": "joint_state_node.cpp",
}
"""Template of each file."""


@dataclass(frozen=True, eq=False, repr=False)
class Ros2Package:
    """A package for ROS 2; prints itself.

    Attributes:
        name: Name of the package.
        files: Text of each file by its path inside the folder.
        source: The law in C.
        folder: Folder that was written; None if none was.
    """

    name: str
    files: dict[str, str]
    source: LawSource
    folder: Path | None = None

    def to_json(self) -> dict[str, Any]:
        """Describe the package as JSON data.

        Returns:
            Name, distribution, hash of every file, and the description of the law.
        """
        return {
            "schema": SCHEMA,
            "package": self.name,
            "distribution": DISTRIBUTION,
            "files": {name: hashlib.sha256(text.encode()).hexdigest() for name, text in self.files.items()},
            "law": self.source.to_json(),
        }

    def __repr__(self) -> str:
        """Name the package."""
        return f"Ros2Package({self.name!r})"

    def __str__(self) -> str:
        """Print package, law, and what was not run."""
        law = self.source.law
        return to_text(
            f"{self.folder or self.name}: package {self.name} for ROS 2 {DISTRIBUTION}, {law.equation}",
            f"controller {self.name}/Controller and program {self.name}_node, {law.rate:g} times a second",
            f"joints: {', '.join(law.joints)}",
            "the C++ is tested against stub headers: it was not built with ROS 2, see README.md",
            *(f"warning: {warning}" for warning in self.source.warnings),
        )


def package_name(folder: str | Path) -> str:
    """Turn a folder's name into the name of a package, which is also the prefix of the C."""
    return identifier(Path(folder).resolve().name).lower()


def ros2_package(source: LawSource) -> Ros2Package:
    """Write the files of a package around a law in C, as texts.

    Args:
        source: The law, whose prefix is the name of the package.

    Returns:
        The files.

    Raises:
        ExoidError: The law commands no torque, needs an input that ROS 2 has no interface for, or has a rate that is no
            whole number; or a joint has a name that cannot stand in ROS 2.
    """
    law, name = source.law, source.prefix
    _refuse(law)
    values = {**_values(source), "equation": law.equation}
    files = {
        path.format(p=name): fill(f"ros2/{template}.jinja", source.dialect, **values)
        for path, template in TEMPLATES.items()
    }
    include = f'#include "{source.header_name}"'
    files[f"include/{name}/{source.header_name}"] = source.header
    files[f"src/{name}.c"] = source.source.replace(include, f'#include "{name}/{source.header_name}"')
    return Ros2Package(name, dict(sorted(files.items())), source)


def _refuse(law: LawInC) -> None:
    """Refuse what has no form in ROS 2, by name."""
    if law.gives != COMMAND:
        raise ExoidError(
            f"it gives the {law.gives}, which no drive must follow",
            remedy="write a control law for ROS 2; an observer has a form in C (--c)",
        )
    for each in law.inputs:
        if each.name not in (*KINDS, TIME) or each.scalar != (each.name == TIME):
            raise ExoidError(
                f"the law needs {each.name} ({each.what}), for which ROS 2 has no standard interface",
                remedy="write it as C (--c), and call it in a controller of your own",
            )
    if law.rate != round(law.rate):
        raise ExoidError(f"a rate of {law.rate:g} Hz: ros2_control takes whole numbers", remedy="choose another rate")
    for joint in law.joints:
        if not re.fullmatch(r"[A-Za-z0-9_.-]+", joint):
            raise ExoidError(
                f"{joint!r} is no name of a joint in ROS 2", remedy="rename the joint: letters, digits, _, . and -"
            )


def _values(source: LawSource) -> dict[str, Any]:
    """Values of the templates."""
    law, name = source.law, source.prefix
    inputs = [each.name for each in law.inputs]
    arrays = [each for each in inputs if each != TIME]
    kinds = [KINDS[each] for each in arrays]
    limits = np.minimum(per_joint(law.limit, "limit", len(law.joints)), ABSURD)
    return {
        "p": name,
        "P": name.upper(),
        "space": f"{name}_ros2",
        "real": f"{name}_real",
        "version": __version__,
        "rate": round(law.rate),
        "joints": law.joints,
        "references": inputs,
        "arrays": arrays,
        "kinds": kinds,
        "channels": CHANNELS,
        "fields": [CHANNELS[kind] for kind in kinds],
        "timed": TIME in inputs,
        "interfaces": list(_interfaces(law, kinds, TIME in inputs)),
        "limits": [repr(float(limit)) for limit in limits],
        "limit_text": ", ".join("none" if x >= ABSURD else f"{x:g} N·m" for x in limits),
        "patience": source.safety.steps(law.rate),
        "safety": describe_safety(source.safety, law),
    }


def _interfaces(law: LawInC, kinds: list[str], timed: bool) -> Iterator[str]:
    """Names of the reference interfaces."""
    yield from (f"{joint}/{kind}" for kind in kinds for joint in law.joints)
    if timed:
        yield TIME
