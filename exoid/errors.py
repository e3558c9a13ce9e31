"""Errors that exoid raises for invalid input: one root, four kinds, the evidence as attributes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from copy import copy


class ExoidError(Exception):
    """Invalid input, or input that cannot give a reliable result.

    Args:
        what: The error, with evidence such as the value found and the values allowed.
        where: File, row, column, joint or parameter concerned; "" for ``file``, or if ``what`` names it.
        remedy: Action that corrects the input.
        command: The same for a user of the command line, where that differs from Python.
        parameters: Names of the parameters concerned.
        joints: Names of the joints concerned.
        file: Name of the file concerned.
        column: Name of the column concerned.

    Example:
        >>> str(ExoidError("no column 'q_knee'", where="log.csv", remedy="pass columns={'q_knee': ...}"))
        "log.csv: no column 'q_knee'. To fix it: pass columns={'q_knee': ...}"
    """

    def __init__(
        self,
        what: str,
        *,
        where: str = "",
        remedy: str = "",
        command: str = "",
        parameters: tuple[str, ...] = (),
        joints: tuple[str, ...] = (),
        file: str = "",
        column: str = "",
    ) -> None:
        super().__init__(what)
        self.what = what
        self.where = where or file
        self.remedy = remedy
        self.command = command
        self.parameters = parameters
        self.joints = joints
        self.file = file
        self.column = column

    def __str__(self) -> str:
        """Write one line."""
        return self._line(self.remedy)

    def for_command(self) -> str:
        """Write one line for the command line.

        Returns:
            The line, with the remedy as an option of a command where there is one.
        """
        return self._line(self.command or self.remedy)

    def within(self, part: str) -> ExoidError:
        """Add the part of the input that the error is in.

        Args:
            part: Name of the part, such as a file or a group of recordings; "" adds nothing.

        Returns:
            The error of the same kind with the part before its place.
        """
        inside = copy(self)
        inside.where = ", ".join(filter(None, (part, self.where)))
        return inside

    def _line(self, remedy: str) -> str:
        text = f"{self.where}: {self.what}" if self.where else self.what
        return " ".join((f"{text}. To fix it: {remedy}" if remedy else text).split())


class UnreadableInputError(ExoidError):
    """A file or table that cannot be read: its form, a column, a unit, time stamps, or values in it."""


class NotIdentifiableError(ExoidError):
    """Recordings that do not determine what is asked for; ``parameters`` names what is missing."""


class NotSupportedError(ExoidError):
    """A combination of features that exoid does not have; the remedy names what does it instead."""


class BadArgumentError(ExoidError):
    """An argument out of its range, of the wrong shape, or in conflict with another one."""


def nearest(name: str, names: Iterable[str]) -> str:
    """Begin the remedy for a misspelt name with the closest one: "did you mean 'coulomb'? ", or "" if none is close."""
    from difflib import get_close_matches  # noqa: PLC0415 - rarely needed
    from pathlib import PurePath  # noqa: PLC0415

    word = str(name).lower()
    ending = PurePath(word).suffix  # that both have it makes names of files no more alike
    known = {each.lower().removesuffix(ending): each for each in names}
    close = get_close_matches(word.removesuffix(ending), list(known), n=1)
    return f"did you mean {known[close[0]]!r}? " if close else ""


@contextmanager
def in_file(file: str) -> Iterator[None]:
    """Name a file in errors that are raised inside, unless they name one."""
    try:
        yield
    except ExoidError as error:
        if error.file or not file:
            raise
        named = error if error.where.startswith(file) else error.within(file if file.isprintable() else repr(file))
        named.file = file
        raise named from error.__cause__


@contextmanager
def within(part: str) -> Iterator[None]:
    """Name a file, group, joint or table in errors that are raised inside."""
    try:
        yield
    except ExoidError as error:
        raise error.within(part) from error
