"""What the search needs of an objective."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from exoid._typing import FloatArray

from .fourier import Basis, States
from .objective import Stage


class Searched(Protocol):
    """Objective of one or several motions, by the coefficients x of their Fourier series."""

    @property
    def basis(self) -> Basis:
        """Basis functions of the motions."""

    @property
    def seconds(self) -> float:
        """Duration of each motion [s]."""

    @property
    def pitches(self) -> FloatArray:
        """Tilt of the torso in each motion [rad], (T,); zero where the torso moves."""

    @property
    def machine(self) -> str:
        """Name of the leg, for errors."""

    @property
    def limit_names(self) -> tuple[str, ...]:
        """Names of the limits, (L,)."""

    def __call__(self, x: FloatArray, stage: Stage) -> tuple[float, FloatArray]:
        """Value and gradient at flattened coefficients."""

    def coefficients(self, x: FloatArray) -> Sequence[FloatArray]:
        """Split coefficients."""

    def draw(self, rng: np.random.Generator) -> FloatArray:
        """Draw coefficients from which a search begins."""

    def narrowed(self) -> Searched:
        """Narrow the limits by what the search reserves for values between its samples."""

    def excesses_of(self, number: int, states: States) -> FloatArray:
        """Compute the mean squared excess over each limit."""
