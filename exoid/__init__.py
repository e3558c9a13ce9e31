"""exoid: a URDF and a log go in; an identified leg you can trust, look at and control with comes out."""

from . import datasets, published, signals, torques
from .catalog import load_leg
from .errors import ExoidError
from .identification import Comparison, Estimate, Validation, compare, identify, validate
from .leg import Leg
from .signals import Recording
from .torques import Armature, Coulomb, Offset, Stiffness, Viscous
from .torso import TorsoMotion

__version__ = "0.1.0"

__all__ = [
    "Armature",
    "Comparison",
    "Coulomb",
    "Estimate",
    "ExoidError",
    "Leg",
    "Offset",
    "Recording",
    "Stiffness",
    "TorsoMotion",
    "Validation",
    "Viscous",
    "compare",
    "datasets",
    "identify",
    "load_leg",
    "published",
    "signals",
    "torques",
    "validate",
]
