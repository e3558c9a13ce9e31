"""Example data: real legs and arms (downloaded once), a virtual leg (part of the package), and gait norms."""

from .dataset import Dataset, bleex_swing
from .dfki import dfki_double_pendulum
from .gait_norms import GaitNorm, gait_norm
from .sydney import sydney_swing_leg
from .teststand import ForceDataset, teststand_leg

__all__ = [
    "Dataset",
    "ForceDataset",
    "GaitNorm",
    "bleex_swing",
    "dfki_double_pendulum",
    "gait_norm",
    "sydney_swing_leg",
    "teststand_leg",
]
