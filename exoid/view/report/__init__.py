"""Self-contained HTML pages about results."""

from .identification import identification_report
from .page import DataTable, Embedded, Page, Picture, Section, Words, picture

__all__ = ["DataTable", "Embedded", "Page", "Picture", "Section", "Words", "identification_report", "picture"]
