"""Joint torques besides rigid-body dynamics (friction, springs, rotors, offsets), and the torque model of a leg."""

from .catalog import DEFAULT_TERMS, register_term
from .couplings import CoordinateTerm, CouplingFriction, CouplingInertia, CouplingSpring
from .friction import LoadFriction, Stribeck
from .model import TorqueModel
from .motion import JointMotion, Motion
from .presliding import Presliding
from .regrouping import Regrouped
from .term import Term
from .terms import Armature, Coulomb, DryFriction, Offset, Stiffness, Viscous

__all__ = [
    "DEFAULT_TERMS",
    "Armature",
    "CoordinateTerm",
    "Coulomb",
    "CouplingFriction",
    "CouplingInertia",
    "CouplingSpring",
    "DryFriction",
    "JointMotion",
    "LoadFriction",
    "Motion",
    "Offset",
    "Presliding",
    "Regrouped",
    "Stiffness",
    "Stribeck",
    "Term",
    "TorqueModel",
    "Viscous",
    "register_term",
]
