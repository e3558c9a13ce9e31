"""exoid: a URDF and a log go in; an identified leg you can trust, look at and control with comes out."""

from .errors import ExoidError

__version__ = "0.1.0"

__all__ = ["ExoidError"]
