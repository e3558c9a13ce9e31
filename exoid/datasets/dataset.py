"""A leg and what was recorded of it."""

from __future__ import annotations

from dataclasses import dataclass

from exoid.leg import Leg
from exoid.signals import Recording


@dataclass(frozen=True, eq=False)
class Dataset:
    """A leg, recordings to identify it from, and others to test the result on.

    Attributes:
        leg: The leg.
        train: For identification.
        test: For validation.
        citation: Where the data come from, and their licence.
    """

    leg: Leg
    train: Recording
    test: Recording
    citation: str
