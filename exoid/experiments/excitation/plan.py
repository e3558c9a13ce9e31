"""Plans of experiments: motions of optimal excitation and the precision that they will give."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, get_args

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.limits import MotionLimits
from exoid.leg.leg import Leg
from exoid.leg.leg_data import refuse_floating_base
from exoid.leg.torso import TorsoMotion
from exoid.signals import Recording
from exoid.torques import Term, TorqueModel
from exoid.torques.catalog import terms_of
from exoid.torques.position_units import position_units

from .fourier import FourierMotion, series
from .objective import Criterion, Objective
from .precision import Precision, information_of
from .scales import Scales, TorqueNoise
from .search import search
from .text import prediction_text


class Peaks(NamedTuple):
    """Range of angle and largest absolute values at each joint, (n,) each."""

    lowest: FloatArray  # smallest angle [rad]
    highest: FloatArray  # largest angle [rad]
    velocity: FloatArray  # largest speed [rad/s]
    acceleration: FloatArray  # largest acceleration [rad/s²]
    torque: FloatArray  # largest expected torque [N·m]; friction of unknown size is not included


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Plan:
    """Planned experiment; prints itself as a table.

    Attributes:
        model: Leg and terms.
        motions: Motion from rest to rest at each torso tilt.
        precision: Predicted precision of each parameter.
        noise: Torque noise of the prediction.
        rate: Rate of command and log [Hz].
        criterion: Criterion that was minimised.
        seed: Seed of the search.
        limits: Motion limits.
    """

    model: TorqueModel
    motions: tuple[FourierMotion, ...]
    precision: Precision
    noise: TorqueNoise
    rate: float
    criterion: Criterion
    seed: int
    limits: MotionLimits

    @property
    def duration(self) -> float:
        """Total duration of the motions [s]."""
        return sum(motion.duration for motion in self.motions)

    @property
    def labels(self) -> tuple[str, ...]:
        """Name of each motion, for files."""
        return tuple(f"tilt{np.rad2deg(motion.pitch):+g}" for motion in self.motions)

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """Motions as logs of a rig that follows exactly, with the expected torques."""
        return tuple(planned_recording(self.model, self.precision.scales, motion, self.rate) for motion in self.motions)

    @property
    def peaks(self) -> Peaks:
        """Range of angle and largest values at each joint."""
        logs = self.recordings
        q, v, a, tau = (np.vstack([getattr(log, name) for log in logs]) for name in ("q", "v", "a", "tau"))
        return Peaks(q.min(axis=0), q.max(axis=0), *(np.abs(x).max(axis=0) for x in (v, a, tau)))

    def __repr__(self) -> str:
        """Name the leg, and write duration and precision."""
        return f"Plan({self.model.leg.description.name}: {self.duration:g} s of motion; {self.precision!r})"

    def __str__(self) -> str:
        """Print the motion, its demands on each joint, and the predicted precision."""
        names = self.model.leg.joint_names
        parts = [f"{self.duration:g} s of motion at {self.rate:g} Hz, starting and stopping at rest"]
        tilts = ", ".join(f"{np.rad2deg(motion.pitch):+.0f}°" for motion in self.motions)
        if any(motion.pitch for motion in self.motions):
            parts[0] += f"; torso at {tilts}, {self.motions[0].duration:g} s each"
        parts.append(f"torque noise {self.noise}, joint by joint")
        p = self.peaks
        for k, (name, (size, unit, rad, torque)) in enumerate(zip(names, position_units(self.model.leg), strict=True)):
            parts.append(
                f"{name}: {p.lowest[k] / size:.0f}{unit} to {p.highest[k] / size:.0f}{unit}, "
                f"up to {p.velocity[k]:.{1 if rad == 'rad' else 2}f} {rad}/s, {p.acceleration[k]:.0f} {rad}/s², "
                f"{p.torque[k]:.0f} {torque}"
            )
        return prediction_text("\n".join(parts), self.precision)


def plan_excitation(
    leg: Leg,
    terms: Sequence[Term] | None = None,
    *,
    duration: float = 60.0,
    rate: float = 100.0,
    limits: MotionLimits | None = None,
    noise: ArrayLike | None = None,
    noise_bandwidth: float = np.inf,
    tilts_deg: Sequence[float] = (0.0,),
    highest: float = 1.0,
    criterion: Criterion = "worst",
    starts: int = 16,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> Plan:
    """Find the motion that minimises the standard deviations of the parameters of a leg.

    Args:
        leg: The leg; its inertias give the expected torques.
        terms: Terms as for :func:`exoid.identify`.
        duration: Total duration of the motions [s], divided evenly among the torso tilts.
        rate: Rate of command and log [Hz].
        limits: Motion limits; None for those of the URDF.
        noise: Standard deviation of the torque noise [N·m], a number or (n,); None for 2 % of typical torques.
        noise_bandwidth: Frequency up to which the noise spectrum is flat [Hz]; inf for white noise.
        tilts_deg: Torso tilts, one for each motion [deg].
        highest: Highest frequency of the motion [Hz].
        criterion: Criterion to minimise: "worst" (largest relative standard deviation) or "d" (volume of the
            confidence ellipsoid).
        starts: Number of starts of the search.
        seed: Seed of the search.
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        Plan with the predicted precision of every parameter.

    Raises:
        ExoidError: The base of the leg floats, no motion was found within the limits, the duration is too short, or an
            argument is invalid.

    Example:
        >>> plan = plan_excitation(leg, duration=60.0, noise=0.3)  # doctest: +SKIP
    """
    refuse_floating_base(leg, "a planned excitation")
    if criterion not in get_args(Criterion):
        raise BadArgumentError(f"no criterion {criterion!r}", remedy=f"use one of {', '.join(get_args(Criterion))}")
    if starts < 1 or not tilts_deg:
        raise BadArgumentError(
            f"{starts} starts, {len(tilts_deg)} tilts", remedy="request at least one start and one tilt"
        )
    model, limits = TorqueModel(leg, terms_of(terms)), limits or MotionLimits.of(leg)
    scales = Scales.of(model, limits)
    torque_noise = TorqueNoise.of(noise, scales.typical_torque, noise_bandwidth, model.torque_unit)
    seconds, basis = series(duration / len(tilts_deg), rate, highest, 24)
    objective = Objective(
        model=model,
        limits=limits,
        scales=scales,
        basis=basis,
        noise=torque_noise,
        seconds=seconds,
        rate=rate,
        pitches=np.deg2rad(np.asarray(tilts_deg, dtype=np.float64)),
    )
    motions = search(objective, criterion, starts, seed, progress)
    recordings = [planned_recording(model, scales, motion, rate) for motion in motions]
    return Plan(
        model=model,
        motions=motions,
        precision=information_of(model, recordings, torque_noise).precision(model, scales),
        noise=torque_noise,
        rate=rate,
        criterion=criterion,
        seed=seed,
        limits=limits,
    )


def planned_recording(model: TorqueModel, scales: Scales, motion: FourierMotion, rate: float) -> Recording:
    """Make the log of a rig that follows a motion exactly, with the expected torque."""
    time = np.arange(round(motion.duration * rate) + 1) / rate  # both ends included
    q, v, a = motion.at(time)
    torso = TorsoMotion(pitch=motion.pitch) if motion.pitch else None
    tau = model.regressor(q, v, a, torso) @ scales.expected
    return Recording(time, q, v, a, tau, joint_names=model.leg.joint_names, torso=torso)
