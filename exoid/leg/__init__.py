"""Legs on Pinocchio: URDF, dynamics, bases, reduction to X, Y, J, lift back to links."""

from . import catalog, lift, published, reduction
from .catalog import load_exo, load_leg
from .leg import Leg
from .payload import Payload
from .torso import TorsoMotion

__all__ = ["Leg", "Payload", "TorsoMotion", "catalog", "lift", "load_exo", "load_leg", "published", "reduction"]
