"""Recordings to learn from: one of a real machine, fetched once, and one of a virtual leg that comes along."""

from .bleex_swing import bleex_swing
from .dataset import Dataset
from .dfki import dfki_double_pendulum

__all__ = ["Dataset", "bleex_swing", "dfki_double_pendulum"]
