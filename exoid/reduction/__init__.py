"""Reduction of the torque regressor to base parameters."""

from .documented import documented
from .numeric import numeric
from .planar import GRAVITY, PlanarChain, Plane, TorsoSamples, fill_regressor
from .reduction import LINK_PARAMETERS, LINK_UNITS, RankDecision, Reduction
from .tree import Tree
from .tree_regressor import BaseSamples, fill_tree_regressor

__all__ = [
    "GRAVITY",
    "LINK_PARAMETERS",
    "LINK_UNITS",
    "BaseSamples",
    "PlanarChain",
    "Plane",
    "RankDecision",
    "Reduction",
    "TorsoSamples",
    "Tree",
    "documented",
    "fill_regressor",
    "fill_tree_regressor",
    "numeric",
]
