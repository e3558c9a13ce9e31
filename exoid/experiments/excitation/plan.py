"""Planning an experiment: the motion that will tell most about a leg, and how much that is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, get_args

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import ExoidError
from exoid.leg import Leg
from exoid.signals import Poses, Preparation, Recording
from exoid.tables import to_text
from exoid.torques import DEFAULT_TERMS, Term, TorqueModel
from exoid.torso import TorsoMotion

from .fourier import Basis, FourierMotion
from .limits import MotionLimits
from .noise import TorqueNoise
from .objective import Criterion, Objective
from .poses import choose_poses
from .precision import Precision, StaticRows, evidence
from .scales import Scales
from .search import search
from .text import doubts, precision_table

PERIOD = 10.0
"""Of the Fourier series, about [s]."""

SAMPLES = 24
"""Of the search for each period of the highest harmonic."""

FEWEST, MOST = 3, 20
"""Harmonics."""


class Peaks(NamedTuple):
    """Largest absolute values that a plan asks of each joint, (n,) each, and its range of angle.

    Attributes:
        lowest: [rad].
        highest: [rad].
        velocity: [rad/s].
        acceleration: [rad/s²].
        torque: Expected, friction not counted where it is unknown [N·m].
    """

    lowest: FloatArray
    highest: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    torque: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class Plan:
    """An experiment that was planned; prints itself.

    Attributes:
        model: Leg and terms it is for.
        motions: One for each torso tilt, starting and stopping at rest.
        poses: To be held besides, reached from both sides, for each torso tilt; or none.
        precision: What it will tell.
        limits: What it keeps.
        noise: What it reckons with.
        rate: At which it is commanded and logged [Hz].
        criterion: What was minimised.
        seed: Of the search.
        costs: Of the motions that the better starts ended at, the best first: relative standard deviations for "worst".
    """

    model: TorqueModel
    motions: tuple[FourierMotion, ...]
    poses: tuple[Poses, ...]
    precision: Precision
    limits: MotionLimits
    noise: TorqueNoise
    rate: float
    criterion: Criterion
    seed: int
    costs: tuple[float, ...]

    @property
    def duration(self) -> float:
        """Of all motions [s]."""
        return sum(motion.duration for motion in self.motions)

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """Motions as a rig would log them that follows perfectly, with the torques expected."""
        return tuple(as_recording(self.model, self.precision.scales, motion, self.rate) for motion in self.motions)

    @property
    def peaks(self) -> Peaks:
        """What it asks of the joints."""
        q, v, a, tau = (
            np.vstack([getattr(recording, name) for recording in self.recordings]) for name in ("q", "v", "a", "tau")
        )
        return Peaks(q.min(axis=0), q.max(axis=0), *(np.abs(x).max(axis=0) for x in (v, a, tau)))

    def __str__(self) -> str:
        """Say what will be known, what is asked of the leg, and what will not be known."""
        names = self.model.leg.joint_names
        parts = [f"{self.duration:g} s of motion at {self.rate:g} Hz, starting and stopping at rest"]
        tilts = ", ".join(f"{np.rad2deg(motion.pitch):+.0f}°" for motion in self.motions)
        if any(motion.pitch for motion in self.motions):
            parts[0] += f"; torso at {tilts}, {self.motions[0].duration:g} s each"
        if self.poses:
            parts.append(f"{sum(map(len, self.poses))} poses, each reached from both sides")
        parts.append(f"torque noise {self.noise}, joint by joint")
        p = self.peaks
        for k, name in enumerate(names):
            parts.append(
                f"{name}: {np.rad2deg(p.lowest[k]):.0f}° to {np.rad2deg(p.highest[k]):.0f}°, "
                f"up to {p.velocity[k]:.1f} rad/s, {p.acceleration[k]:.0f} rad/s², {p.torque[k]:.0f} N·m"
            )
        text = to_text("\n".join(parts), precision_table(self.precision))
        closing = [f"condition number {self.precision.condition_number:.0f}", *doubts(self.precision)]
        return text + "\n\n" + "\n".join(closing)


def plan_excitation(
    leg: Leg,
    terms: Sequence[Term] | None = None,
    *,
    duration: float = 60.0,
    rate: float = 100.0,
    limits: MotionLimits | None = None,
    noise: ArrayLike | None = None,
    noise_bandwidth: float = np.inf,
    values: Mapping[str, float] | None = None,
    tilts_deg: Sequence[float] = (0.0,),
    poses: int = 0,
    highest: float = 1.0,
    criterion: Criterion = "worst",
    starts: int = 16,
    seed: int = 0,
    preparation: Preparation | None = None,
    progress: Callable[[float], None] | None = None,
) -> Plan:
    """Find the motion after which the parameters of a leg will be known best.

    Args:
        leg: The leg; its inertias say what torques to expect.
        terms: As for :func:`exoid.identify`.
        duration: Of all motions together [s], shared evenly among the torso tilts.
        rate: At which the motion is commanded and logged [Hz].
        limits: What must not be exceeded; None for those of the URDF.
        noise: Standard deviation of the torque noise [N·m], a number or (n,); None for 2 % of typical torques.
        noise_bandwidth: Up to where its spectrum is flat [Hz]; inf for white noise.
        values: Parameters to expect by name; None for the URDF's, and zero for terms.
        tilts_deg: Torso tilts at which a motion is made [deg].
        poses: Held besides at each tilt.
        highest: Highest frequency of the motion [Hz].
        criterion: "worst" (smallest largest relative standard deviation), "a" (of their squares' sum) or "d" (smallest
            volume of the confidence ellipsoid).
        starts: Motions that the search starts from.
        seed: Of the search.
        preparation: With which will be identified; None for that of :func:`exoid.identify`.
        progress: Told the share that is done.

    Returns:
        The plan, with the predicted precision of every parameter.

    Raises:
        ExoidError: Limits admit no motion, the duration is too short, or an option makes no sense.

    Example:
        >>> plan = plan_excitation(leg, duration=60.0, noise=0.3)  # doctest: +SKIP
    """
    if criterion not in get_args(Criterion):
        raise ExoidError(f"no criterion {criterion!r}", remedy=f"use one of {', '.join(get_args(Criterion))}")
    if starts < 1 or poses < 0 or not tilts_deg:
        raise ExoidError(
            f"{starts} starts, {poses} poses, {len(tilts_deg)} tilts",
            remedy="at least one start and one tilt, and no negative number of poses",
        )
    model, limits = TorqueModel(leg, DEFAULT_TERMS if terms is None else tuple(terms)), limits or MotionLimits.of(leg)
    scales = Scales.of(model, limits, values)
    assumed = TorqueNoise.of(noise, scales.typical, noise_bandwidth)
    seconds, basis = _series(duration / len(tilts_deg), rate, highest)
    tilts, rng = np.deg2rad(np.asarray(tilts_deg, dtype=np.float64)), np.random.default_rng(seed)
    held = choose_poses(model, limits, assumed, scales, tilts, poses, rng) if poses else ()
    known = evidence(model, map(StaticRows, held), assumed)
    scaled = known.R * scales.scale
    objective = Objective(model, basis, tilts, limits, assumed, scales, seconds, rate, scaled.T @ scaled)
    found = search(objective, criterion, starts, rng, progress)
    recordings = [as_recording(model, scales, motion, rate) for motion in found.motions]
    precision = known.with_more(evidence(model, recordings, assumed, preparation)).precision(model, scales)
    costs = tuple(float(np.exp(cost)) for cost in found.costs)
    return Plan(model, found.motions, held, precision, limits, assumed, rate, criterion, seed, costs)


def as_recording(model: TorqueModel, scales: Scales, motion: FourierMotion, rate: float) -> Recording:
    """Log a motion that is followed perfectly, with the torque expected."""
    time, (q, v, a) = motion.sampled(rate)
    torso = TorsoMotion(pitch=motion.pitch) if motion.pitch else None
    tau = model.regressor(q, v, a, torso) @ scales.values
    return Recording(time, q, v, a, tau, joint_names=model.leg.joint_names, torso=torso)


def _series(duration: float, rate: float, highest: float) -> tuple[float, Basis]:
    """Duration of each motion in whole samples, and the functions it is made of."""
    if not (0.0 < duration < np.inf and 0.0 < rate < np.inf and 0.0 < highest < np.inf):
        raise ExoidError(
            f"{duration:g} s at {rate:g} Hz, up to {highest:g} Hz", remedy="give positive numbers in s and Hz"
        )
    if rate < SAMPLES * highest:
        raise ExoidError(
            f"a motion of up to {highest:g} Hz at {rate:g} Hz",
            remedy=f"sample it at {SAMPLES * highest:g} Hz at least, or move more slowly",
        )
    seconds = round(duration * rate) / rate
    period = seconds / max(1, round(seconds / PERIOD))
    harmonics = min(int(highest * period + 1e-9), MOST)
    if harmonics < FEWEST:
        raise ExoidError(
            f"{duration:g} s are too short for {FEWEST} harmonics up to {highest:g} Hz",
            remedy=f"move for at least {FEWEST / highest:g} s at each torso tilt, or allow higher frequencies",
        )
    return seconds, Basis.make(period, harmonics, SAMPLES * harmonics)
