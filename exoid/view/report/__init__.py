"""Self-contained HTML pages about results, and figures of a paper from their pictures."""

from .identification import identification_report
from .interaction import interaction_report
from .parameters import comparison_figures

__all__ = ["comparison_figures", "identification_report", "interaction_report"]
