"""Self-contained HTML pages about results, and figures of a paper from their pictures."""

from .comparison import comparison_figures
from .identification import identification_report, validation_report
from .interaction import interaction_report

__all__ = ["comparison_figures", "identification_report", "interaction_report", "validation_report"]
