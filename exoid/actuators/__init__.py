"""Drives: from measured currents, cylinder forces and motor angles to joint torque, and back to commands."""

from .actuators import Actuators
from .arm_table import MomentArmTable
from .attachments import Attachment, Attachments, MomentArm
from .coupling import Coupling, motor_terms
from .drive import Drive
from .file import read_actuators, write_actuators
from .linear import LinearActuator
from .motor import Motor
from .series_elastic import SeriesElastic

__all__ = [
    "Actuators",
    "Attachment",
    "Attachments",
    "Coupling",
    "Drive",
    "LinearActuator",
    "MomentArm",
    "MomentArmTable",
    "Motor",
    "SeriesElastic",
    "motor_terms",
    "read_actuators",
    "write_actuators",
]
