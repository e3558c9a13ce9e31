"""How well does a leg on a walking torso show its parameters, and what do faults of the base's sensor cost?

    python scripts/study_moving_base.py              # one to two minutes on one core; --runs 4 is quicker

Each run is a virtual walk of 60 s at 200 Hz. The torso pitches by 0.12 rad (amplitude of the main frequency, 0.2 rad in
all), and its accelerations are 1 to 3 m/s². Noise: angles 1e-4 rad; torques 0.5, 0.4 and 0.2 N·m; IMU 0.005 rad/s and
0.05 m/s². Torques are Pinocchio's, behind a free-flyer, with all that motion out of the plane adds. The model has no
terms. Errors of X and J are relative to each, those of Y to X of the same segment; the 95 % quantile over parameters
and runs. Coverage is that of 95 % intervals.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

import exoid
from exoid import BaseMotion, Leg, Recording

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from walking import IMU, Walk


def with_base(walk: Walk, gyro: float = 0.0, force: float = 0.0, offset: float = 0.0) -> Recording:
    """A walk whose IMU has a bias about and along each axis, and whose position is wrong."""
    recording = walk.recording()
    assert recording.base is not None
    base = recording.base
    wrong = BaseMotion(base.angular_velocity + gyro, base.specific_force + force, IMU + offset)
    return dataclasses.replace(recording, base=wrong)


def from_pose(walk: Walk) -> Recording:
    """A walk seen by motion capture with noise of 0.2 mm and 1 mrad."""
    rng = np.random.default_rng([walk.seed, 7])
    position, turn = walk.pose
    quaternion = turn.as_quat() + 5e-4 * rng.standard_normal((len(position), 4))
    quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
    base = BaseMotion.from_pose(position + 2e-4 * rng.standard_normal(position.shape), quaternion, walk.time)
    return dataclasses.replace(walk.recording(), base=base)


CASES: dict[str, tuple[dict[str, float], Callable[[Walk], Recording]]] = {
    "IMU": ({}, with_base),
    "gyroscope off by 0.02 rad/s": ({}, lambda walk: with_base(walk, gyro=0.02)),
    "accelerometer off by 0.1 m/s²": ({}, lambda walk: with_base(walk, force=0.1)),
    "position of the IMU off by 20 mm": ({}, lambda walk: with_base(walk, offset=0.02)),
    "motion capture": ({}, from_pose),
    "roll and yaw of 0.05 rad": ({"sideways": 0.05}, with_base),
    "roll and yaw of 0.1 rad": ({"sideways": 0.1}, with_base),
    "roll and yaw of 0.2 rad": ({"sideways": 0.2}, with_base),
    "torso taken for fixed": ({}, lambda walk: dataclasses.replace(walk.recording(), base=None)),
}


def study(leg: Leg, runs: int) -> None:
    """Print a row for each case."""
    names, truth = leg.parameter_names, leg.parameters
    scale = np.array([abs(truth[names.index(name.replace("Y", "X"))]) for name in names])
    print(f"{leg.description.name}: {'X':>26} [%] {'Y/X':>5} [%] {'J':>5} [%]  coverage [%]  findings")
    for title, (settings, log) in CASES.items():
        errors, inside, kinds = [], [], set()
        for seed in range(runs):
            estimate = exoid.identify(leg, log(Walk(leg, seconds=60.0, seed=seed, **settings)), terms=())  # type: ignore[arg-type]
            errors.append(100.0 * np.abs(estimate.values - truth) / scale)
            low, high = estimate.interval(0.95).T
            inside.append((low <= truth) & (truth <= high))
            kinds |= {f"{finding.kind} ({finding.severity})" for finding in estimate.findings}
        of = {kind: np.array([name.startswith(kind) for name in names]) for kind in "XYJ"}
        worst = [np.quantile(np.array(errors)[:, of[kind]], 0.95) for kind in "XYJ"]
        figures = "  ".join(f"{error:9.2f}" for error in worst)
        print(f"{title:34} {figures}  {100.0 * np.mean(inside):10.0f}    {', '.join(sorted(kinds)) or 'none'}")


def main() -> None:
    """Read the options and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=16)
    runs = parser.parse_args().runs
    for name in ("bleex", "cuhk"):
        study(exoid.load_leg(name), runs)


if __name__ == "__main__":
    main()
