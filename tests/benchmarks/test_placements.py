"""Batched frames of all joints against a loop over Pinocchio's forward kinematics, on one thread.

``pytest tests/benchmarks/test_placements.py -s`` prints the ratio.
"""

import numpy as np
import pinocchio as pin
from turns import best_of_turns, show

import exoid
from exoid.leg.dynamics import segment_placements

SAMPLES, ROUNDS, FLOOR = 20_000, 3, 8.0
"""The ratio is about 16 on a busy machine."""

OURS, LOOP = "batched", "loop"


def looped(model: pin.Model, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    data, count = model.createData(), model.njoints - 1
    rotation, translation = np.empty((len(q), count, 3, 3)), np.empty((len(q), count, 3))
    for i, row in enumerate(q):
        pin.forwardKinematics(model, data, row)
        for j in range(count):
            rotation[i, j], translation[i, j] = data.oMi[j + 1].rotation, data.oMi[j + 1].translation
    return rotation, translation


def test_batched_frames_are_faster_than_a_loop_over_pinocchios():
    model = exoid.load_exo("bleex", base="floating").model
    q = np.random.default_rng(0).standard_normal((SAMPLES, model.nv))
    works = {OURS: lambda: segment_placements(model, q), LOOP: lambda: looped(model, q)}
    best = best_of_turns(works, ROUNDS)
    show(f"Frames of {SAMPLES:,} samples, six joints", best, OURS)
    assert best[LOOP] >= FLOOR * best[OURS]
