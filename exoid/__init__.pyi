# Table of contents of exoid: to add a name, import it here and list it. It is imported when it is first used.

from . import (
    actuators,
    codegen,
    control,
    errors,
    estimate,
    experiments,
    identification,
    lab,
    leg,
    online,
    regression,
    rig,
    signals,
    torques,
    view,
)
from .control import wearer
from .control.wearer import Interaction, interaction
from .errors import ExoidError
from .estimate import Comparison, Estimate, GroupedEstimate, Validation, compare, ground_forces, validate
from .estimate.finding import Finding
from .identification import check, identify
from .lab import reproduce, study
from .leg import Leg, Payload, TorsoMotion, catalog, lift, load_exo, load_leg, published, reduction
from .signals import BaseMotion, BasePose, Recording, Recordings, Wrench, datasets
from .torques import Armature, Coulomb, Offset, Stiffness, Viscous

__version__: str

__all__ = [
    "Armature",
    "BaseMotion",
    "BasePose",
    "Comparison",
    "Coulomb",
    "Estimate",
    "ExoidError",
    "Finding",
    "GroupedEstimate",
    "Interaction",
    "Leg",
    "Offset",
    "Payload",
    "Recording",
    "Recordings",
    "Stiffness",
    "TorsoMotion",
    "Validation",
    "Viscous",
    "Wrench",
    "actuators",
    "catalog",
    "check",
    "codegen",
    "compare",
    "control",
    "datasets",
    "errors",
    "estimate",
    "experiments",
    "ground_forces",
    "identification",
    "identify",
    "interaction",
    "lab",
    "leg",
    "lift",
    "load_exo",
    "load_leg",
    "online",
    "published",
    "reduction",
    "regression",
    "reproduce",
    "rig",
    "signals",
    "study",
    "torques",
    "validate",
    "view",
    "wearer",
]
