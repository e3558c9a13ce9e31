"""What to add to recordings: simple experiments, tried out one by one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from exoid._typing import FloatArray
from exoid.signals import Recording
from exoid.torques import TorqueModel
from exoid.torso import TorsoMotion

from .limits import MotionLimits
from .noise import TorqueNoise
from .precision import Evidence, Precision, evidence
from .scales import Scales

SECONDS, RATE = 20.0, 100.0
"""Of each experiment that is tried [s, Hz]."""

SLOW, FAST = 0.1, 0.8
"""Frequencies of a sweep and of a swing [Hz]."""

SWING = np.deg2rad(15.0)
"""Amplitude of a swing [rad]."""

TILT = np.deg2rad(25.0)
"""Of the torso [rad]."""

AS_GOOD = 1.5
"""A simpler experiment is preferred if it leaves at most this many times the standard deviation."""


class Advice(NamedTuple):
    """One experiment that helps.

    Attributes:
        what: The experiment.
        parameters: Which it helps.
        before: Their relative standard deviations without it.
        after: And with it.
    """

    what: str
    parameters: tuple[str, ...]
    before: tuple[float, ...]
    after: tuple[float, ...]

    def __str__(self) -> str:
        """Say it in words."""
        gains = zip(self.parameters, self.before, self.after, strict=True)
        words = ", ".join(f"{name} from {_percent(before)} to {_percent(after)}" for name, before, after in gains)
        return f"add {SECONDS:g} s: {self.what} — brings {words}"


def advise(
    model: TorqueModel, limits: MotionLimits, noise: TorqueNoise, scales: Scales, known: Evidence
) -> tuple[Advice, ...]:
    """Find the simplest experiment for each parameter that is not determined well.

    Args:
        model: Leg and terms.
        limits: Of the leg.
        noise: Of the torque.
        scales: What standard deviations are compared with.
        known: What the recordings tell.
    """
    now = known.precision(model, scales)
    poor = [k for k, grade in enumerate(now.identifiability) if grade != "well"]
    if not poor:
        return ()
    tried: dict[str, Precision] = {
        what: known.with_more(evidence(model, [recording], noise)).precision(model, scales)
        for what, recording in _experiments(model, limits)
    }
    after = np.array([precision.relative for precision in tried.values()])
    chosen: dict[int, list[int]] = {}
    for k in poor:
        best = after[:, k].min()
        if best < now.relative[k] / AS_GOOD:
            chosen.setdefault(int(np.argmax(after[:, k] <= AS_GOOD * best)), []).append(k)
    whats = list(tried)
    return tuple(
        Advice(
            whats[row],
            tuple(model.names[k] for k in columns),
            tuple(float(now.relative[k]) for k in columns),
            tuple(float(after[row, k]) for k in columns),
        )
        for row, columns in sorted(chosen.items())
    )


def _experiments(model: TorqueModel, limits: MotionLimits) -> Iterator[tuple[str, Recording]]:
    """Experiments to try, the simplest first."""
    leg, n = model.leg, len(model.leg.joint_names)
    time = np.arange(round(SECONDS * RATE) + 1) / RATE
    middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * limits.span

    def recording(amplitude: FloatArray, frequency: FloatArray, torso: TorsoMotion | None = None) -> Recording:
        omega = 2.0 * np.pi * frequency
        size = np.minimum(amplitude, np.minimum(limits.velocity / omega, limits.acceleration / omega**2))
        s, c = np.sin(np.multiply.outer(time, omega)), np.cos(np.multiply.outer(time, omega))
        motion = middle + size * s, size * omega * c, -size * omega**2 * s
        return Recording(time, *motion, joint_names=leg.joint_names, torso=torso)

    ones: FloatArray = np.ones(n)
    shift: FloatArray = 1.0 + 0.23 * np.arange(n, dtype=np.float64)  # frequencies that repeat no pattern
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
    if leg.chain is not None:
        yield (
            f"tilt the torso by {np.rad2deg(TILT):.0f}° and sweep all joints slowly",
            recording(half, SLOW * shift, TorsoMotion(pitch=TILT)),
        )


def _percent(x: float) -> str:
    if x < 10.0:
        return f"{100.0 * x:.2g} %" if x < 0.995 else f"{100.0 * x:.0f} %"
    return "nothing known" if np.isinf(x) else "unknown"
