"""Example data of one leg."""

from __future__ import annotations

from dataclasses import dataclass

from exoid.leg.leg import Leg
from exoid.signals.recording import Recording


@dataclass(frozen=True, eq=False)
class Dataset:
    """Leg with recordings for identification and validation.

    Attributes:
        leg: The leg.
        train: Recording for identification.
        test: Recording for validation.
        citation: Source of the data, and their licence.
    """

    leg: Leg
    train: Recording
    test: Recording
    citation: str
