"""Assessment of recordings: parameters that they determine, and experiments to add.

Experiments to add are simple motions, each evaluated by its predicted precision.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from exoid._typing import ArrayLike, FloatArray
from exoid.errors import BadArgumentError
from exoid.experiments.limits import MotionLimits
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.leg import Leg
from exoid.leg.reduction.planar import GRAVITY
from exoid.leg.torso import TorsoMotion
from exoid.signals import Preparation, Recording
from exoid.torques import Term, TorqueModel
from exoid.torques.catalog import radians, terms_of
from exoid.torques.position_units import position_units

from .precision import Information, Precision, information_of, on_ground, supports_during
from .scales import STATES, Scales, TorqueNoise, expected_parameters, reference_states
from .text import prediction_text

DURATION = 20.0
"""Duration of each experiment [s]."""


class Advice(NamedTuple):
    """Experiment that improves the precision of some parameters."""

    what: str  # description of the experiment
    parameters: tuple[str, ...]  # names of the parameters
    before: tuple[float, ...]  # relative standard deviations without the experiment
    after: tuple[float, ...]  # relative standard deviations with the experiment

    def __str__(self) -> str:
        """Write the experiment and the change of each standard deviation."""
        gains = zip(self.parameters, self.before, self.after, strict=True)
        changes = ", ".join(f"{name} from {_percent(before)} to {_percent(after)}" for name, before, after in gains)
        return f"add {DURATION:g} s: {self.what} — brings {changes}"


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
        if self.advice:
            more.append("exoid plan without --assess finds the best motion within your limits.")
        return prediction_text(head, p, more)


def assess(
    leg: Leg,
    data: Recording | Sequence[Recording],
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
        data: One recording or several.
        terms: Terms as for :func:`exoid.identify`.
        noise: Standard deviation of the torque noise [N·m], a number or (n,); None for 2 % of typical torques.
        noise_bandwidth: Bandwidth of the torque noise [Hz]; inf for white noise.
        limits: Limits of experiments to add; None for those of the URDF.
        values: Expected parameters by name; None for those of the URDF, and zero for terms.
        preparation: Preparation of the later identification; None for the default of :func:`exoid.identify`.

    Returns:
        Predicted precision, and experiments to add; none to add for a leg on the ground, where each machine has
        motions of its own.

    Raises:
        ExoidError: There is no recording, a joint is missing, a recording is too short for the filter, or a log of a
            leg on the ground has no stretch on links without measured wrenches.
    """
    recordings = [data] if isinstance(data, Recording) else list(data)
    if not recordings:
        raise BadArgumentError("no recordings to assess", remedy="pass at least one")
    model, limits = TorqueModel(leg, terms_of(terms)), limits or MotionLimits.of(leg)
    if stands := on_ground(model, recordings):
        # over random states on the supports of a log, with the least joint torques that hold them
        rng, tables = np.random.default_rng(0), []
        for support, _ in supports_during(model, recordings, preparation):
            q, v, a = reference_states(limits, STATES // 4, rng)
            turn, change, force = rng.uniform(-1.0, 1.0, (3, len(q), 3))
            base = BaseKinematics(turn, change, force + np.array([0.0, 0.0, GRAVITY])) if leg.base_rows else None
            W, shares = support.regressor(q, v, a, base), support.row_shares(q)
            tables.append(W if shares is None else np.einsum("njr,nrp->njp", shares, W))
        scales = Scales.over(expected_parameters(model, values), np.vstack(tables))
    else:
        scales = Scales.of(model, limits, values)
    torque_noise = TorqueNoise.of(noise, scales.typical_torque, noise_bandwidth, model.torque_unit)
    recorded = information_of(model, recordings, torque_noise, preparation)
    advice = () if stands else _advise(model, limits, torque_noise, scales, recorded)
    return Assessment(recorded.precision(model, scales), advice, torque_noise)


def _advise(
    model: TorqueModel, limits: MotionLimits, noise: TorqueNoise, scales: Scales, recorded: Information
) -> tuple[Advice, ...]:
    """Find the simplest experiment for each parameter that is not determined well."""
    now = recorded.precision(model, scales)
    poor = [k for k, grade in enumerate(now.identifiability) if grade != "well"]
    if not poor:
        return ()
    tried: dict[str, Precision] = {
        what: recorded.plus(information_of(model, [recording], noise)).precision(model, scales)
        for what, recording in _experiments(model, limits)
    }
    after = np.array([precision.relative for precision in tried.values()])
    chosen: dict[int, list[int]] = {}
    for k in poor:
        nearly_best = 1.5 * after[:, k].min()  # up to which a simpler experiment is preferred
        if nearly_best < now.relative[k]:
            chosen.setdefault(int(np.argmax(after[:, k] <= nearly_best)), []).append(k)
    descriptions = list(tried)
    return tuple(
        Advice(
            descriptions[row],
            tuple(model.names[k] for k in columns),
            tuple(float(now.relative[k]) for k in columns),
            tuple(float(after[row, k]) for k in columns),
        )
        for row, columns in sorted(chosen.items())
    )


def _experiments(model: TorqueModel, limits: MotionLimits) -> Iterator[tuple[str, Recording]]:
    """Candidate experiments, the simplest first."""
    leg, n = model.leg, len(model.leg.joint_names)
    time = np.arange(round(100.0 * DURATION) + 1) / 100.0
    slow, fast = 0.1, 0.8  # frequencies of a sweep and of a swing [Hz]
    middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * limits.span

    def recording(amplitude: FloatArray, frequency: FloatArray, torso: TorsoMotion | None = None) -> Recording:
        """Record sines of amplitudes [rad] and frequencies [Hz], within the limits."""
        omega = 2.0 * np.pi * frequency
        size = np.minimum(amplitude, np.minimum(limits.velocity / omega, limits.acceleration / omega**2))
        s, c = np.sin(np.multiply.outer(time, omega)), np.cos(np.multiply.outer(time, omega))
        motion = middle + size * s, size * omega * c, -size * omega**2 * s
        return Recording(time, *motion, joint_names=leg.joint_names, torso=torso)

    units = position_units(leg)
    amplitude, tilt = np.deg2rad(15.0), np.deg2rad(25.0)  # of a swing, and of the torso [rad]
    swing = np.minimum(amplitude * radians(leg), half)
    ones: FloatArray = np.ones(n)
    shift: FloatArray = 1.0 + 0.23 * np.arange(n, dtype=np.float64)  # frequencies without a common period
    for j, name in enumerate(leg.joint_names):
        only = np.eye(n)[j]
        yield (
            f"swing {name} quickly, ±{swing[j] / units[j].size:.0f}{units[j].name} at {fast:g} Hz",
            recording(only * swing, fast * ones),
        )
        yield f"sweep {name} slowly over its whole range, at {slow:g} Hz", recording(only * half, slow * ones)
    yield "sweep all joints slowly over their ranges, each at its own frequency", recording(half, slow * shift)
    yield (
        f"swing all joints quickly, each at its own frequency from {fast:g} Hz",
        recording(swing, fast * shift),
    )
    if leg.limbs:
        yield (
            f"tilt the torso by {np.rad2deg(tilt):.0f}° and sweep all joints slowly",
            recording(half, slow * shift, TorsoMotion(pitch=tilt)),
        )


def _percent(x: float) -> str:
    if x < 10.0:
        return f"{100.0 * x:.2g} %" if x < 0.995 else f"{100.0 * x:.0f} %"
    return "not identifiable" if np.isinf(x) else "unknown"
