"""Two logs of a virtual BLEEX leg that are part of the package, written by ``scripts/make_bleex_swing.py``."""

from __future__ import annotations

from pathlib import Path

from exoid.leg.catalog import load_leg
from exoid.signals.recording import Recording

from .dataset import Dataset

CITATION = "simulated by exoid: BLEEX left leg, Tables II-IV of document 1, with assumed sensor noise"


def bleex_swing() -> Dataset:
    """Load encoder angles and noisy torques of the left leg at 100 Hz, 30 s and 15 s.

    Returns:
        Leg with CAD inertias, which differ from the simulated ones, a recording for identification and one for
        validation.
    """
    folder = Path(__file__).resolve().parent
    leg = load_leg("bleex", side="left", inertias="cad")
    train, test = (
        Recording.from_csv(folder / name, leg.joint_names) for name in ("bleex_swing.csv", "bleex_swing_test.csv")
    )
    return Dataset(leg, train, test, CITATION)
