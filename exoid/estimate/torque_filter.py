"""Filter of measured and predicted torque in a validation, and where its cut-off comes from."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

from exoid.actuators import Actuators, Coupling, Drive
from exoid.errors import BadArgumentError
from exoid.signals import Preparation, Recording, ZeroPhase

from .data import EstimateData


class TorqueFilter(NamedTuple):
    """Filter that measured and predicted torque pass; prints itself.

    Attributes:
        preparation: Way from a recording to kinematics and filtered torques.
        source: "of the estimate" or "given".
        chosen: How the estimate's cut-off was chosen, with its value; "" where that is not known.
        comparable: Whether residuals compare with those of the training: both passed the same kind of filter.
    """

    preparation: Preparation
    source: str
    chosen: str
    comparable: bool = True

    @property
    def cutoff(self) -> float | None:
        """Cut-off frequency of the torques [Hz]; None for a preparation without one."""
        return self.preparation.cutoff if isinstance(self.preparation, ZeroPhase) else None

    def __str__(self) -> str:
        """Write filter and source in one phrase."""
        if self.cutoff is None:
            return f"prepared by {self.preparation.name} ({self.source})"
        if self.source == "given":
            estimates = f"; the estimate's is {self.chosen}" if self.chosen else ""
            return f"low-passed at {self.cutoff:.4g} Hz (given{estimates})"
        _, _, how = self.chosen.partition(", ")
        return f"low-passed at {self.cutoff:.4g} Hz (cut-off of the estimate{', ' + how if how else ''})"


def to_predict(
    estimate: EstimateData,
    recordings: Recording | Iterable[Recording],
    actuators: Mapping[str, Drive | Coupling] | Actuators | None,
    cutoff: float | None,
) -> tuple[EstimateData, list[Recording], TorqueFilter]:
    """Check the recordings whose torques an estimate shall predict, give it their drives, and choose the filter."""
    several = [recordings] if isinstance(recordings, Recording) else list(recordings)
    wrong = [item for item in several if not isinstance(item, Recording)]
    if wrong or not several:
        what = f"{wrong[0]!r} is no recording" if wrong else "no recordings"
        raise BadArgumentError(what, remedy='pass at least one, such as Recording.from_csv("log.csv")')
    if actuators is not None:
        estimate = replace(estimate, actuators=Actuators.of(estimate.model.leg, actuators))
    own = estimate.preparation
    where = f", {estimate.evidence.cutoff_source}" if estimate.evidence.cutoff_source else ""
    chosen = f"{own.cutoff:.4g} Hz{where}" if isinstance(own, ZeroPhase) else ""
    if cutoff is None:
        return estimate, several, TorqueFilter(own, "of the estimate", chosen)
    return estimate, several, TorqueFilter(ZeroPhase(cutoff), "given", chosen, isinstance(own, ZeroPhase))
