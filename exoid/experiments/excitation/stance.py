"""Plans of squats, weight shifts and leg swings on the ground by a fixed protocol, and the precision that they give."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import ArrayLike
from exoid.errors import BadArgumentError, NotSupportedError
from exoid.experiments.ground.planned_motion import follow
from exoid.experiments.ground.posture import PlanarLeg, planar_legs
from exoid.experiments.ground.protocol import FRICTION, ProtocolMotion, protocol_motion
from exoid.experiments.ground.stance import GAINS
from exoid.experiments.limits import MotionLimits
from exoid.leg.leg import Leg
from exoid.rig.ground import GroundPlant, GroundRun, Sole
from exoid.rig.ground.plant import soles_of
from exoid.signals import Recording
from exoid.tools.numbers import checked
from exoid.torques import Term, TorqueModel
from exoid.torques.catalog import terms_of

from .assess import assess
from .precision import Precision
from .scales import TorqueNoise
from .text import prediction_text

BOTH = "both"
"""Name of the support by all feet."""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class StancePlan:
    """Planned experiment on the ground; prints itself as a table.

    Attributes:
        model: Leg and terms.
        plant: Machine with its soles.
        labels: Support of each motion, for files.
        motions: Motion on each support, with its margins.
        recordings: Motions as logs of a machine that follows exactly, with contacts and the expected torques.
        precision: Predicted precision of each parameter.
        noise: Torque noise of the prediction.
    """

    model: TorqueModel
    plant: GroundPlant
    labels: tuple[str, ...]
    motions: tuple[ProtocolMotion, ...]
    recordings: tuple[Recording, ...]
    precision: Precision
    noise: TorqueNoise

    @property
    def duration(self) -> float:
        """Total duration of the motions [s]."""
        return sum(recording.duration for recording in self.recordings)

    def __repr__(self) -> str:
        """Name the machine, and write duration and precision."""
        name = self.model.leg.description.name
        return f"StancePlan({name}: {self.duration:g} s on {', '.join(self.labels)}; {self.precision!r})"

    def __str__(self) -> str:
        """Print the motions, their demands on each joint, and the predicted precision."""
        head = [
            f"{self.duration:g} s of motion at {self.recordings[0].sample_rate:g} Hz, each starting and stopping at "
            f"rest; torque noise {self.noise}, joint by joint"
        ]
        head += [_describe(*each) for each in zip(self.motions, self.recordings, strict=True)]
        open_ = "not" in self.precision.identifiability
        more = ["exoid plan --supports says on which links the rest can be determined"] if open_ else []
        return prediction_text("\n".join(head), self.precision, more)


def plan_stance(
    leg: Leg,
    terms: Sequence[Term] | None = None,
    *,
    feet: Sequence[str] = (BOTH,),
    soles: Mapping[str, Sole] | None = None,
    friction: float = FRICTION,
    duration: float = 60.0,
    rate: float = 100.0,
    limits: MotionLimits | None = None,
    noise: ArrayLike | None = None,
    noise_bandwidth: float = np.inf,
) -> StancePlan:
    """Make squats, shifts, bows and leg swings as large as a machine allows, and predict what they determine.

    Forces of the ground are not measured. The motions are a fixed protocol, see :mod:`exoid.experiments.ground`; a
    search finds hardly better ones.

    Args:
        leg: Planar machine on a floating base; its inertias give the expected forces and torques.
        terms: Terms as for :func:`exoid.identify`.
        feet: Support of each motion: "both" for all feet side by side, a leg ("left") or the link of its foot.
        soles: Sole of each foot by its link; None for those of a built-in machine.
        friction: Coefficient of friction that a motion may use, below that of the ground.
        duration: Total duration of the motions [s], divided evenly among them.
        rate: Rate of command and log [Hz].
        limits: Limits of the joints; None for those of the URDF.
        noise: Standard deviation of the torque noise [N·m], a number or (n,); None for 2 % of typical torques.
        noise_bandwidth: Frequency up to which the noise spectrum is flat [Hz]; inf for white noise.

    Returns:
        Plan with the predicted precision of every parameter.

    Raises:
        ExoidError: The base of the leg does not float, the machine is not planar or has no soles, the protocol does not
            fit the limits, the duration is too short, or an argument is invalid.

    Example:
        >>> exo = exoid.load_exo("bleex", base="floating")
        >>> plan = plan_stance(exo, feet=("left", "right"), noise=(0.5, 0.4, 0.2) * 2)
        >>> "not" in plan.precision.identifiability
        False
    """
    if not feet or len(set(feet)) < len(feet):
        raise BadArgumentError(f"supports {', '.join(feet) or 'none'}", remedy='name each once, e.g. ("both", "left")')
    checked(friction, "friction", above=0.0)
    checked(rate, "the rate of a plan [Hz]", least=20.0)
    checked(duration / len(feet), "the duration on each support [s]", least=5.0)
    plant = GroundPlant.build(leg, soles_of(leg, soles))
    if not plant.is_planar:
        raise NotSupportedError(
            "stance is planned for planar machines",
            where=leg.description.name,
            remedy="use legs whose joint axes are parallel",
        )
    allowed = limits or MotionLimits.of(leg)
    stands, seconds = [_standing(plant, planar_legs(plant), name) for name in feet], duration / len(feet)
    motions = tuple(
        protocol_motion(plant, legs, seconds, allowed, friction=friction, number=k) for k, legs in enumerate(stands)
    )
    recordings = tuple(_recording(plant, motion, rate) for motion in motions)
    found = assess(leg, recordings, terms, noise=noise, noise_bandwidth=noise_bandwidth, limits=allowed)
    model = TorqueModel(leg, terms_of(terms))
    return StancePlan(
        model=model,
        plant=plant,
        labels=tuple(feet),
        motions=motions,
        recordings=recordings,
        precision=found.precision,
        noise=found.noise,
    )


def run_stance(plan: StancePlan, plant: GroundPlant | None = None) -> tuple[GroundRun, ...]:
    """Let a machine follow a plan.

    Args:
        plan: The plan.
        plant: Machine with its true parameters; None for that of the plan, without friction.

    Returns:
        A run for each motion.

    Raises:
        ExoidError: MuJoCo is not installed, or the machine falls.
    """
    return tuple(follow(plant or plan.plant, each.motion, GAINS) for each in plan.motions)


def _standing(plant: GroundPlant, legs: tuple[PlanarLeg, ...], name: str) -> tuple[PlanarLeg, ...]:
    """Legs of a support."""
    labels = [limb.label for limb in plant.leg.limbs]
    stands = tuple(leg for leg, label in zip(legs, labels, strict=True) if name in (BOTH, label, leg.foot))
    if not stands or not name:
        known = ", ".join((BOTH, *(label or leg.foot for leg, label in zip(legs, labels, strict=True))))
        raise BadArgumentError(f"no support {name!r}", where=plant.leg.description.name, remedy=f"choose among {known}")
    return stands


def _recording(plant: GroundPlant, found: ProtocolMotion, rate: float) -> Recording:
    """Log of a machine that follows a motion exactly, with contacts and the expected torque."""
    motion = found.motion
    time = np.arange(round(motion.time[-1] * rate) + 1) / rate
    joints, torque = (scipy.interpolate.make_interp_spline(motion.time, x, 7) for x in (motion.q, motion.torque))
    standing = np.ones(len(time), dtype=np.bool_)
    return Recording(
        time,
        joints(time),
        joints(time, 1),
        joints(time, 2),
        torque(time),
        joint_names=plant.leg.joint_names,
        contacts={foot: standing if foot in found.feet else ~standing for foot in plant.soles},
    )


def _describe(found: ProtocolMotion, recording: Recording) -> str:
    """Ranges of torso and joints in one motion."""
    base, q, v, tau = found.motion.base, np.rad2deg(recording.q), recording.v, recording.tau
    assert v is not None
    assert tau is not None
    ranges = [f"{place.min():.2f} to {place.max():.2f} m" for place in base[:, :2].T]
    pitch = np.rad2deg([base[:, 2].min(), base[:, 2].max()])
    lines = [
        f"{' and '.join(found.feet)}, {recording.duration:g} s: torso forward {ranges[0]}, up {ranges[1]}, "
        f"pitch {pitch[0]:.0f}° to {pitch[1]:.0f}°; {100.0 * found.share:.0f} % of the protocol"
    ]
    for j, name in enumerate(recording.joint_names):
        lines.append(
            f"  {name}: {q[:, j].min():.0f}° to {q[:, j].max():.0f}°, up to {np.abs(v[:, j]).max():.1f} rad/s, "
            f"{np.abs(tau[:, j]).max():.0f} N·m"
        )
    return "\n".join(lines)
