"""Log file formats: readers that turn each format into a table of named columns."""

from .by_ending import READERS, register_format
from .kinds import open_table
from .table import QUANTITIES, ArrayTable, ReadOptions, Table
from .text import TextTable, read_text_table

__all__ = [
    "QUANTITIES",
    "READERS",
    "ArrayTable",
    "ReadOptions",
    "Table",
    "TextTable",
    "open_table",
    "read_text_table",
    "register_format",
]
