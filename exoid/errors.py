"""Error that exoid raises for invalid input."""

from __future__ import annotations


class ExoidError(Exception):
    """Invalid input, or input that cannot give a reliable result.

    Args:
        what: The error, with evidence such as the value found and the values allowed.
        where: File, row, column, joint or parameter concerned; "" if ``what`` names it.
        remedy: Action that corrects the input.
        command: The same for a user of the command line, where that differs from Python.

    Example:
        >>> str(ExoidError("no column 'q_knee'", where="log.csv", remedy="pass columns={'q_knee': ...}"))
        "log.csv: no column 'q_knee'. To fix it: pass columns={'q_knee': ...}"
    """

    def __init__(self, what: str, *, where: str = "", remedy: str = "", command: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.where = where
        self.remedy = remedy
        self.command = command

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
            The error with the part before its place.
        """
        where = ", ".join(filter(None, (part, self.where)))
        return ExoidError(self.what, where=where, remedy=self.remedy, command=self.command)

    def _line(self, remedy: str) -> str:
        text = f"{self.where}: {self.what}" if self.where else self.what
        return " ".join((f"{text}. To fix it: {remedy}" if remedy else text).split())
