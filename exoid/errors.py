"""The one error that exoid raises for bad input."""

from __future__ import annotations


class ExoidError(Exception):
    """Input that cannot give a trustworthy answer: says what is wrong, where, and what to do.

    Args:
        what: What is wrong, with the evidence (values, what exists instead).
        where: File, row, column, joint or parameter concerned; empty when ``what`` says it all.
        remedy: What the caller can do about it.

    Example:
        >>> str(ExoidError("no column 'q_knee'", where="log.csv", remedy="pass columns={'q_knee': ...}"))
        "log.csv: no column 'q_knee'. To mend it: pass columns={'q_knee': ...}"
    """

    def __init__(self, what: str, *, where: str = "", remedy: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.where = where
        self.remedy = remedy

    def __str__(self) -> str:
        """One line, whatever the pieces contain."""
        text = f"{self.where}: {self.what}" if self.where else self.what
        if self.remedy:
            text = f"{text}. To mend it: {self.remedy}"
        return " ".join(text.split())
