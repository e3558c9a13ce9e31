"""exoid: a URDF and a log go in; an identified leg you can trust, look at and control with comes out."""

from .catalog import load_leg
from .errors import ExoidError
from .leg import Leg
from .torso import TorsoMotion

__version__ = "0.1.0"

__all__ = ["ExoidError", "Leg", "TorsoMotion", "load_leg"]
