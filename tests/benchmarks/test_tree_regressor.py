"""The batched regressor of any tree of joints against loops over Pinocchio's, on one thread.

``pytest tests/benchmarks/test_tree_regressor.py -s`` prints the ratios: a seven-joint arm, and two planar legs on a
base that floats, in the sagittal plane or with all six degrees of freedom.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import pytest
from public_robots import urdf_of
from turns import best_of_turns, looped, show, with_memory

import exoid
from exoid.leg.catalog import URDFS, urdf_folder
from exoid.leg.reduction.numeric import numeric
from exoid.leg.reduction.tree import Tree
from exoid.leg.reduction.tree_regressor import BaseSamples, fill_tree_regressor

SAMPLES, MANY, CHECKED, ROUNDS = 25_000, 100_000, 500, 2
EXTRA_MEMORY = 200e6
"""Bytes beyond the output of MANY samples."""
FLOORS = {
    "seven-joint arm": (0.9, 1.2, 1.7),
    "two legs, sagittal base": (1.5, 2.2, 2.7),
    "two legs, free base": (0.6, 1.0, 1.7),
}
"""Ratios to the three loops below which something has become slower; see BENCHMARKS.md for those measured."""

OURS, BARE, STORED, SELECTED = "batched, output allocated", "loop, discarded", "loop, stored", "selection alone"


class Robot(NamedTuple):
    """Something with a regressor.

    Attributes:
        model: Pinocchio's model.
        motion: Configurations, velocities and accelerations of it.
        columns: Columns of its base parameters.
        batched: Regressor of exoid, (N, rows, p).
    """

    model: pin.Model
    motion: tuple[np.ndarray, ...]
    columns: np.ndarray
    batched: Callable[[], np.ndarray]


def stored(robot: Robot) -> np.ndarray:
    return looped(robot.model, robot.motion, np.empty((SAMPLES, robot.model.nv, 10 * (robot.model.njoints - 1))))


def arm(samples: int) -> Robot:
    leg = exoid.Leg.from_urdf(urdf_of("panda"), joints=tuple(f"panda_joint{k}" for k in range(1, 8)))
    motion = tuple(np.random.default_rng(0).standard_normal((3, samples, 7)))
    return Robot(leg.model, motion, leg.reduction.columns, lambda: leg.regressor(*motion))


def batched(model: pin.Model, joints: tuple[np.ndarray, ...], columns: np.ndarray, base: BaseSamples | None = None):
    tree = Tree.from_model(model)

    def regressor() -> np.ndarray:
        out = np.zeros((len(columns), tree.rows, len(joints[0])))
        fill_tree_regressor(tree, *joints, columns, out, base)
        return out.transpose(2, 1, 0)

    return regressor


def free_base(samples: int) -> Robot:
    """Both legs of BLEEX and the torso, with Pinocchio's free-flyer."""
    model, rng = free_model(), np.random.default_rng(1)
    quaternion = rng.standard_normal((samples, 4))
    x, y, z, w = (quaternion / np.linalg.norm(quaternion, axis=1)[:, None]).T
    q = np.column_stack([rng.standard_normal((samples, 3)), x, y, z, w, rng.standard_normal((samples, 6))])
    v, a = rng.standard_normal((2, samples, model.nv))
    up = np.column_stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)])
    base = BaseSamples(v[:, :6], a[:, :6] + np.hstack([9.81 * up, np.zeros((samples, 3))]))
    # all ten parameters of the torso, and of each segment what its own joint shows: the moments and inertias that a
    # turn about y does not leave to the body before it
    segment = np.array([1, 3, 5, 6, 7, 8, 9])
    columns = np.concatenate([np.arange(10), *(10 * body + segment for body in range(1, 7))])
    return Robot(model, (q, v, a), columns, batched(model, (q[:, 7:], v[:, 6:], a[:, 6:]), columns, base))


def sagittal_base(samples: int) -> Robot:
    """The same on a base that moves forward, up and in pitch only."""
    free, model = free_model(), pin.Model()
    torso = 0
    for joint, name in ((pin.JointModelPX(), "x"), (pin.JointModelPZ(), "z"), (pin.JointModelRY(), "pitch")):
        torso = model.addJoint(torso, joint, pin.SE3.Identity(), name)
    for j in range(2, free.njoints):
        parent = free.parents[j] + 2
        model.addJoint(parent, free.joints[j], free.jointPlacements[j], free.names[j])
    for j in range(1, free.njoints):
        model.appendBodyToJoint(j + 2, free.inertias[j], pin.SE3.Identity())
    motion = tuple(np.random.default_rng(2).standard_normal((3, samples, model.nv)))
    columns = numeric(model, list(model.names)[1:]).columns
    return Robot(model, motion, columns, batched(model, motion, columns))


def free_model() -> pin.Model:
    return pin.buildModelFromUrdf(str(urdf_folder() / URDFS["bleex", "cad"]), pin.JointModelFreeFlyer())


MAKERS = dict(zip(FLOORS, (arm, sagittal_base, free_base), strict=True))


@pytest.fixture(scope="module", params=list(FLOORS))
def case(request):
    """Name and robot."""
    return request.param, MAKERS[request.param](SAMPLES)


def test_the_batched_regressor_is_faster_than_loops_over_pinocchios(case):
    name, robot = case
    Y = stored(robot)
    works = {
        OURS: robot.batched,
        BARE: lambda: looped(robot.model, robot.motion),
        STORED: lambda: stored(robot),
        SELECTED: lambda: Y[..., robot.columns],
    }
    best = best_of_turns(works, ROUNDS)
    rows, parameters = robot.model.nv, len(robot.columns)
    show(f"Regressor of {SAMPLES:,} samples, {name}: {rows} rows, {parameters} base parameters", best, OURS)
    loops = best[BARE], best[STORED], best[STORED] + best[SELECTED]
    print(f"  loop, stored and reduced to base parameters: {loops[-1] / best[OURS]:.2f} ×")
    for seconds, floor in zip(loops, FLOORS[name], strict=True):
        assert seconds >= floor * best[OURS]


def test_the_batched_regressor_needs_little_memory_beyond_its_output(case):
    W, peak = with_memory(MAKERS[case[0]](MANY).batched)
    print(f"\n{(peak - W.nbytes) / 1e6:.1f} MB beyond the output of {W.nbytes / 1e6:.0f} MB")
    assert peak - W.nbytes <= EXTRA_MEMORY
