"""Loads that are strapped on: found in slow gaits and early, never named wrongly, and taken off again."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
import study_loads as study
from study_loads import PLACE, RATE, TERMS, Walker

from exoid.online import RecursiveEstimator, load_change

pytestmark = pytest.mark.slow

POPULATION = [(machine, stride) for machine in study.MACHINES for stride in study.STRIDES]


def feed(online, samples):
    online.update(samples[0], None, None, samples[1])


def noisy(walker, size):
    """Make the noise of the torques larger or smaller by a factor."""
    rng = np.random.default_rng(0)
    return replace(walker, rng=SimpleNamespace(standard_normal=lambda shape: size * rng.standard_normal(shape)))


def estimator(walker):
    return RecursiveEstimator(walker.leg, TERMS, rate=RATE)


@pytest.mark.parametrize(
    ("seed", "stride", "machine", "learning"),
    [
        (1000, 10.0, "three joints", False),
        (1001, 1.2, "abduction", False),
        (1003, 4.0, "two joints", True),  # strapped on while the estimator still learns the leg
        (1004, 10.0, "three joints", True),
        *(
            pytest.param(1005 + k, stride, machine, False, marks=pytest.mark.nightly)
            for k, (machine, stride) in enumerate(POPULATION)
        ),
    ],
)
def test_a_load_is_found_within_a_stride_or_5_s(seed, stride, machine, learning):
    found = study.strap_on(seed, stride, machine, learning=learning)
    if not np.isfinite(found.error):
        pytest.skip("a joint moved one way only: nothing tells its offset from its friction")
    assert abs(found.error) < 0.1
    assert abs(found.error) < 4.0 * found.std
    assert found.names == ("load at knee",)


@pytest.mark.parametrize("fault", study.FAULTS)
@pytest.mark.parametrize("seed", [1001, pytest.param(1002, marks=pytest.mark.nightly)])
def test_a_sensor_that_fails_is_named_and_moves_no_parameter(seed, fault):
    found = study.spoil(seed, 1.2, "three joints", fault)
    assert found.names == found.right
    assert found.warned
    assert found.after < max(4.0, 1.2 * found.before)


def test_a_sensor_that_is_mended_is_heard_again():
    walker = Walker.of(1000, 1.2)
    online = estimator(walker)
    feed(online, walker.walk(30.0))
    q, tau = walker.walk(25.0, 0.0, 30.0)
    feed(online, (q, tau * [1.0, 1.2, 1.0]))
    (fault,), known = online.changes, online.estimate
    assert (fault.kind, fault.joint, round(fault.size, 1)) == ("torque-scale", "knee", 0.2)
    feed(online, walker.walk(15.0, 0.0, 55.0))
    after = online.estimate
    assert (after.std <= known.std).all()
    assert (np.abs(after.values[:9] - walker.leg.parameters) < 5.0 * after.std[:9]).all()
    assert [one.severity for one in online.findings] == ["info"]


def test_a_load_in_the_first_strides_is_found_whatever_the_motion_was():
    """From nothing, load at 12 s: the mean statistic must not take the change for what is normal in this motion."""
    for seed in (1000, 1001):
        walker = Walker.of(seed, 4.0, "three joints")
        online = estimator(walker)
        feed(online, walker.walk(12.0))
        feed(online, walker.walk(12.0, 2.0, 12.0))
        body = pin.Inertia(2.0, np.array(PLACE), np.zeros((3, 3))).toDynamicParameters()
        loaded = walker.leg.parameters + walker.leg.reduction.collect[:, 10:20] @ body
        estimate = online.estimate
        assert (np.abs(estimate.values[:9] - loaded) < 5.0 * estimate.std[:9]).all()
        assert study.named(online) == ("load at knee",)


@pytest.mark.parametrize(
    ("stride", "machine"),
    [
        *((1.2, one) for one in study.MACHINES),
        (10.0, "abduction"),
        *(pytest.param(10.0, one, marks=pytest.mark.nightly) for one in ("two joints", "three joints")),
    ],
)
def test_learning_a_leg_is_no_change(stride, machine):
    walker = Walker.of(1000, stride, machine)
    online = estimator(walker)
    feed(online, walker.walk(40.0))
    assert not online.changes
    assert not online.findings


def test_while_the_motion_tells_no_load_from_another_intervals_say_so():
    """The hip alone moves: a load on the thigh, on the shank or on the foot does the same."""
    walker = Walker.of(1000, 4.0)
    online = estimator(walker)
    feed(online, walker.walk(40.0))
    t = np.arange(0.0, 6.0, 1.0 / RATE)
    motion = np.repeat(walker.angles(np.array([40.0])), len(t), axis=1)
    motion[1:] = 0.0
    fading = motion[0, :, 0] + 0.4 * np.sin(2.0 * t)
    motion[0, :, 0] = fading
    motion[1, :, 0], motion[2, :, 0] = 0.8 * np.cos(2.0 * t), -1.6 * np.sin(2.0 * t)
    feed(online, walker.measure(motion, 2.0))
    finding = {one.kind: one for one in online.findings}["change-ambiguous"]
    assert {"X1", "X2"} <= set(finding.parameters)
    sand = pin.Inertia(2.0, np.array(PLACE), np.zeros((3, 3))).toDynamicParameters()
    loaded = walker.leg.reduction.collect[:, 10:20] @ sand
    estimate = online.estimate
    error = estimate.values[:9] - walker.leg.parameters - loaded
    assert (np.abs(error) < 5.0 * estimate.std[:9]).all()
    assert not online.changes


@pytest.mark.parametrize("joint", ["knee", "ankle"])
def test_a_load_that_follows_a_jump_of_an_angle_may_be_the_encoder(joint):
    """The zero of the last joint acts like a mass beside it, and was named a load with narrow intervals."""
    walker = Walker.of(1001, 1.2)
    online = estimator(walker)
    feed(online, walker.walk(30.0))
    q, tau = walker.walk(25.0, 0.0, 30.0)
    feed(online, (q + 0.6 * (np.array(walker.leg.joint_names) == joint), tau))
    finding = {one.kind: one for one in online.findings}["change-ambiguous"]
    assert f"load at {joint} or angle-offset at {joint}" in finding.message
    wide = [name in finding.parameters for name in online.estimate.names]
    assert (online.estimate.std[wide] > np.abs(online.estimate.values[wide])).all()


def test_a_load_that_is_taken_off_again_leaves_the_leg_that_was():
    """Ten seconds after it was strapped on, while its name is still on probation."""
    walker = Walker.of(1002, 2.0)
    online = estimator(walker)
    for begin, seconds, load in ((0.0, 42.0, 0.0), (42.0, 10.0, 2.0), (52.0, 12.0, 0.0)):
        feed(online, walker.walk(seconds, load, begin))
    estimate = online.estimate
    assert (np.abs(estimate.values[:9] - walker.leg.parameters) < 5.0 * estimate.std[:9]).all()


def test_noise_that_grows_is_a_finding_as_residuals_and_intervals_contradict_each_other():
    """Thirty times in 72 s, too slowly for an alarm: weights fall by more than ten."""
    walker = Walker.of(1001, 1.2, "two joints")
    online = estimator(walker)
    feed(online, walker.walk(20.0))
    assert not online.findings
    for k in range(13):
        feed(online, noisy(walker, 1.3**k).walk(6.0, 0.0, 20.0 + 6.0 * k))
    said = {(one.kind, one.joint) for one in online.findings}
    assert said == {(kind, joint) for kind in ("residuals-grew", "intervals-contradicted") for joint in ("hip", "knee")}


@pytest.mark.parametrize(("seed", "machine"), [(2, "two joints"), (5, "abduction")])
def test_a_load_is_found_where_noise_hides_no_error_of_sampling(seed, machine):
    """A stride of exactly 50 samples, 0.02 N·m: what the low-pass bends of a load is many times the noise before."""
    walker = noisy(Walker.of(seed, 0.5, machine), 0.05)
    online = estimator(walker)
    feed(online, walker.walk(20.0))
    known = online.estimate
    feed(online, walker.walk(5.0, 2.8, 20.0))
    found = load_change(known, online.estimate, "knee", PLACE)
    assert abs(found.mass - 2.8) < 4.0 * found.std < 0.01
    beside = load_change(known, online.estimate, "knee", (0.0, 0.0, -0.15))
    assert ["check the place" in str(one) for one in (found, beside)] == [False, True]
    assert beside.std > 3.0 * found.std
    assert study.named(online) == ("load at knee",)
    assert {one.kind for one in online.findings} == {"changed-load"}


def test_a_joint_that_weighs_three_hundred_times_another_hides_no_load():
    """Encoders of 4096 counts: most of the noise is theirs, and differs from joint to joint."""
    walker, count = noisy(Walker.of(2, 0.5, "abduction"), 0.0125), 2.0 * np.pi / 4096
    online = estimator(walker)
    for seconds, load, begin in ((25.0, 0.0, 0.0), (5.0, 3.0, 25.0)):
        q, tau = walker.walk(seconds, load, begin)
        feed(online, (count * np.round(q / count), tau))
    assert online.state.weights.max() > 100.0 * online.state.weights.min()
    assert np.isfinite(online.estimate.std).all()  # no error in a control loop, though hardly anything is known
    assert study.named(online) == ("load at knee",)


@pytest.mark.parametrize("size", [5.0, 20.0])
def test_torques_that_no_parameter_explains_are_a_finding(size):
    """Somebody pushes at the knee, now this way and now that: all is given up, said, and taken back afterwards."""
    walker = Walker.of(1001, 1.2)
    online = estimator(walker)
    feed(online, walker.walk(30.0))
    before = online.estimate
    q, tau = walker.walk(30.0, 0.0, 30.0)
    tau[:, 1] += size * np.repeat(walker.rng.standard_normal(len(tau) // 50), 50)
    feed(online, (q, tau))
    assert "change-unexplained" in {one.kind for one in online.findings}
    assert (online.estimate.std > 10.0 * before.std).all()
    feed(online, walker.walk(10.0, 0.0, 60.0))
    after = online.estimate
    assert not online.findings
    assert (np.abs(after.values[:9] - walker.leg.parameters) < 5.0 * after.std[:9]).all()
    assert (after.std < 2.0 * before.std).all()
