"""The documents' experiments as data: printed values are kept, assumed ones are within the limits."""

import numpy as np
import pytest

import exoid
from exoid.errors import ExoidError
from exoid.experiments import Harmonics, bleex, cuhk, healthy_gait
from exoid.experiments.limits import refuse_motion_beyond_limits, refuse_poses_beyond_limits
from exoid.torques import TorqueModel


@pytest.fixture(scope="module")
def sets():
    return bleex.static_sets(np.random.default_rng(0))


def absolute(poses):
    return np.cumsum(poses, axis=1)


def test_all_poses_and_motions_are_within_the_limits(sets, leg):
    refuse_poses_beyond_limits(leg, sets.all)
    refuse_motion_beyond_limits(leg, bleex.dynamic_motions(), 22.0)
    other = exoid.load_leg("cuhk")
    refuse_poses_beyond_limits(other, cuhk.stiffness_poses())
    refuse_poses_beyond_limits(other, cuhk.random_poses(np.random.default_rng(0)))
    for motion in (cuhk.swing(0), cuhk.swing(1), cuhk.validation_motion(), healthy_gait()):
        refuse_motion_beyond_limits(other, motion, 20.0)


def test_gravity_at_knee_and_ankle_is_the_same_within_their_sets(sets):
    for joint, poses, numbers, degrees in ((2, sets.ankle, sets.ankle_set, 70.0), (1, sets.knee, sets.knee_set, 50.0)):
        for of_set in (poses[numbers == number] for number in np.unique(numbers)):
            assert np.ptp(absolute(of_set)[:, joint:], axis=0).max() < 1e-12
            assert np.ptp(of_set[:, joint]) > np.deg2rad(degrees)


def test_pairs_are_half_a_turn_apart_at_the_same_ankle_angle(sets):
    first, second = sets.pairs[0::2], sets.pairs[1::2]
    np.testing.assert_allclose(absolute(second)[:, 1] - absolute(first)[:, 1], np.pi)
    np.testing.assert_array_equal(first[:, 2], second[:, 2])


def test_there_are_100_random_poses_and_five_frequencies(sets):
    assert sets.random.shape == (100, 3)
    assert bleex.FREQUENCIES == (0.2, 0.4, 0.6, 0.8, 1.0)
    motions = bleex.dynamic_motions()
    for joint in range(3):
        for k, frequency in enumerate(bleex.FREQUENCIES):
            one, other = (motions.at(t).q[:, bleex.swing_index(joint, k)] for t in (0.25 / frequency, 0.75 / frequency))
            assert (np.flatnonzero(np.abs(one - other) > 1e-9) == [joint]).all()
            np.testing.assert_allclose((one + other) / 2.0, bleex.CENTRE)


def test_splitting_poses_needs_all_of_them(sets):
    poses = exoid.signals.Poses(sets.all, sets.all, ("hip", "knee", "ankle"))
    parts = sets.split(poses)
    for part, expected in zip(parts, (sets.ankle, sets.knee, sets.pairs, sets.random), strict=True):
        np.testing.assert_array_equal(part.q, expected)
    with pytest.raises(ExoidError, match="instead of"):
        sets.split(poses.take(slice(10)))


def test_row_1_takes_the_knee_every_5_degrees_from_10_at_one_difference():
    hip, knee = np.rad2deg(cuhk.stiffness_poses()).T
    assert knee[0] == pytest.approx(10.0)
    np.testing.assert_allclose(np.diff(knee), 5.0)
    np.testing.assert_allclose(knee - hip, -10.0)


PRINTED = [(cuhk.swing(0), [0], 0.1), (cuhk.swing(1), [1], 0.1), (cuhk.validation_motion(), [0, 1], 0.4)]


@pytest.mark.parametrize(("motion", "moving", "rate"), PRINTED, ids=["rows 3 and 5", "row 4", "validation"])
def test_joints_swing_by_40_plus_20_sin_or_are_held_at_20(motion, moving, rate):
    for t in np.linspace(0.0, 60.0, 31):
        target, swings = motion.at(t), 40.0 + 20.0 * np.sin(rate * np.pi * t)
        np.testing.assert_allclose(np.rad2deg(target.q[:, 0]), np.where(np.isin([0, 1], moving), swings, 20.0))
        assert not np.delete(target.v, moving).any()


def test_the_multisine_keeps_its_limits_and_is_better_the_more_are_drawn():
    leg = exoid.load_leg("cuhk")
    few, many = (cuhk.multisine(leg, np.random.default_rng(3), draws) for draws in (1, 40))
    for motion in (few, many):
        q, v, a = motion.over(cuhk.PERIOD)
        assert (q >= cuhk.LOWEST - 1e-6).all()
        assert (q <= cuhk.HIGHEST + 1e-6).all()
        assert np.abs(v).max() <= cuhk.MAX_SPEED + 1e-6
        np.testing.assert_allclose(np.gradient(v, 0.02, axis=0)[1:-1], a[1:-1], atol=0.02 * np.abs(a).max())
    terms = (exoid.Stiffness(degree=1, joints=("knee",)), exoid.Coulomb(), exoid.Viscous(), exoid.Armature())
    model = TorqueModel(leg, (*terms, exoid.Offset(joints=("hip",))))
    assert cuhk._condition(model, many) < 60.0
    assert cuhk._condition(model, many) < cuhk._condition(model, few)


def test_concatenated_motions_are_unchanged():
    both = Harmonics.concatenate([healthy_gait(), healthy_gait(), cuhk.swing(1)])
    np.testing.assert_allclose(
        both.at(1.3).q, np.hstack([np.tile(healthy_gait().at(1.3).q, 2), cuhk.swing(1).at(1.3).q])
    )
    np.testing.assert_allclose(both.at(1.3).v[:, :1], healthy_gait().at(1.3).v)
