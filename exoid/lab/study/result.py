"""Results of a study."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from exoid._typing import FloatArray
from exoid.tools.tables import make_table, to_text

from .design import Study


@dataclass(frozen=True, eq=False, repr=False)
class Combination:
    """Statistics of one protocol, noise and estimator."""

    protocol: str  # name of the protocol
    noise: str  # name of the noise
    estimator: str  # name of the estimator
    names: tuple[str, ...]  # names of the parameters, (P,)
    units: tuple[str, ...]  # units of the parameters, (P,)
    bias: FloatArray  # mean error, (P,)
    std: FloatArray  # standard deviation of the estimates, (P,)
    stated: FloatArray  # root mean square of the standard deviations that the estimates state, (P,)
    coverage: FloatArray  # share of 95 % intervals that contain the truth, (P,)
    bound: FloatArray  # smallest standard deviation of an unbiased estimate (Cramér–Rao), (P,)
    replicates: int  # number of identifications

    @property
    def efficiency(self) -> FloatArray:
        """Squared Cramér–Rao bound divided by the mean squared error, (P,); 1 is best."""
        return np.asarray(self.bound**2 / (self.std**2 + self.bias**2))

    def __str__(self) -> str:
        """Print as a table, one line for each parameter."""
        rows = zip(
            self.names, self.bias, self.std, self.stated, self.coverage, self.efficiency, self.units, strict=True
        )
        table = make_table(
            ["parameter", "bias", "std", "stated", "coverage %", "efficiency", "unit"],
            [
                (name, f"{bias:+.2g}", f"{std:.3g}", f"{stated:.3g}", f"{100.0 * cover:.1f}", f"{part:.2f}", unit)
                for name, bias, std, stated, cover, part, unit in rows
            ],
        )
        return to_text(f"{self.protocol}, {self.noise} noise, {self.estimator}", table)


@dataclass(frozen=True, eq=False, repr=False)
class StudyResult:
    """All combinations of a study; prints itself."""

    study: Study  # the study
    combinations: tuple[Combination, ...]  # statistics by protocol, noise and estimator

    def __str__(self) -> str:
        """Print as a table, one line for each combination: means over parameters, and the worst parameter."""
        rows = []
        for each in self.combinations:
            far, low = int(np.argmax(np.abs(each.coverage - 0.95))), int(np.argmin(each.efficiency))
            bias = np.abs(each.bias) / each.std
            rows.append(
                (
                    f"{each.protocol}, {each.noise}, {each.estimator}",
                    f"{100.0 * each.coverage.mean():.1f}",
                    f"{100.0 * each.coverage[far]:.1f} ({each.names[far]})",
                    f"{each.efficiency.mean():.2f}",
                    f"{each.efficiency[low]:.2f} ({each.names[low]})",
                    f"{bias.max():.2f} ({each.names[int(np.argmax(bias))]})",
                )
            )
        table = make_table(["combination", "coverage %", "farthest", "efficiency", "lowest", "bias / std"], rows)
        study = self.study
        error = 100.0 * math.sqrt(0.95 * 0.05 / study.replicates)
        head = f"{study.replicates} identifications of each, seed {study.seed}"
        closing = (
            f"Coverage of 95 % intervals: mean over parameters and farthest from 95; Monte-Carlo error ± {error:.1f} "
            f"of each parameter, ± {1.0 / math.sqrt(study.replicates):.2f} of bias / std."
        )
        return to_text(head, table, closing)
