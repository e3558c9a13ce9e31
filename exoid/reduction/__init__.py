"""Reduction of the torque regressor to base parameters."""

from .documented import documented
from .numeric import numeric
from .planar import PlanarChain, Plane, TorsoSamples, fill_regressor
from .reduction import LINK_PARAMETERS, LINK_UNITS, RankDecision, Reduction

__all__ = [
    "LINK_PARAMETERS",
    "LINK_UNITS",
    "PlanarChain",
    "Plane",
    "RankDecision",
    "Reduction",
    "TorsoSamples",
    "documented",
    "fill_regressor",
    "numeric",
]
