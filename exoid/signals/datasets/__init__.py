"""Example data: real legs and arms (downloaded once), and a virtual leg (part of the package)."""

from .dataset import Dataset, bleex_swing
from .dfki import dfki_double_pendulum
from .sydney import sydney_swing_leg
from .teststand import ForceDataset, teststand_leg

__all__ = [
    "Dataset",
    "ForceDataset",
    "bleex_swing",
    "dfki_double_pendulum",
    "sydney_swing_leg",
    "teststand_leg",
]
