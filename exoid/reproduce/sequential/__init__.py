"""The documents' sequential identification: one function a step, uncertainty carried from each into the next."""

from . import bleex, cuhk
from .known import Known

__all__ = ["Known", "bleex", "cuhk"]
