"""Assessment of recordings: parameters that they determine, and experiments to add."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import ExoidError
from exoid.leg.fixed_base import refuse_floating_base
from exoid.leg.leg import Leg
from exoid.signals import Poses, Preparation, Recording
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel

from .advice import Advice, advise
from .limits import MotionLimits
from .noise import TorqueNoise
from .precision import Precision, StaticRows, information_of
from .scales import Scales
from .text import prediction_text


@dataclass(frozen=True, eq=False, repr=False)
class Assessment:
    """Predicted precision of the parameters after some recordings; prints itself as a table.

    Attributes:
        precision: Predicted precision of each parameter.
        advice: Experiments to add for the parameters that are not determined well.
        noise: Torque noise of the prediction.
    """

    precision: Precision
    advice: tuple[Advice, ...]
    noise: TorqueNoise

    def __repr__(self) -> str:
        """Write the precision, and count the experiments to add."""
        return f"Assessment({self.precision!r}, {len(self.advice)} experiments to add)"

    def __str__(self) -> str:
        """Print the predicted precision, the parameters that are not determined, and experiments to add."""
        p = self.precision
        head = f"{p.duration:.4g} s of motion, torque noise {self.noise}"
        more = list(map(str, self.advice))
        if not set(p.identifiability) <= {"well"}:
            more.append("exoid plan without --assess finds the best motion within your limits.")
        return prediction_text(head, p, more)


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
    """Predict which parameters the motion in some recordings determines; torques are not used.

    Args:
        leg: The leg.
        data: Recordings and poses; each joint torque of a pose counts as one reading.
        terms: Terms as for :func:`exoid.identify`.
        noise: Standard deviation of the torque noise [N·m], a number or (n,); None for 2 % of typical torques.
        noise_bandwidth: Bandwidth of the torque noise [Hz]; inf for white noise.
        limits: Limits of experiments to add; None for those of the URDF.
        values: Expected parameters by name; None for those of the URDF, and zero for terms.
        preparation: Preparation of the later identification; None for the default of :func:`exoid.identify`.

    Returns:
        Predicted precision, and experiments to add.

    Raises:
        ExoidError: The base of the leg floats, there is no recording, a joint is missing, or a recording is too short
            for the filter.
    """
    refuse_floating_base(leg, "an assessment")
    items = [data] if isinstance(data, (Recording, Poses)) else list(data)
    if not items:
        raise ExoidError("no recordings to assess", remedy="pass at least one")
    model, limits = TorqueModel(leg, DEFAULT_TERMS if terms is None else tuple(terms)), limits or MotionLimits.of(leg)
    scales = Scales.of(model, limits, values)
    torque_noise = TorqueNoise.of(noise, scales.typical_torque, noise_bandwidth)
    rows = [StaticRows(item, 1) if isinstance(item, Poses) else item for item in items]
    recorded = information_of(model, rows, torque_noise, preparation)
    advice = advise(model, limits, torque_noise, scales, recorded)
    return Assessment(recorded.precision(model, scales), advice, torque_noise)
