"""Log file formats: readers that turn each format into a table of named columns."""

from .options import ReadOptions, ReadRequest
from .table import Table

__all__ = ["ReadOptions", "ReadRequest", "Table"]
