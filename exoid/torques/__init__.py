"""Joint torques besides rigid-body dynamics (friction, springs, rotors, offsets), and the torque model of a leg."""

from .armature import Armature
from .catalog import DEFAULT_TERMS, TERMS, register_term, term_by_name, term_from_json, term_to_json
from .coulomb import Coulomb
from .dry_friction import DryFriction
from .internal_state import InternalState
from .load_friction import LoadFriction
from .model import TorqueModel
from .motion import JointMotion, Motion
from .nonlinear import NonlinearParameter, NonlinearSetting, nonlinear_settings, with_settings
from .offset import Offset
from .presliding import Presliding
from .regrouping import Regrouped
from .stiffness import Stiffness
from .stribeck import Stribeck
from .term import Term
from .viscous import Viscous

__all__ = [
    "DEFAULT_TERMS",
    "TERMS",
    "Armature",
    "Coulomb",
    "DryFriction",
    "InternalState",
    "JointMotion",
    "LoadFriction",
    "Motion",
    "NonlinearParameter",
    "NonlinearSetting",
    "Offset",
    "Presliding",
    "Regrouped",
    "Stiffness",
    "Stribeck",
    "Term",
    "TorqueModel",
    "Viscous",
    "nonlinear_settings",
    "register_term",
    "term_by_name",
    "term_from_json",
    "term_to_json",
    "with_settings",
]
