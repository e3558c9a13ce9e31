"""Two swings of a virtual BLEEX leg that come with the package; ``scripts/make_bleex_swing.py`` made them."""

from __future__ import annotations

from pathlib import Path

from exoid.catalog import load_leg
from exoid.signals import Recording

from .dataset import Dataset

CITATION = "simulated by exoid: BLEEX left leg, Tables II-IV of document 1, with assumed sensor noise"


def bleex_swing() -> Dataset:
    """Load the example: encoder angles and noisy torques of the left leg at 100 Hz, 30 s and 15 s.

    Returns:
        The CAD leg (not the one that was simulated), a recording to identify from and one to test on.
    """
    folder = Path(__file__).resolve().parent
    leg = load_leg("bleex", side="left", inertias="cad")
    train, test = (
        Recording.from_csv(folder / name, leg.joint_names) for name in ("bleex_swing.csv", "bleex_swing_test.csv")
    )
    return Dataset(leg, train, test, CITATION)
