"""What acts on a joint besides rigid-body dynamics, and the model that puts both together."""

from .armature import Armature
from .catalog import DEFAULT_TERMS, TERMS, term_by_name, term_from_json, term_to_json
from .coulomb import Coulomb
from .model import Merged, TorqueModel
from .motion import Motion
from .offset import Offset
from .stiffness import Stiffness
from .term import Term
from .viscous import Viscous

__all__ = [
    "DEFAULT_TERMS",
    "TERMS",
    "Armature",
    "Coulomb",
    "Merged",
    "Motion",
    "Offset",
    "Stiffness",
    "Term",
    "TorqueModel",
    "Viscous",
    "term_by_name",
    "term_from_json",
    "term_to_json",
]
