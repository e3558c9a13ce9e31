"""Functions of an exoskeleton as data: contacts in order, trajectories scaled to the wearer, entry and exit.

Angles are flexion: hip forward, knee backward, ankle upward. A vector (forward, up) is the complex number x + i z.
"""

from exoid.experiments.references import minimum_jerk

from .body import SEAT, SIDES, Body, contact_name, joint_angles, legs_flexion
from .chair import rise, seated_hip, sit, stand
from .function import PHASE, Contacts, Function
from .stairs import stairs
from .walk import walk

FUNCTIONS = {
    "stand": stand,
    "sit": sit,
    "rise": rise,
    "walk": walk,
    "stairs up": lambda body, **options: stairs(body, up=True, **options),
    "stairs down": lambda body, **options: stairs(body, up=False, **options),
    "slope": lambda body, angle=0.08, **options: walk(body, angle=angle, **options),
}
"""Functions by name: each makes its data for a :class:`Body`."""

__all__ = [
    "FUNCTIONS",
    "PHASE",
    "SEAT",
    "SIDES",
    "Body",
    "Contacts",
    "Function",
    "contact_name",
    "joint_angles",
    "legs_flexion",
    "minimum_jerk",
    "rise",
    "seated_hip",
    "sit",
    "stairs",
    "stand",
    "walk",
]
