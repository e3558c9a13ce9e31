"""Experiments to add to recordings: simple motions, each evaluated by its predicted precision."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.leg.torso import TorsoMotion
from exoid.signals import Recording
from exoid.torques import TorqueModel

from .limits import MotionLimits
from .noise import TorqueNoise
from .precision import Information, Precision, information_of
from .scales import Scales

DURATION, RATE = 20.0, 100.0
"""Duration [s] and rate [Hz] of each experiment."""

SLOW, FAST = 0.1, 0.8
"""Frequencies of a slow sweep and of a fast swing [Hz]."""

SWING = np.deg2rad(15.0)
"""Amplitude of a swing [rad]."""

TILT = np.deg2rad(25.0)
"""Tilt of the torso [rad]."""

NEARLY_BEST = 1.5
"""Largest ratio to the best standard deviation at which a simpler experiment is preferred."""


class Advice(NamedTuple):
    """Experiment that improves the precision of some parameters.

    Attributes:
        what: Description of the experiment.
        parameters: Names of the parameters.
        before: Relative standard deviations without the experiment.
        after: Relative standard deviations with the experiment.
    """

    what: str
    parameters: tuple[str, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]

    def __str__(self) -> str:
        """Write the experiment and the change of each standard deviation."""
        gains = zip(self.parameters, self.before, self.after, strict=True)
        changes = ", ".join(f"{name} from {_percent(before)} to {_percent(after)}" for name, before, after in gains)
        return f"add {DURATION:g} s: {self.what} — brings {changes}"


def advise(
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
        best = after[:, k].min()
        if best < now.relative[k] / NEARLY_BEST:
            chosen.setdefault(int(np.argmax(after[:, k] <= NEARLY_BEST * best)), []).append(k)
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
    time = np.arange(round(DURATION * RATE) + 1) / RATE
    middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * limits.span

    def recording(amplitude: FloatArray, frequency: FloatArray, torso: TorsoMotion | None = None) -> Recording:
        """Record sines of amplitudes [rad] and frequencies [Hz], within the limits."""
        omega = 2.0 * np.pi * frequency
        size = np.minimum(amplitude, np.minimum(limits.velocity / omega, limits.acceleration / omega**2))
        s, c = np.sin(np.multiply.outer(time, omega)), np.cos(np.multiply.outer(time, omega))
        motion = middle + size * s, size * omega * c, -size * omega**2 * s
        return Recording(time, *motion, joint_names=leg.joint_names, torso=torso)

    ones: FloatArray = np.ones(n)
    shift: FloatArray = 1.0 + 0.23 * np.arange(n, dtype=np.float64)  # frequencies without a common period
    for j, name in enumerate(leg.joint_names):
        only = np.eye(n)[j]
        yield (
            f"swing {name} quickly, ±{np.rad2deg(min(SWING, half[j])):.0f}° at {FAST:g} Hz",
            recording(only * np.minimum(SWING, half), FAST * ones),
        )
        yield f"sweep {name} slowly over its whole range, at {SLOW:g} Hz", recording(only * half, SLOW * ones)
    yield "sweep all joints slowly over their ranges, each at its own frequency", recording(half, SLOW * shift)
    yield (
        f"swing all joints quickly, each at its own frequency from {FAST:g} Hz",
        recording(np.minimum(SWING, half), FAST * shift),
    )
    if leg.limbs:
        yield (
            f"tilt the torso by {np.rad2deg(TILT):.0f}° and sweep all joints slowly",
            recording(half, SLOW * shift, TorsoMotion(pitch=TILT)),
        )


def _percent(x: float) -> str:
    if x < 10.0:
        return f"{100.0 * x:.2g} %" if x < 0.995 else f"{100.0 * x:.0f} %"
    return "not identifiable" if np.isinf(x) else "unknown"
