"""Plans of squats, weight shifts and leg swings on the ground that determine torso and legs best."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np

from exoid._typing import ArrayLike
from exoid.errors import BadArgumentError
from exoid.experiments.excitation.fourier import FourierMotion, series
from exoid.experiments.excitation.limits import MotionLimits
from exoid.experiments.excitation.objective import Criterion
from exoid.experiments.excitation.plan import PlannedMotions
from exoid.experiments.excitation.precision import predict
from exoid.experiments.excitation.scales import Scales, TorqueNoise, expected_parameters
from exoid.experiments.excitation.search import search
from exoid.experiments.excitation.text import prediction_text
from exoid.experiments.references import States
from exoid.leg.leg import Leg
from exoid.leg.link_frames import link_frame
from exoid.rig.ground import Sole
from exoid.rig.ground.plant import BLEEX_SOLES
from exoid.signals import Preparation, Recording
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel

from .demands import EVERY, LIMITS, Demands, GroundLimits, missing_support, null_space, stance_scales, undetermined
from .objective import StanceObjective
from .support import BOTH, StanceSupport, supports_of


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class StancePlan(PlannedMotions):
    """Planned experiment on the ground; prints itself as a table. Motions are those of the coordinates of each support.

    Attributes:
        demands: Feet that stand in each motion, and what it demands.
        missing: What further supports would determine.
    """

    demands: tuple[Demands, ...]
    missing: tuple[str, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """Name of each motion, for files."""
        return tuple(one.support.name for one in self.demands)

    @property
    def supports(self) -> tuple[StanceSupport, ...]:
        """Feet that stand in each motion."""
        return tuple(one.support for one in self.demands)

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """Motions as logs of a machine that follows exactly, with contacts and the expected torques."""
        return tuple(
            stance_recording(demands, motion, self.rate)
            for demands, motion in zip(self.demands, self.motions, strict=True)
        )

    @property
    def margins(self) -> tuple[dict[str, float], ...]:
        """Smallest relative margin to each limit of :data:`LIMITS` in each motion."""
        found = []
        for demands, motion in zip(self.demands, self.motions, strict=True):
            least = demands.at(motion.sampled(self.rate)[1]).margins.min(axis=1)
            kinds = np.array(demands.kinds)
            found.append({name: float(least[kinds == k].min()) for k, name in enumerate(LIMITS) if (kinds == k).any()})
        return tuple(found)

    def __repr__(self) -> str:
        """Name the machine, and write duration and precision."""
        names = ", ".join(self.labels)
        return f"StancePlan({self.machine}: {self.duration:g} s on {names}; {self.precision!r})"

    def __str__(self) -> str:
        """Print the motions, their demands on each joint, and the predicted precision."""
        head = [
            f"{self.duration:g} s of motion at {self.rate:g} Hz, each starting and stopping at rest; "
            f"torque noise {self.noise}, joint by joint"
        ]
        for demands, motion, recording in zip(self.demands, self.motions, self.recordings, strict=True):
            head.append(_describe(demands, motion, recording))
        return prediction_text("\n".join(head), self.precision, self.missing)


def plan_stance(
    leg: Leg,
    terms: Sequence[Term] | None = None,
    *,
    feet: Sequence[str] = (BOTH,),
    soles: Mapping[str, Sole] | None = None,
    ground: GroundLimits | None = None,
    duration: float = 60.0,
    rate: float = 100.0,
    limits: MotionLimits | None = None,
    noise: ArrayLike | None = None,
    noise_bandwidth: float = np.inf,
    values: Mapping[str, float] | None = None,
    highest: float = 1.0,
    criterion: Criterion = "worst",
    starts: int = 2,
    seed: int = 0,
    preparation: Preparation | None = None,
    progress: Callable[[float], None] | None = None,
) -> StancePlan:
    """Find the squats, shifts and leg swings that minimise the standard deviations of torso and legs.

    All motions are optimised together. Forces of the ground are not measured.

    Args:
        leg: Planar machine on a floating base; its inertias give the expected forces and torques.
        terms: Terms as for :func:`exoid.identify`.
        feet: Support of each motion: "both" for all feet side by side, a leg ("left") or the link of its foot.
        soles: Sole of each foot by its link; None for those of BLEEX.
        ground: Limits of ground force, knees and feet; None for the default ones.
        duration: Total duration of the motions [s], divided evenly among them.
        rate: Rate of command and log [Hz].
        limits: Limits of the joints; None for those of the URDF.
        noise: Standard deviation of the torque noise [N·m], a number or (n,); None for 2 % of typical torques.
        noise_bandwidth: Frequency up to which the noise spectrum is flat [Hz]; inf for white noise.
        values: Expected parameters by name; None for those of the URDF, and zero for terms.
        highest: Highest frequency of the motion [Hz].
        criterion: Criterion to minimise, see :func:`plan_excitation`. Combinations of parameters that no motion with
            these supports determines do not count.
        starts: Number of starts of the search.
        seed: Seed of the search.
        preparation: Preparation of the later identification; None for the default of :func:`exoid.identify`.
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        Plan with the predicted precision of every parameter.

    Raises:
        ExoidError: The base of the leg does not float, the machine is not planar or has no soles, no motion was found
            within the limits, the duration is too short, or an argument is invalid.

    Example:
        >>> exo = exoid.load_exo("bleex", base="floating")  # doctest: +SKIP
        >>> plan_stance(exo, feet=("both", "left", "right"), noise=(0.5, 0.4, 0.2) * 2)  # doctest: +SKIP
    """
    if criterion not in get_args(Criterion) or starts < 1:
        raise BadArgumentError(
            f"criterion {criterion!r}, {starts} starts",
            remedy=f"use one of {', '.join(get_args(Criterion))}, and at least one start",
        )
    supports = supports_of(leg, feet, _known_soles(leg) if soles is None else soles)
    model = TorqueModel(leg, DEFAULT_TERMS if terms is None else tuple(terms))
    expected, limits, ground = (
        expected_parameters(model, values),
        limits or MotionLimits.of(leg),
        ground or GroundLimits(),
    )

    def on(supports: Sequence[StanceSupport]) -> tuple[tuple[Demands, ...], tuple[MotionLimits, ...]]:
        """Demands on drives and ground, and limits of the coordinates, of each support."""
        knee = np.deg2rad(ground.knee_deg)
        demands = tuple(Demands(one, model, expected, limits.torque, ground) for one in supports)
        return demands, tuple(one.coordinate_limits(limits, knee) for one in supports)

    scales = stance_scales(*on([StanceSupport.of(supports[0].plant, foot) for foot in supports[0].plant.soles]))
    torque_noise = TorqueNoise.of(noise, scales.typical_torque, noise_bandwidth)
    seconds, basis = series(duration / len(supports), rate, highest, 12)
    demands, boxes = on(supports)
    null = null_space(demands, boxes, scales.scale)
    known = 1e8 * null @ null.T  # combinations that no motion determines count as known in the search
    objective = StanceObjective(
        demands=demands,
        limits=boxes,
        scale=scales.scale,
        basis=basis,
        noise=torque_noise,
        seconds=seconds,
        rate=rate,
        prior_information=known,
        pitches=np.zeros(len(demands)),  # the torso moves
    )
    found = search(objective, criterion, starts, np.random.default_rng(seed), progress)
    recordings = [stance_recording(one, motion, rate) for one, motion in zip(demands, found.motions, strict=True)]
    return StancePlan(
        model=model,
        motions=found.motions,
        precision=predict(model, recordings, torque_noise, scales, preparation),
        noise=torque_noise,
        rate=rate,
        criterion=criterion,
        seed=seed,
        costs=tuple(float(np.exp(cost)) for cost in found.costs),
        demands=demands,
        missing=_missing(on, supports, scales, undetermined(model.names, null)),
    )


def stance_recording(demands: Demands, motion: FourierMotion, rate: float) -> Recording:
    """Make the log of a machine that follows a motion exactly, with contacts and the expected torque."""
    # Feet that stand bear the same load each.
    support = demands.support
    time, states = motion.sampled(rate)
    along = np.einsum("pks,p->sk", demands.at(states).columns, demands.expected)
    joints = support.joints(states)
    standing = np.ones(len(time), dtype=np.bool_)
    return Recording(
        time,
        *joints,
        along @ support.directions,
        joint_names=support.leg.joint_names,
        contacts={
            leg.foot: standing if leg in support.stands else ~standing for leg in (*support.stands, *support.swings)
        },
    )


def _known_soles(leg: Leg) -> dict[str, Sole]:
    """Soles of BLEEX at the feet that move."""
    links = {element.get("name") for element in leg.description.parse().findall("link")}
    return {
        link: sole
        for link, sole in BLEEX_SOLES.items()
        if link in links and link_frame(leg.model, leg.description, link).body >= 0
    }


def _missing(
    on: Callable[[Sequence[StanceSupport]], tuple[tuple[Demands, ...], tuple[MotionLimits, ...]]],
    supports: Sequence[StanceSupport],
    scales: Scales,
    loose: Sequence[str],
) -> tuple[str, ...]:
    """Say which further supports would determine what these do not."""
    if not loose:
        return ()
    plant, lines = supports[0].plant, []
    known = {support.name for support in supports}
    others = [name for name in (BOTH, *(limb.label for limb in plant.leg.limbs)) if name and name not in known]
    for added in (*((name,) for name in others), others):
        more = (*supports, *(StanceSupport.of(plant, name) for name in added))
        demands, boxes = on(more)
        null = null_space(demands, boxes, scales.scale)
        line = missing_support(demands[0].model.names, loose, added, null)
        lines += [line] if line else []
        if line and line.endswith(EVERY):
            break
    return tuple(lines)


def _describe(demands: Demands, motion: FourierMotion, recording: Recording) -> str:
    """Ranges of torso and joints in one motion."""
    support, states = demands.support, States(recording.q, recording.v, recording.a)  # type: ignore[arg-type]
    pose = support.torso(states).pose
    ranges = [f"{place.min():.2f} to {place.max():.2f} m" for place in pose[:, :2].T]
    pitch = np.rad2deg([pose[:, 2].min(), pose[:, 2].max()])
    lines = [
        f"{' and '.join(support.feet)}, {motion.duration:g} s: torso forward {ranges[0]}, up {ranges[1]}, "
        f"pitch {pitch[0]:.0f}° to {pitch[1]:.0f}°"
    ]
    angles, torque = np.rad2deg(recording.q), recording.tau
    assert torque is not None
    for j, name in enumerate(recording.joint_names):
        speed = np.abs(states.v[:, j]).max()
        lines.append(
            f"  {name}: {angles[:, j].min():.0f}° to {angles[:, j].max():.0f}°, up to {speed:.1f} rad/s, "
            f"{np.abs(torque[:, j]).max():.0f} N·m"
        )
    return "\n".join(lines)
