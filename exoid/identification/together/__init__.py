"""Several legs of one design, or several sessions, identified at once: some parameters shared, others each its own."""

from .equality import Equality
from .identify import identify_together
from .layout import Layout
from .report import together_to_json
from .result import Together

__all__ = ["Equality", "Layout", "Together", "identify_together", "together_to_json"]
