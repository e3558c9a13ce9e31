"""Options that have no effect, and files that cannot be read."""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping
from pathlib import Path

from exoid.errors import BadArgumentError, UnreadableInputError, nearest


def refuse(options: Mapping[str, object], why: str) -> None:
    """Refuse options that have no effect."""
    for option, value in options.items():
        if value is not None:
            raise BadArgumentError(f"{option} has no effect: {why}", remedy=f"leave out {option}")


FORMS = (
    (b"<", "XML, such as a URDF", "LEG"),
    (b"{", "JSON, such as an estimate", "EST.JSON"),
    (b"%PDF", "a PDF", ""),
    (b"PK\x03\x04", "a spreadsheet", ""),
    (b"\x89PNG", "a picture", ""),
)
"""First bytes of files that are no tables, what they are, and the argument that they may have been meant for."""


def refuse_form(name: str, argument: str) -> None:
    """Refuse a file that cannot be the LEG or LOG that it was given as, before its content is blamed."""
    start = b""
    if is_readable(name):
        try:
            with Path(name).open("rb") as file:
                start = file.read(4000)
        except OSError as problem:
            raise unreadable(name, problem) from None
    found = [each for each in FORMS if start.lstrip(b"\xef\xbb\xbf \r\n\t").startswith(each[0])]
    _, form, meant = found[0] if found else (b"", "not XML", "LOG")
    if not start or meant == argument or (form == "a spreadsheet" and b"Content_Types" not in start):
        return
    if argument == "LEG":
        raise BadArgumentError(f"is {form}, and no URDF", where=name, remedy="name the leg's URDF here, then the logs")
    remedy = f"name a table here, after {meant}" if meant else "export its table as CSV"
    raise BadArgumentError(f"is {form}, and no log", where=name, remedy=f"{remedy}: time, q_<joint>, tau_<joint>")


def refuse_missing(name: str) -> None:
    """Refuse a file that is not there, before seconds pass in imports of what reads it."""
    if Path(name).suffix not in ("", ".urdf") and not os.path.lexists(name):  # refuse_unknown_leg knows more of URDFs
        usual = "give the file that exoid identify -o wrote" if name.endswith(".json") else "check the path"
        remedy = f"{nearest(Path(name).name, names_beside(name))}{usual}"
        raise UnreadableInputError("no such file", where=name, remedy=remedy)


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


def names_beside(name: str) -> list[str]:
    """Names of the files in the folder of a file that was not found."""
    try:
        return [each.name for each in Path(name).parent.iterdir()]
    except (OSError, ValueError):
        return []
