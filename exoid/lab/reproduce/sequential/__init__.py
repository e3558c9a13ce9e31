"""Sequential identification of both documents: one function a step, with propagation of the uncertainty."""

from . import bleex, cuhk

__all__ = ["bleex", "cuhk"]
