"""Motions of the virtual legs of a study."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from exoid.errors import NotSupportedError
from exoid.experiments import Harmonics, bleex, cuhk
from exoid.experiments.excitation import Plan
from exoid.experiments.references import States
from exoid.leg.leg import Leg


@dataclass(frozen=True, eq=False)
class Protocol:
    """Motions of one leg, one after the other.

    Attributes:
        name: Name in results.
        motions: Motions of one rig each.
        seconds: Duration of each motion [s].
    """

    name: str
    motions: tuple[Harmonics, ...]
    seconds: float

    def states(self, motion: int, rate: float) -> States:
        """Sample a motion.

        Args:
            motion: Index of the motion.
            rate: Sampling rate [Hz].

        Returns:
            Angles, velocities and accelerations [rad, rad/s, rad/s²], (N, n) each.
        """
        return self.motions[motion].over(np.arange(round(self.seconds * rate) + 1) / rate)


def planned(plan: Plan, name: str = "planned") -> Protocol:
    """Make a protocol of the motions of a plan.

    Args:
        plan: Plan of :func:`exoid.experiments.excitation.plan_excitation` with an upright torso.
        name: Name in results.

    Returns:
        The protocol.
    """
    return Protocol(name, tuple(motion.reference for motion in plan.motions), plan.motions[0].duration)


def document(leg: Leg, duration: float) -> Protocol:
    """Make a protocol of the dynamic experiments of a built-in leg's document, shortened to a duration.

    BLEEX: fifteen swings, each joint at five frequencies. CUHK-EXO: the random multisine of the replay, because the
    swings of Table II do not determine every parameter.

    Args:
        leg: The leg, with the joint names of a built-in one.
        duration: Duration of all motions together [s].

    Returns:
        The protocol.

    Raises:
        ExoidError: The joints have other names.
    """
    if leg.joint_labels == ("hip", "knee", "ankle"):
        every = bleex.dynamic_motions()
        motions = tuple(
            Harmonics(*(part[..., [rig]] for part in (every.centre, every.amplitude, every.frequency, every.phase)))
            for rig in range(bleex.VALIDATION)
        )
    elif leg.joint_labels == ("hip", "knee"):
        motions = (cuhk.multisine(leg, np.random.default_rng(0)),)
    else:
        raise NotSupportedError(
            f"no document moved {', '.join(leg.joint_names)}", remedy="study the protocol 'planned', or a built-in leg"
        )
    return Protocol("document", motions, duration / len(motions))
