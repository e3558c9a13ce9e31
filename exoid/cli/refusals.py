"""Options that have no effect, and files that cannot be read."""

from __future__ import annotations

import stat
from collections.abc import Mapping
from pathlib import Path

from exoid.errors import BadArgumentError, UnreadableInputError


def refuse(options: Mapping[str, object], why: str) -> None:
    """Refuse options that have no effect."""
    for option, value in options.items():
        if value is not None:
            raise BadArgumentError(f"{option} has no effect: {why}", remedy=f"leave out {option}")


def is_readable(name: str) -> bool:
    """Tell whether a name is that of a file."""
    try:
        return stat.S_ISREG(Path(name).stat().st_mode)
    except (FileNotFoundError, NotADirectoryError, ValueError):
        return False
    except OSError as problem:
        raise unreadable(name, problem) from None


def unreadable(name: str, problem: Exception) -> UnreadableInputError:
    """Make the error about a file that the system does not let read."""
    reason = getattr(problem, "strerror", None) or str(problem)
    return UnreadableInputError(f"cannot be read ({reason})", where=name, remedy="check the path and its rights")
