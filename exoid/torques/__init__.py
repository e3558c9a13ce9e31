"""What acts on a joint besides rigid-body dynamics, and the model that puts both together."""

from .armature import Armature
from .catalog import DEFAULT_TERMS, TERMS, register_term, term_by_name, term_from_json, term_to_json
from .coulomb import Coulomb
from .dry_friction import DryFriction
from .load_friction import LoadFriction
from .memory import Memory
from .model import Regrouped, TorqueModel
from .motion import JointMotion, Motion
from .nonlinear import NonlinearParameter, NonlinearSetting, nonlinear_settings, with_settings
from .offset import Offset
from .presliding import Presliding
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
    "JointMotion",
    "LoadFriction",
    "Memory",
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
