"""exoid: a URDF and a log go in; an identified leg you can trust, look at and control with comes out."""

from typing import TYPE_CHECKING, Any

from . import datasets, published, signals, torques
from ._version import __version__ as __version__
from .catalog import load_leg
from .errors import ExoidError
from .estimate import Comparison, Estimate, GroupedEstimate, Validation, compare, validate
from .identification import identify
from .leg import Leg
from .signals import Recording, Recordings
from .torques import Armature, Coulomb, Offset, Stiffness, Viscous
from .torso import TorsoMotion

if TYPE_CHECKING:
    from . import control

__all__ = [
    "Armature",
    "Comparison",
    "Coulomb",
    "Estimate",
    "ExoidError",
    "GroupedEstimate",
    "Leg",
    "Offset",
    "Recording",
    "Recordings",
    "Stiffness",
    "TorsoMotion",
    "Validation",
    "Viscous",
    "compare",
    "control",
    "datasets",
    "identify",
    "load_leg",
    "published",
    "signals",
    "torques",
    "validate",
]


def __getattr__(name: str) -> Any:  # noqa: ANN401 - a module
    """Import ``exoid.control`` when it is first used: it brings the rig along."""
    if name == "control":
        from importlib import import_module  # noqa: PLC0415

        return import_module("exoid.control")
    raise AttributeError(f"module 'exoid' has no attribute {name!r}")
