"""A leg with known parameters, or a control law, as C for a microcontroller that runs neither Python nor Pinocchio."""

from .dialect import Dialect
from .forms import JointInC, register_c_form
from .law_in_c import MOTION, REFERENCE, ArrayInC, InputInC, LawInC
from .ros2 import write_ros2
from .safety import Safety
from .source import CSource
from .write import c_source, write_c

__all__ = [
    "MOTION",
    "REFERENCE",
    "ArrayInC",
    "CSource",
    "Dialect",
    "InputInC",
    "JointInC",
    "LawInC",
    "Safety",
    "c_source",
    "register_c_form",
    "write_c",
    "write_ros2",
]
