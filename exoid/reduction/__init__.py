"""Reduction of the torque regressor to the parameters that motion can determine."""

from .documented import documented
from .lift import Lift, lift
from .numeric import numeric
from .physical import MassBound, PhysicalCheck, check
from .planar import PlanarChain, Plane, TorsoSamples, fill_regressor
from .reduction import LINK_PARAMETERS, LINK_UNITS, RankDecision, Reduction

__all__ = [
    "LINK_PARAMETERS",
    "LINK_UNITS",
    "Lift",
    "MassBound",
    "PhysicalCheck",
    "PlanarChain",
    "Plane",
    "RankDecision",
    "Reduction",
    "TorsoSamples",
    "check",
    "documented",
    "fill_regressor",
    "lift",
    "numeric",
]
