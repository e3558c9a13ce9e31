"""What laws have to do on a virtual leg after it was identified."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.control import ControlModel, Law, default_gains, mean_pose, standard_laws
from exoid.control.closed_loop import plant_step
from exoid.control.law import RATE
from exoid.control.standard_laws import refuse_unknown_laws
from exoid.errors import ExoidError
from exoid.experiments import Harmonics, refuse_motion_beyond_limits
from exoid.json_values import attributes
from exoid.torques import TorqueModel

from .protocol import motion_to_json


@dataclass(frozen=True, eq=False)
class TrackingTask:
    """A periodic motion that laws follow on the leg that was identified; gains are the same in all replicates.

    Attributes:
        laws: Names, as in :func:`exoid.control.standard_laws`.
        motion: Of one leg.
        period: Of the motion [s].
        kp: Kp of each joint [N·m/rad].
        kd: Kd [N·m·s/rad].
        periods: How many are followed; the first does not count.
        rate: Of all laws [Hz].
    """

    laws: tuple[str, ...]
    motion: Harmonics
    period: float
    kp: tuple[float, ...]
    kd: tuple[float, ...]
    periods: int = 2
    rate: float = RATE

    def __post_init__(self) -> None:
        """Check what does not depend on the leg."""
        refuse_unknown_laws(self.laws)
        if len(set(self.laws)) != len(self.laws):
            raise ExoidError(f"laws {', '.join(self.laws)}", remedy="name each law once")
        if not (0.0 < self.period < np.inf and self.periods >= 2):
            raise ExoidError(f"{self.periods} periods of {self.period:g} s", remedy="follow two periods at least")
        plant_step(self.rate, max(self.rate, RATE))

    @classmethod
    def of(
        cls,
        laws: tuple[str, ...],
        motion: Harmonics,
        period: float,
        known: ControlModel,
        kp: tuple[float, ...] | None = None,
        kd: tuple[float, ...] | None = None,
    ) -> TrackingTask:
        """Choose gains where none are given: those of ``exoid track`` for a leg like this, and Kd = 0.1 s · Kp.

        Args:
            laws: Names.
            motion: Of one leg.
            period: [s].
            known: The leg that gains are chosen for.
            kp: One for each joint, or one for all.
            kd: Likewise.
        """
        own, _ = default_gains(known, mean_pose(motion, period))
        stiffness = own if kp is None else _each(kp, known.n)
        damping = 0.1 * stiffness if kd is None else _each(kd, known.n)
        return cls(laws, motion, period, tuple(stiffness.tolist()), tuple(damping.tolist()))

    @property
    def seconds(self) -> float:
        """Duration [s]."""
        return self.periods * self.period

    def law(self, name: str, known: ControlModel) -> Law:
        """Make one of the laws from what is known of the leg.

        Raises:
            ExoidError: There is no such law for it.
        """
        return standard_laws(known, self.kp, self.kd, self.motion, self.period, rate=self.rate, names=(name,))[name]

    def refuse(self, model: TorqueModel, truth: FloatArray) -> None:
        """Refuse a course that a leg cannot follow, before anything runs.

        Raises:
            ExoidError: It leaves the limits, gains do not fit, or no rig has such terms.
        """
        leg = model.leg
        if {len(self.kp), len(self.kd)} != {len(leg.joint_names)}:
            raise ExoidError(
                f"{len(self.kp)} Kp and {len(self.kd)} Kd for {len(leg.joint_names)} joints", remedy="give one a joint"
            )
        refuse_motion_beyond_limits(leg, self.motion, self.seconds)
        known = ControlModel.of_parameters(model, truth)
        known.plant()
        standard_laws(known, self.kp, self.kd, self.motion, self.period, rate=self.rate, names=self.laws)

    def to_json(self) -> dict[str, Any]:
        """Describe it completely."""
        numbers = attributes(self, "kp", "kd", "period", "periods", "rate")
        return {"laws": list(self.laws), "motion": motion_to_json(self.motion), **numbers}


def _each(values: tuple[float, ...], joints: int) -> FloatArray:
    if len(values) not in (1, joints):
        raise ExoidError(f"{len(values)} gains for {joints} joints", remedy="give one number, or one for each joint")
    return np.broadcast_to(np.array(values), (joints,)).copy()
