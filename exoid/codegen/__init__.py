"""A leg with known parameters as C, for a microcontroller that runs neither Python nor Pinocchio."""

from .dialect import PRECISIONS, Dialect
from .forms import JointInC, Place, register_c_form
from .planar_leg import c_source, write_c
from .source import CSource

__all__ = [
    "PRECISIONS",
    "CSource",
    "Dialect",
    "JointInC",
    "Place",
    "c_source",
    "register_c_form",
    "write_c",
]
