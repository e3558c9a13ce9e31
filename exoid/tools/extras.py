"""Packages of exoid's extras, which some features need."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, requires
from typing import Any

from exoid.errors import NotSupportedError


def install_extra(extra: str) -> str:
    """Command that installs the packages of an extra, such as ``pip install 'mujoco>=3.3'``."""
    # Their names work however exoid was installed; "exoid[ground]" only from an index that has exoid.
    try:
        every = [one.replace('"', "'").partition(";") for one in requires("exoid") or ()]
    except PackageNotFoundError:  # a source tree
        every = []
    packages = [package.strip() for package, _, marker in every if f"extra == '{extra}'" in marker]
    return " ".join(["pip install", *map(repr, packages or [f"exoid[{extra}]"])])


def require_mujoco() -> Any:  # noqa: ANN401 - a module
    """Import MuJoCo, an extra of exoid."""
    try:
        import mujoco  # noqa: PLC0415 - an extra
    except ImportError:
        raise NotSupportedError("MuJoCo is not installed", remedy=install_extra("ground")) from None
    return mujoco
