"""Share of measured torques inside the 95 % band at the speed of the training, and at twice that speed.

A log is a minute of a motion of five harmonics with exact torques of Pinocchio, friction of one form, white noise of
the torques and of the angles (1e-4 rad). The leg is identified with the default terms from a slow motion. The bands are
tested on other motions, with and without the model error of the estimate:

    python scripts/study_bands.py --seeds 5

The real recording (--real) is identified from its slow first 21 s and tested on the two faster parts after it.
"""

from __future__ import annotations

import argparse
import dataclasses

import numpy as np

import exoid
from exoid import Estimate, Leg, Recording
from exoid._typing import FloatArray
from exoid.tools.tables import make_table, to_text
from exoid.torques import Presliding

RATE, SECONDS, SLOW = 100.0, 60.0, 0.1
"""Samples a second [Hz], duration [s], and first harmonic of the training [Hz]."""

FORMS = ("coulomb", "stribeck", "presliding", "presliding and stribeck", "quadratic", "power 0.6")
"""Forms of friction; the terms have only the first."""


def motion(leg: Leg, base: float, seed: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Time, angles, velocities and accelerations of five harmonics."""
    rng, joints = np.random.default_rng(seed), len(leg.joint_names)
    time = np.arange(int(SECONDS * RATE)) / RATE
    omega = 2.0 * np.pi * base * np.arange(1, 6)
    size = 0.42 * rng.uniform(0.4, 1.0, (joints, 5)) / np.array([1.0, 1.2, 1.5, 2.0, 2.5])
    phase = np.multiply.outer(time, omega)[:, None, :] + rng.uniform(0.0, 2.0 * np.pi, (joints, 5))
    q, v = (size * np.sin(phase)).sum(-1), (size * omega * np.cos(phase)).sum(-1)
    return time, q, v, -(size * omega**2 * np.sin(phase)).sum(-1)


def friction(form: str, q: FloatArray, v: FloatArray) -> FloatArray:
    """Friction over the RMS torque of each joint, (N, n)."""
    sign = np.tanh(v / 0.01)
    if "presliding" in form:
        sign = np.column_stack([Presliding(8e-3).states(q[:, j], v[:, j]) for j in range(q.shape[1])])
    if form == "quadratic":
        return 0.06 * sign + 0.02 * v + 0.015 * v * np.abs(v)
    if form.startswith("power"):
        return 0.06 * sign + 0.04 * sign * np.abs(v) ** 0.6
    falling = 1.0 + 0.6 * np.exp(-((v / 0.3) ** 2)) if "stribeck" in form else 1.0
    return 0.06 * sign * falling + 0.03 * v


def log(leg: Leg, form: str, base: float, seed: int) -> Recording:
    """Make one log."""
    size = np.sqrt((leg.inverse_dynamics(*motion(leg, SLOW, 1)[1:]) ** 2).mean(axis=0))
    time, q, v, a = motion(leg, base, seed)
    rng = np.random.default_rng(seed)
    tau = leg.inverse_dynamics(q, v, a) + size * friction(form, q, v) + rng.normal(scale=0.03 * size, size=q.shape)
    return Recording(time, q + rng.normal(scale=1e-4, size=q.shape), tau=tau, joint_names=leg.joint_names)


def shares(estimate: Estimate, recording: Recording) -> tuple[FloatArray, FloatArray]:
    """Share inside the band of each joint without and with the model error, (n,) each."""
    bare = dataclasses.replace(estimate, model_error=None)
    return exoid.validate(bare, recording).coverage, exoid.validate(estimate, recording).coverage


def row(label: str, cells: list[tuple[FloatArray, FloatArray]]) -> tuple[str, ...]:
    """Mean and smallest share of any joint and log, without and with the model error."""
    return (label, *(f"{np.mean(side):.2f} ({np.min(side):.2f})" for side in zip(*cells, strict=True)))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=5, help="logs of each leg and form")
    parser.add_argument("--real", action="store_true", help="the DFKI recording instead")
    options = parser.parse_args()
    rows = []
    if options.real:
        data = exoid.datasets.dfki_double_pendulum()
        slow = exoid.identify(data.leg, data.train.between(0.0, 21.0))
        for start, stop in ((21.0, 33.0), (36.0, 48.0)):
            cells = [shares(slow, data.train.between(start, stop))]
            rows.append(row(f"0 to 21 s, tested on {start:g} to {stop:g} s", cells))
        rows.append(row("train, test", [shares(exoid.identify(data.leg, data.train), data.test)]))
    else:
        legs = [exoid.load_leg(name) for name in ("bleex", "cuhk")]
        for form in FORMS:
            pairs = [(leg, seed) for leg in legs for seed in range(1, options.seeds + 1)]
            found = [(leg, seed, exoid.identify(leg, log(leg, form, SLOW, seed))) for leg, seed in pairs]
            for times in (1.0, 2.0):
                each = [shares(one, log(leg, form, times * SLOW, 100 + seed)) for leg, seed, one in found]
                cells = [tuple(np.array([side.mean()]) for side in pair) for pair in each]
                rows.append(row(f"{form}, {times:g} × speed", cells))
    headers = ("friction and test", "parameters and noise only", "with model error")
    print(to_text("Share inside the 95 % band: mean (smallest of a log)", make_table(headers, rows)))


if __name__ == "__main__":
    main()
