"""Self-contained HTML pages about results."""

from .identification import identification_report
from .page import Embedded, Page, Picture, Section, Words, picture, picture_of

__all__ = ["Embedded", "Page", "Picture", "Section", "Words", "identification_report", "picture", "picture_of"]
