"""The batched regressor of any tree of joints against Pinocchio's, sample by sample."""

import tracemalloc

import numpy as np
import pinocchio as pin
import pytest
from planar_chains import assert_relative, joint_torque_regressor, pinocchios_regressor, random_motion

from exoid.leg.reduction import tree_regressor as batched
from exoid.leg.reduction.tree import Tree
from exoid.leg.reduction.tree_regressor import BaseSamples, fill_tree_regressor

TOLERANCE = 1e-12
SMALL_BLOCK = 7
"""Samples computed at once in the tests, so that there are several blocks, the last of them shorter."""

KINDS = (
    *(pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ, pin.JointModelRUBX, pin.JointModelRUBZ),
    *(pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ),
)


@pytest.fixture
def small_blocks(monkeypatch):
    monkeypatch.setattr(batched, "BLOCK", SMALL_BLOCK)


def random_joint(rng: np.random.Generator) -> pin.JointModel:
    """Along a coordinate axis, against one, or oblique."""
    choice = rng.integers(4)
    axis = rng.standard_normal(3) if choice == 0 else -np.eye(3)[rng.integers(3)]
    axis = axis / np.linalg.norm(axis)
    if choice < 2:
        return (pin.JointModelRevoluteUnaligned if rng.integers(2) else pin.JointModelPrismaticUnaligned)(axis)
    return KINDS[rng.integers(len(KINDS))]()


def random_tree(rng: np.random.Generator, joints: int, *, floating: bool = False) -> pin.Model:
    model = pin.Model()
    if floating:
        model.addJoint(0, pin.JointModelFreeFlyer(), random_placement(rng), "base")
    for j in range(joints):
        parent = int(rng.integers(int(floating), model.njoints))
        model.addJoint(parent, random_joint(rng), random_placement(rng), f"joint{j}")
    model.gravity.linear = rng.standard_normal(3) * 5.0
    return model


def random_placement(rng: np.random.Generator) -> pin.SE3:
    return pin.SE3(pin.exp3(rng.standard_normal(3)), rng.standard_normal(3))


def regressor(model: pin.Model, q, v, a, columns=None, base=None) -> np.ndarray:
    """Columns of the batched regressor, (N, rows, p)."""
    tree = Tree.from_model(model)
    columns = np.arange(10 * tree.bodies) if columns is None else columns
    out = np.zeros((len(columns), tree.rows, len(q)))
    fill_tree_regressor(tree, q, v, a, columns, out, base)
    return out.transpose(2, 1, 0)


@pytest.mark.usefixtures("small_blocks")
def test_random_trees_have_pinocchios_regressor_in_any_columns():
    rng = np.random.default_rng(0)
    for number in range(80):
        model = random_tree(rng, 1 + number % 9)
        motion = random_motion(rng, model.nv, 3 * SMALL_BLOCK + 2)
        expected, some = joint_torque_regressor(model, *motion), rng.random(10 * model.nv) < 0.4
        for columns in (None, np.flatnonzero(some)):
            chosen = expected if columns is None else expected[..., some]
            found, size = regressor(model, *motion, columns), np.abs(expected).max()
            np.testing.assert_allclose(found, chosen, rtol=0, atol=TOLERANCE * size)


def floating_motion(rng: np.random.Generator, model: pin.Model, samples: int):
    """Configurations, velocities and accelerations for Pinocchio, and the motion of the base for exoid."""
    q = np.array([pin.integrate(model, pin.neutral(model), rng.standard_normal(model.nv)) for _ in range(samples)])
    v, a = rng.standard_normal((2, samples, model.nv)) * [[[3.0]], [[10.0]]]
    placement = model.jointPlacements[1].rotation
    turned = [(placement @ pin.Quaternion(row[3:7]).matrix()).T @ model.gravity.linear for row in q]
    acceleration = a[:, :6] - np.hstack([turned, np.zeros((samples, 3))])
    return q, v, a, BaseSamples(v[:, :6], acceleration)


@pytest.mark.usefixtures("small_blocks")
def test_random_trees_on_a_floating_base_have_pinocchios_regressor():
    rng = np.random.default_rng(5)
    for number in range(40):
        model = random_tree(rng, number % 6, floating=True)
        continuous = [j for j in range(2, model.njoints) if model.nqs[j] == 2]
        q, v, a, base = floating_motion(rng, model, 2 * SMALL_BLOCK + 3)
        angles = np.empty((len(q), model.njoints - 2))
        for j in range(2, model.njoints):
            here = model.idx_qs[j]
            angles[:, j - 2] = np.arctan2(q[:, here + 1], q[:, here]) if j in continuous else q[:, here]
        found = regressor(model, angles, v[:, 6:], a[:, 6:], base=base)
        assert_relative(found, pinocchios_regressor(model, q, v, a), TOLERANCE)


@pytest.mark.parametrize("joints", [7, 60])
def test_memory_beside_the_output_does_not_grow_with_samples_or_joints(joints):
    model = pin.Model()
    for j in range(joints):  # one long chain
        model.addJoint(j, pin.JointModelRY(), pin.SE3(np.eye(3), np.array([0.1, 0.0, 0.0])), f"joint{j}")
    columns, samples = np.array([1, 11]), 10_000
    motion = random_motion(np.random.default_rng(9), joints, samples)
    tree, out = Tree.from_model(model), np.zeros((2, joints, samples))
    tracemalloc.start()
    try:
        fill_tree_regressor(tree, *motion, columns, out)
        assert tracemalloc.get_traced_memory()[1] < 80e6
    finally:
        tracemalloc.stop()
