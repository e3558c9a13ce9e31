"""What recordings that exist can tell, and what to add."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.signals import Poses, Preparation, Recording
from exoid.tables import to_text
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel

from .advice import Advice, advise
from .limits import MotionLimits
from .noise import TorqueNoise
from .precision import Precision, StaticRows, evidence
from .scales import Scales
from .text import doubts, precision_table


@dataclass(frozen=True, eq=False, repr=False)
class Assessment:
    """Verdict on recordings; prints itself.

    Attributes:
        precision: What their motion can tell.
        advice: What to add, for the parameters that they do not determine well.
        noise: What was reckoned with.
    """

    precision: Precision
    advice: tuple[Advice, ...]
    noise: TorqueNoise

    def __str__(self) -> str:
        """Say what can be determined, what cannot, and what to add."""
        p = self.precision
        head = f"{p.duration:.4g} s of motion, torque noise {self.noise}"
        closing = [f"condition number {p.condition_number:.0f}", *doubts(p), *map(str, self.advice)]
        if not set(p.identifiability) <= {"well"}:
            closing.append("Better still: exoid plan without --assess, which finds the best motion within your limits.")
        return to_text(head, precision_table(p)) + "\n\n" + "\n".join(closing)


def assess(
    leg: Leg,
    data: Recording | Poses | Sequence[Recording | Poses],
    terms: Sequence[Term] | None = None,
    *,
    noise: ArrayLike | None = None,
    noise_bandwidth: float = np.inf,
    limits: MotionLimits | None = None,
    values: Mapping[str, float] | None = None,
    preparation: Preparation | None = None,
) -> Assessment:
    """Say which parameters the motion in some recordings can determine, whatever their torques.

    Args:
        leg: The leg.
        data: Recordings and poses; of a pose each joint's torque counts as one reading.
        terms: As for :func:`exoid.identify`.
        noise: As for :func:`plan_excitation`.
        noise_bandwidth: Likewise.
        limits: Within which more may be added; None for those of the URDF.
        values: Parameters to expect by name.
        preparation: With which will be identified; None for that of :func:`exoid.identify`.

    Raises:
        ExoidError: There is no recording, a joint is missing, or a recording is too short for the filter.
    """
    items = [data] if isinstance(data, (Recording, Poses)) else list(data)
    if not items:
        raise ExoidError("no recordings to assess", remedy="pass at least one")
    model, limits = TorqueModel(leg, DEFAULT_TERMS if terms is None else tuple(terms)), limits or MotionLimits.of(leg)
    scales = Scales.of(model, limits, values)
    assumed = TorqueNoise.of(noise, scales.typical, noise_bandwidth)
    rows = [StaticRows(item, 1) if isinstance(item, Poses) else item for item in items]
    known = evidence(model, rows, assumed, preparation)
    return Assessment(known.precision(model, scales), advise(model, limits, assumed, scales, known), assumed)
