"""Tracking task: a motion that controllers follow on a virtual leg after its identification."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from exoid._typing import FloatArray
from exoid.control import ControlModel, default_gains, mean_pose, standard_laws
from exoid.control.closed_loop import plant_step
from exoid.control.law import RATE, AnyLaw
from exoid.control.model import ModelSource
from exoid.control.standard_laws import refuse_unknown_laws
from exoid.errors import BadArgumentError
from exoid.experiments import Harmonics
from exoid.experiments.limits import refuse_motion_beyond_limits
from exoid.leg.joint_numbers import for_joints
from exoid.tools.json_values import attributes
from exoid.torques import TorqueModel

from .protocol import motion_to_json


@dataclass(frozen=True, eq=False)
class TrackingTask:
    """A periodic motion that controllers follow on the identified leg; gains are the same in all replicates.

    Attributes:
        laws: Names of controllers, as in :func:`exoid.control.standard_laws`.
        motion: Motion of one leg.
        period: Period of the motion [s].
        kp: Gain Kp of each joint [N·m/rad].
        kd: Gain Kd of each joint [N·m·s/rad].
        periods: Number of periods; the first is not evaluated.
        rate: Sampling rate of all controllers [Hz].
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
            raise BadArgumentError(f"controllers {', '.join(self.laws)}", remedy="name each controller once")
        if not (0.0 < self.period < np.inf and self.periods >= 2):
            raise BadArgumentError(f"{self.periods} periods of {self.period:g} s", remedy="give two periods or more")
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
        """Make a tracking task, by default with the gains of ``exoid track`` for this leg and Kd = 0.1 s · Kp.

        Args:
            laws: Names of controllers.
            motion: Motion of one leg.
            period: Period of the motion [s].
            known: Model of the leg for which default gains are chosen.
            kp: Kp [N·m/rad], one for each joint or one for all; None for the default.
            kd: Kd [N·m·s/rad], likewise.

        Returns:
            The task.

        Raises:
            ExoidError: A name is unknown or occurs twice, or gains or period are invalid.
        """
        own, _ = default_gains(known, mean_pose(motion, period))
        stiffness = own if kp is None else for_joints(kp, known.n, "gains")
        damping = 0.1 * stiffness if kd is None else for_joints(kd, known.n, "gains")
        return cls(laws, motion, period, tuple(stiffness.tolist()), tuple(damping.tolist()))

    @property
    def seconds(self) -> float:
        """Duration [s]."""
        return self.periods * self.period

    def law(self, name: str, known: ModelSource) -> AnyLaw:
        """Make one of the controllers.

        Args:
            name: Name of the controller.
            known: Source of its model of the leg.

        Returns:
            The controller.

        Raises:
            ExoidError: No such controller can be made from the model.
        """
        return standard_laws(known, self.kp, self.kd, self.motion, self.period, rate=self.rate, names=(name,))[name]

    def check_leg(self, model: TorqueModel, truth: FloatArray) -> None:
        """Check that a leg can follow the motion, before anything runs.

        Args:
            model: Leg and terms.
            truth: True parameters in SI units, in the order of ``model.names``, (P,).

        Raises:
            ExoidError: The motion leaves the limits, the gains do not fit, or no rig has such terms.
        """
        leg = model.leg
        if {len(self.kp), len(self.kd)} != {len(leg.joint_names)}:
            raise BadArgumentError(
                f"{len(self.kp)} Kp and {len(self.kd)} Kd for {len(leg.joint_names)} joints",
                remedy="give one for each joint",
            )
        refuse_motion_beyond_limits(leg, self.motion, self.seconds)
        known = ControlModel.of_parameters(model, truth)
        known.plant()
        standard_laws(known, self.kp, self.kd, self.motion, self.period, rate=self.rate, names=self.laws)

    def to_json(self) -> dict[str, Any]:
        """Describe the task completely.

        Returns:
            Description in JSON types.
        """
        numbers = attributes(self, "kp", "kd", "period", "periods", "rate")
        return {"laws": list(self.laws), "motion": motion_to_json(self.motion), **numbers}
