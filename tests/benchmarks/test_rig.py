"""Speed of the rig, as ratios measured in one process, in turns: ``pytest tests/benchmarks/test_rig.py -s``."""

import time

import numpy as np
import pytest
from turns import best_of_turns

import exoid
from exoid.rig import Plant, Stepper, Wearer
from exoid.rig.worn_stepper import WornStepper

RIGS, STEPS, ROUNDS, DT = 256, 400, 25, 5e-4

LEG = exoid.load_leg("bleex")
POSE = np.array([[0.3], [-0.5], [0.1]])
PLANT = Plant.build(
    LEG, {"c0_hip": 2.0, "c0_knee": 1.5, "c0_ankle": 0.5, "b1_knee": 2.0, "d_hip": 0.1, "Ia_hip": 0.1}, end_stops=False
)
TIME = DT * np.arange(ROUNDS * STEPS)
TORQUE = np.array([14.0, 7.0, 1.5]) * np.sin(2 * np.pi * np.array([0.5, 0.7, 0.9]) * TIME[:, None])
"""Keeps the leg swinging, with stops and turns of every joint [N·m], (N, 3)."""


class Single:
    """One rig, its torque another one in each step."""

    def __init__(self) -> None:
        self.rig = Stepper(PLANT, POSE, np.zeros((3, 1)), DT)

    def run(self, first: int) -> int:
        step, damping = self.rig.step, np.zeros((3, 1))
        for torque in TORQUE[first : first + STEPS, :, None]:
            step(torque, damping)
        return STEPS


class Batch:
    """Many rigs, each with a torque of its own."""

    def __init__(self) -> None:
        self.share = np.random.default_rng(0).uniform(0.7, 1.3, (3, RIGS))
        self.rig = Stepper(PLANT.repeat(RIGS), np.tile(POSE, RIGS), np.zeros((3, RIGS)), DT)

    def run(self, first: int) -> int:
        step, damping = self.rig.step, np.zeros((3, RIGS))
        torques = TORQUE[first : first + STEPS, :, None] * self.share
        for torque in torques:
            step(torque, damping)
        return STEPS * RIGS


@pytest.fixture(scope="module")
def speeds():
    """Rig-steps a second of each, best of several rounds taken in turns."""
    runners = {kind.__name__: kind() for kind in (Single, Batch)}
    best = dict.fromkeys(runners, 0.0)
    for k in range(ROUNDS):
        for name, runner in runners.items():
            begin = time.process_time()
            count = runner.run(k * STEPS)
            best[name] = max(best[name], count / (time.process_time() - begin))
    for name, speed in best.items():
        print(f"\n{name:13s} {speed:10.3g} rig-steps/s", end="")
    return best


def test_256_rigs_at_once_take_many_times_the_steps_of_a_single_one(speeds):
    ratio = speeds["Batch"] / speeds["Single"]
    print(f"\n256 rigs / single rig: {ratio:.1f}")
    assert ratio > 12.0


@pytest.mark.parametrize(("rigs", "limit"), [(1, 12.0), (16, 4.5), (256, 4.5)])
def test_a_worn_step_takes_a_few_times_as_long_as_a_step(rigs, limit):
    plant = PLANT.repeat(rigs)
    start = np.tile(POSE, rigs), np.zeros((3, rigs)), DT
    alone, worn = Stepper(plant, *start), WornStepper(Stepper(plant, *start), Wearer.build(LEG), 3000)
    still = np.zeros((3, rigs))
    best = best_of_turns({"alone": lambda: alone.step(still, still), "worn": lambda: worn.step(still, still)}, 6)
    ratio = best["worn"] / best["alone"]
    print(f"\n{rigs} rigs, worn / alone: {ratio:.2f}")
    assert ratio < limit
