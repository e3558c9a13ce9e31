"""Sensors on the ground: exact ones read the truth, the others have the noise, bias, delay and mistakes they state."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from exoid import ExoidError, load_leg
from exoid.experiments.ground import bleex_machine, single_support, walking
from exoid.rig.ground import GroundSensors
from exoid.signals import ZeroPhase, wrenches_on_links
from exoid.signals.moving_base import base_during

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def walk():
    return walking(bleex_machine(), 6.0)


@pytest.fixture(scope="module")
def squats():
    return single_support(bleex_machine("left"), 3.0)


def test_exact_sensors_read_the_truth(walk):
    log = walk.recording(GroundSensors.exact())
    np.testing.assert_array_equal(log.q, walk.q)
    np.testing.assert_array_equal(log.tau, walk.tau)
    for link, wrench in walk.wrenches.items():
        np.testing.assert_array_equal(log.wrenches[link].force, wrench.force)
        np.testing.assert_array_equal(log.wrenches[link].moment, wrench.moment)
    np.testing.assert_array_equal(log.base.angular_velocity, walk.base.angular_velocity)
    expected = walk.base.specific_force_at(np.array([0.05, 0.0, 0.25]))
    np.testing.assert_allclose(log.base.specific_force, expected, rtol=0, atol=1e-12)
    assert log.base.pose is None
    assert log.joint_names == walk.plant.leg.joint_names


def test_noise_has_the_stated_size(walk):
    sensors = GroundSensors(window=0.0)
    log, exact = walk.recording(sensors, 1), walk.recording(GroundSensors.exact())
    assert (log.q - exact.q).std() == pytest.approx(1e-4, rel=0.05)
    np.testing.assert_allclose((log.tau - exact.tau).std(axis=0), [0.5, 0.4, 0.2] * 2, rtol=0.1)
    for part, size in (("force", 3.0), ("moment", 0.3)):
        errors = [getattr(log.wrenches[link], part) - getattr(exact.wrenches[link], part) for link in log.wrenches]
        assert np.std(errors) == pytest.approx(size, rel=0.05)
    assert (log.base.angular_velocity - exact.base.angular_velocity).std() == pytest.approx(0.005, rel=0.05)
    assert (log.base.specific_force - exact.base.specific_force).std() == pytest.approx(0.05, rel=0.05)


def test_an_imu_reads_means_of_the_time_of_the_sample(walk):
    """Means over a window are changes of pitch and velocity over it, whatever happens within."""
    window, pitch = 0.004, np.unwrap(np.arctan2(walk.rotation[:, 0, 2], walk.rotation[:, 0, 0]))
    log = walk.recording(replace(GroundSensors.exact(), window=window)).base
    turned = (pitch[2:] - pitch[:-2]) / window  # samples are 2 ms apart
    np.testing.assert_allclose(log.angular_velocity[2:-2, 1], turned[1:-1], rtol=0, atol=1e-6)


def test_the_rows_of_a_swing_are_those_of_the_truth_behind_an_imu_that_takes_means(walk):
    """Single steps alias the jolts of the other foot, and a velocity half a step late shifts all that it derives."""
    leg, preparation = load_leg("bleex", side="left"), ZeroPhase(8.0, kinematics_cutoff=60.0)
    joints = [walk.plant.leg.joint_names.index(name) for name in leg.joint_names]
    away = scipy.ndimage.binary_erosion(~walk.feet["left_foot"].touching, iterations=50)
    of_joints = [x[:, joints] for x in (walk.q, walk.v, walk.a)]
    exact = leg.regressor(*of_joints, walk.base) @ leg.parameters

    def error(window: float) -> float:
        log = walk.recording(replace(GroundSensors.exact(), window=window)).select(leg.joint_names)
        q, v, a, _ = preparation.kinematics(log)
        off = leg.regressor(q, v, a, base_during(log, preparation)) @ leg.parameters - exact
        kept = preparation.filter(np.where(away[:, np.newaxis], off, 0.0), 500.0)[away]
        return float(np.sqrt(np.mean(kept**2)))

    assert error(0.002) < 0.3 * error(0.0)


def test_plates_read_means_whose_impulse_is_that_of_the_ground(walk):
    """Single steps alias the jolts of heel and toe: sums of means over the period of the log are those of all steps."""
    sensors = replace(GroundSensors.exact(wrench_axes="world"), window=0.002)
    for link in walk.feet:
        every, read = walk.steps.ground[link][:, 2], walk.recording(sensors).wrenches[link].force[:, 2]
        alone = walk.wrench(link, world=True).force[:, 2]
        impulse = every.sum() * walk.steps.dt
        assert read.sum() * 0.002 == pytest.approx(impulse, rel=1e-3)
        assert np.abs(read - alone).max() > 100.0


def test_plates_in_the_laboratory_and_soles_on_the_foot_measure_one_wrench(walk):
    log = walk.recording(GroundSensors.exact(wrench_axes="world"))
    assert log.base.pose is not None
    np.testing.assert_allclose(log.base.pose.position, walk.position, rtol=0, atol=1e-12)
    np.testing.assert_allclose(log.base.pose.rotation, walk.rotation, rtol=0, atol=1e-9)
    for link, foot in walk.feet.items():
        world, own = log.wrenches[link], walk.wrenches[link]
        assert world.axes == "world"
        np.testing.assert_allclose(world.force, foot.force, rtol=0, atol=1e-9)
        turned = np.einsum("nij,nj->ni", foot.rotation, own.moment) + np.cross(foot.position, foot.force)
        np.testing.assert_allclose(world.moment, turned, rtol=0, atol=1e-9)
        loaded = foot.force[:, 2] > 50.0  # the vertical line of force goes through the sole
        arm = np.einsum("nij,ni->nj", foot.rotation, foot.centre_of_pressure - foot.position)[loaded]
        assert arm[:, 0].min() > -0.085
        assert arm[:, 0].max() < 0.135
    on_links = wrenches_on_links(walk.plant.leg, log)
    for link, own in walk.wrenches.items():
        np.testing.assert_allclose(on_links[link].force, own.force, rtol=0, atol=1e-6)
        np.testing.assert_allclose(on_links[link].moment, own.about((0.0, 0.0, 0.0)).moment, rtol=0, atol=1e-6)
    noisy = walk.recording(GroundSensors(wrench_axes="world"), 2)
    assert (noisy.base.pose.position - walk.position).std() == pytest.approx(2e-4, rel=0.05)


def test_a_torso_whose_holder_is_not_logged_has_an_unknown_wrench(squats):
    log = squats.recording(wrenches=("left_foot",))
    assert set(log.wrenches) == {"left_foot"}
    assert log.contacts["torso"].all()
    assert "torso" not in squats.recording().contacts
    assert set(squats.recording(wrenches=()).contacts) == {"left_foot", "torso"}
    with pytest.raises(ExoidError, match="no wrench on 'right_foot' in the run"):
        squats.recording(wrenches=("right_foot",))


def test_switches_are_closed_while_a_foot_bears_load_and_late_if_they_are_slow(walk):
    exact = walk.recording(GroundSensors.exact())
    late = walk.recording(GroundSensors(switch_delay=0.02))
    for link, foot in walk.feet.items():
        np.testing.assert_array_equal(exact.contacts[link], foot.force[:, 2] > 20.0)
        np.testing.assert_array_equal(late.contacts[link][10:], exact.contacts[link][:-10])
        assert 0.3 < exact.contacts[link].mean() < 0.7


def test_a_share_of_stance_is_mislabelled_in_stretches(walk):
    exact = walk.recording(GroundSensors.exact())
    wrong = walk.recording(GroundSensors(mislabelled=0.05), 1)
    for link in walk.feet:
        flipped = exact.contacts[link] != wrong.contacts[link]
        assert flipped.sum() == round(0.05 * exact.contacts[link].sum())
        assert not (flipped & ~exact.contacts[link]).any()
        assert flipped.sum() / np.count_nonzero(np.diff(flipped.astype(int)) == 1) > 10
