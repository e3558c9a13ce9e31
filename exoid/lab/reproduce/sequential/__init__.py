"""Sequential identification of both documents: one function a step, with propagation of the uncertainty."""

from . import bleex, cuhk
from .estimate import SequentialEstimate

__all__ = ["SequentialEstimate", "bleex", "cuhk"]
