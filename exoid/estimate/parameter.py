"""One identified parameter: what ``estimate["X1"]`` returns."""

from __future__ import annotations

from typing import NamedTuple


class Parameter(NamedTuple):
    """Identified parameter with its uncertainty.

    Attributes:
        name: Name, such as "X1" or "c0_hip".
        value: Value.
        std: Standard deviation; 0 for a parameter that was held fixed.
        interval: Lower and upper end of the 95 % confidence interval.
        unit: Unit of all these numbers.
        identifiability: "well", "weakly", "not", "known", "prior" or "held", see
            :attr:`exoid.Estimate.identifiability`.
    """

    name: str
    value: float
    std: float
    interval: tuple[float, float]
    unit: str
    identifiability: str

    def __str__(self) -> str:
        """Print as ``X1 = 3.986 ± 0.0063 kg·m``."""
        return f"{self.name} = {self.value:.6g} ± {self.std:.2g} {self.unit}"
