"""Self-contained HTML pages about results."""

from .identification import identification_report
from .interaction import interaction_report

__all__ = ["identification_report", "interaction_report"]
