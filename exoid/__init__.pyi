# Table of contents of exoid: to add a name, import it here and list it. It is imported when it is first used.

from . import (
    actuators,
    catalog,
    codegen,
    control,
    datasets,
    errors,
    estimate,
    experiments,
    exported,
    ground,
    identification,
    lift,
    online,
    published,
    reduction,
    regression,
    reproduce,
    rig,
    signals,
    study,
    torques,
    view,
    wearer,
)
from .catalog import load_exo, load_leg
from .errors import ExoidError
from .estimate import Comparison, Estimate, GroupedEstimate, Validation, compare, ground_forces, joint_torques, validate
from .findings import Finding
from .identification import check, identify
from .leg import Leg
from .payload import Payload
from .signals import BaseMotion, BasePose, Recording, Recordings, Wrench
from .torques import Armature, Coulomb, Offset, Stiffness, Viscous
from .torso import TorsoMotion
from .wearer import Interaction, interaction

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
    "exported",
    "ground",
    "ground_forces",
    "identification",
    "identify",
    "interaction",
    "joint_torques",
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
