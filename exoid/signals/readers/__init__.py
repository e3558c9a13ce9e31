"""Log file formats: readers that turn each format into a table of named columns."""

from .by_ending import READERS, register_format
from .kinds import open_table
from .loggers import LOGGERS
from .opensim import TRANSLATIONS
from .table import QUANTITIES, ArrayTable, ReadOptions, Table, header_in
from .text import BASE_POSITION, PAYLOAD, WRENCH, TextTable, read_text_table

__all__ = [
    "BASE_POSITION",
    "LOGGERS",
    "PAYLOAD",
    "QUANTITIES",
    "READERS",
    "TRANSLATIONS",
    "WRENCH",
    "ArrayTable",
    "ReadOptions",
    "Table",
    "TextTable",
    "header_in",
    "open_table",
    "read_text_table",
    "register_format",
]
