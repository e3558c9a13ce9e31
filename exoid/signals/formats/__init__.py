"""Kinds of log files: each becomes a table of named columns, whatever it looks like on disk."""

from .by_ending import READERS, register_format
from .kinds import open_table
from .table import QUANTITIES, ArrayTable, Table, Wanted
from .text import TextTable, read_text_table

__all__ = [
    "QUANTITIES",
    "READERS",
    "ArrayTable",
    "Table",
    "TextTable",
    "Wanted",
    "open_table",
    "read_text_table",
    "register_format",
]
