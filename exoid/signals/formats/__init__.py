"""Kinds of log files: each becomes a table of named columns, whatever it looks like on disk."""

from .kinds import open_table
from .table import QUANTITIES, ArrayTable, ReadOptions, Table
from .text import TextTable, read_text_table

__all__ = ["QUANTITIES", "ArrayTable", "ReadOptions", "Table", "TextTable", "open_table", "read_text_table"]
