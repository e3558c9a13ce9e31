"""Self-contained HTML pages about results."""

from .identification import identification_report
from .interaction import interaction_report
from .page import EmbeddedPage, Page, Picture, Section, Text, draw_picture

__all__ = [
    "EmbeddedPage",
    "Page",
    "Picture",
    "Section",
    "Text",
    "draw_picture",
    "identification_report",
    "interaction_report",
]
