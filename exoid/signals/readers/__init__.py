"""Log file formats: readers that turn each format into a table of named columns."""

from .by_ending import READERS, register_format
from .kinds import open_table
from .options import ReadOptions, ReadRequest
from .table import ArrayTable, Table
from .text import TextTable

__all__ = [
    "READERS",
    "ArrayTable",
    "ReadOptions",
    "ReadRequest",
    "Table",
    "TextTable",
    "open_table",
    "register_format",
]
