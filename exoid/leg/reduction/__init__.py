"""Reduction of the torque regressor to base parameters."""

from .documented import documented
from .documented_machine import documented_machine
from .numeric import numeric
from .planar import GRAVITY, PlanarChain, Plane, TorsoSamples, fill_regressor
from .planar_machine import PLANAR_ROWS, SIDES, Limb, PlanarMachine
from .reduced_regressor import fill_reduced_regressor
from .reduction import LINK_PARAMETERS, LINK_UNITS, RankDecision, Reduction
from .tree import Tree
from .tree_jacobian import tree_jacobian
from .tree_regressor import BaseSamples, fill_tree_regressor

__all__ = [
    "GRAVITY",
    "LINK_PARAMETERS",
    "LINK_UNITS",
    "PLANAR_ROWS",
    "SIDES",
    "BaseSamples",
    "Limb",
    "PlanarChain",
    "PlanarMachine",
    "Plane",
    "RankDecision",
    "Reduction",
    "TorsoSamples",
    "Tree",
    "documented",
    "documented_machine",
    "fill_reduced_regressor",
    "fill_regressor",
    "fill_tree_regressor",
    "numeric",
    "tree_jacobian",
]
