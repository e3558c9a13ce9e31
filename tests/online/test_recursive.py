"""The recursive estimator: equal to the batch, in constant memory, and undisturbed by what streams bring."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from hanging_knee import DAMPING, hanging_log
from swings import harmonics

import exoid
from exoid.errors import BadArgumentError, NotIdentifiableError, NotSupportedError, UnreadableInputError
from exoid.online import RecursiveEstimator
from exoid.torques import TorqueModel

TERMS = (exoid.Coulomb(), exoid.Viscous(), exoid.Offset())
RESISTANCES = np.array([2.0, 1.5, 0.8, 0.5, 0.3, 0.2, 1.0, -1.0, 0.3])
NOISE = np.array([1.0, 0.7, 0.3])
RATE = 500.0


@pytest.fixture(scope="module")
def truth(leg):
    return np.concatenate([leg.parameters, RESISTANCES])


def swing(leg, truth, seconds, seed=0, noise=1.0):
    """Exact motion, and torque by the regressor with white noise."""
    rng = np.random.default_rng(seed)
    omega = 2.0 * np.pi * np.array([[0.9, 1.3], [0.7, 1.9], [1.1, 2.3]])
    size, phase = np.array([[0.4, 0.15], [0.5, 0.2], [0.2, 0.1]]), rng.uniform(0.0, 6.0, (3, 2))
    q, v, a = harmonics(np.arange(round(seconds * RATE)) / RATE, size, omega, phase)
    tau = TorqueModel(leg, TERMS).regressor(q, v, a) @ truth + noise * NOISE * rng.standard_normal(q.shape)
    return q, v, a, tau


def plain(leg, **settings):
    """Estimator without filter, forgetting and gate."""
    return RecursiveEstimator(leg, TERMS, rate=RATE, cutoff=None, memory=np.inf, reversal_speed=0.0, **settings)


def test_without_forgetting_it_is_the_batch_estimate(leg, truth):
    q, v, a, tau = swing(leg, truth, 10.0)
    time = np.arange(len(q)) / RATE
    log = exoid.Recording(time=time, q=q, v=v, a=a, tau=tau, joint_names=leg.joint_names)
    batch = exoid.identify(leg, log, TERMS, preparation="finite-difference", noise="white")
    inner = slice(1, -1)  # the batch leaves out the ends, whose differences are one-sided
    online = plain(leg)
    online.update(q[inner], v[inner], a[inner], tau[inner])
    found = online.estimate
    np.testing.assert_allclose(found.values, batch.values, rtol=1e-9, atol=1e-9 * np.abs(batch.values).max())
    np.testing.assert_allclose(found.residual_rms, batch.residual_rms, rtol=1e-9)
    np.testing.assert_allclose(found.std, batch.std, rtol=0.01)


def test_samples_one_by_one_and_in_blocks_give_the_same(leg, truth):
    q, _, _, tau = swing(leg, truth, 6.0)
    single, blocks = (RecursiveEstimator(leg, TERMS, rate=RATE) for _ in range(2))
    for online, size in ((single, 1), (blocks, 777)):
        for start in range(0, len(q), size):
            online.update(q[start : start + size].squeeze(), None, None, tau[start : start + size].squeeze())
    assert np.array_equal(single.estimate.values, blocks.estimate.values)


def test_intervals_grow_with_the_torques(leg, truth):
    q, _, _, tau = swing(leg, truth, 12.0)
    found = []
    for size in (1.0, 1024.0, 1.0 / 1024.0):
        online = RecursiveEstimator(leg, TERMS, rate=RATE)
        online.update(q, None, None, size * tau)
        found.append(online.estimate.std / size)
    np.testing.assert_allclose(found[1:], found[:1] * 2, rtol=1e-3)


def test_the_filter_costs_no_phase_error(leg, truth):
    """Angles alone, without noise: what is left is how far columns of smoothed angles differ from smoothed columns."""
    q, _, _, tau = swing(leg, truth, 20.0, noise=0.0)
    online = RecursiveEstimator(leg, TERMS, rate=RATE, memory=np.inf)
    online.update(q, None, None, tau)
    scale = np.maximum(np.abs(truth), 0.5)
    assert (np.abs(online.estimate.values - truth) / scale).max() < 0.02
    log = exoid.Recording(time=np.arange(len(q)) / RATE, q=q, tau=tau, joint_names=leg.joint_names)
    batch = exoid.identify(leg, log, TERMS)
    assert online.delay < 0.3
    np.testing.assert_allclose(online.estimate.values, batch.values, rtol=0.02, atol=0.02)


def test_with_correlated_noise_intervals_are_wider(leg, truth):
    q, v, a, clean = swing(leg, truth, 12.0, noise=0.0)
    rng = np.random.default_rng(3)
    white = rng.standard_normal(clean.shape)
    red = np.zeros_like(white)
    for k in range(1, len(red)):
        red[k] = 0.95 * red[k - 1] + np.sqrt(1.0 - 0.95**2) * white[k]
    std = []
    for noise in (white, red):
        online = plain(leg)
        online.update(q, v, a, clean + NOISE * noise)
        std.append(online.estimate.std)
    assert (std[1] > 3.0 * std[0]).all()


def test_memory_does_not_grow(leg, truth):
    q, _, _, tau = swing(leg, truth, 12.0)
    online, sizes = RecursiveEstimator(leg, TERMS, rate=RATE), []
    for _ in range(3):
        online.update(q, None, None, tau)
        sizes.append(len(pickle.dumps((online.state, len(online.findings)))))
    assert sizes[-1] - sizes[0] < 100


@pytest.mark.slow
def test_standing_still_changes_nothing(leg, truth):
    """The torque at rest holds any friction between −c0 and c0."""
    q, _, _, tau = swing(leg, truth, 20.0)
    online = RecursiveEstimator(leg, TERMS, rate=RATE, memory=5.0)
    online.update(q, None, None, tau)
    pose = np.tile(q[-1], (250, 1))
    online.update(pose, None, None, tau[-1] + 0.0 * pose)
    before = online.estimate
    rng = np.random.default_rng(1)
    for _ in range(60):
        swaying, torque = rng.standard_normal((2, *pose.shape))
        online.update(pose + 1e-4 * swaying, None, None, 5.0 * torque)
    assert (np.abs(online.estimate.values - before.values) <= before.std).all()


@pytest.mark.slow
def test_one_joint_that_moves_alone_leaves_the_others_known(leg, truth):
    """Ten time constants later nothing has blown up."""
    terms = (exoid.Viscous(),)
    model = TorqueModel(leg, terms)
    beta = np.concatenate([leg.parameters, RESISTANCES[3:6]])
    q, v, a, _ = swing(leg, truth, 20.0)
    rng = np.random.default_rng(5)
    online = RecursiveEstimator(leg, terms, rate=RATE, cutoff=None, memory=2.0, false_alarms=0.0)
    for still in (False, True):
        factor = np.array([0.0, 0.0, 1.0]) if still else np.ones(3)
        part = q * factor, v * factor, a * factor
        torque = model.regressor(*part) @ beta + NOISE * rng.standard_normal(q.shape)
        online.update(*part, torque)
        if not still:
            before = online.estimate
    error = np.abs(online.estimate.values - beta)
    assert (error <= 6.0 * before.std).all()


def test_it_begins_with_an_estimate_that_another_session_saved(leg, truth, tmp_path):
    q, v, a, tau = swing(leg, truth, 20.0)
    batch = plain(leg)
    batch.update(q, v, a, tau)
    batch.estimate.save(tmp_path / "monday.json")
    start = exoid.Estimate.load(tmp_path / "monday.json")
    online = RecursiveEstimator(leg, TERMS, rate=RATE, start=start)
    np.testing.assert_allclose(online.estimate.values, start.values, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(online.estimate.std, start.std, rtol=0.03)  # as sure as it was, not surer
    q, v, a, tau = swing(leg, truth, 20.0, seed=7)
    online.update(q, None, None, tau)
    assert (np.abs(online.estimate.values - truth) <= 4.0 * start.std + 0.01 * np.abs(truth)).all()
    with pytest.raises(BadArgumentError, match="no leg has"):
        RecursiveEstimator(leg, TERMS, rate=RATE, start=replace(start, values=0.0 * start.values + 1e304))


def test_samples_that_cannot_be_are_left_out_and_counted(leg, truth):
    q, _, _, tau = swing(leg, truth, 12.0)
    time = np.arange(len(q)) / RATE
    spoilt, torque = q.copy(), tau.copy()
    spoilt[700] = np.nan
    spoilt[1500, 1] += 3.0
    torque[2200, 0] = np.inf
    torque[3000:3010, 2] = 200.0
    online = RecursiveEstimator(leg, TERMS, rate=RATE, torque_limits=(500.0, 500.0, 200.0))
    keep = np.delete(np.arange(len(q)), np.r_[4000:4002, 5000:5040])
    keep = np.insert(keep, 3500, keep[3500])
    for k in keep.tolist():
        online.update(spoilt[k], None, None, torque[k], float(time[k]))
    kinds = {finding.kind: finding for finding in online.findings}
    assert kinds["stream-not-finite"].message.startswith("2 of")
    assert kinds["stream-angle-jump"].message.startswith("1 of")
    assert kinds["stream-repeated-sample"].message.startswith("1 of")
    assert kinds["stream-missing-samples"].message.startswith("42 of")
    assert kinds["stream-saturated-torque"].message.startswith("10 of")
    clean = RecursiveEstimator(leg, TERMS, rate=RATE)
    clean.update(q, None, None, tau)
    assert (np.abs(online.estimate.values - clean.estimate.values) <= clean.estimate.std).all()


MISTAKES = {
    "none": (),
    "the sign of a torque": ("large-residual", "torque-sign"),
    "swapped torques": ("impossible-leg", "large-residual"),
    "torques of another unit": ("torque-scale",),
    "a torque that is stuck": ("stream-stuck-torque",),
    "another rate": ("stream-rate",),
    "velocities of another unit": ("velocity-scale",),
    "stamps with jitter of half a period": (),
    "a stamp that is far ahead": ("stream-time-jump",),
    "a stamp that is infinite": ("stream-not-finite",),
    "stamps of a clock that was set back": ("stream-late-sample", "stream-missing-samples"),
    "stamps of samples that overtook others": ("stream-late-sample",),
    "stamps of a pause": ("stream-time-jump", "stream-missing-samples"),
}


@pytest.mark.slow
@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_of_a_stream_are_named(leg, truth, mistake):
    q, v, _, tau = swing(leg, truth, 20.0)
    time, given = np.arange(len(q)) / RATE, None
    if mistake == "the sign of a torque":
        tau[:, 1] *= -1.0
    elif mistake == "swapped torques":
        tau = tau[:, [1, 0, 2]]
    elif mistake == "torques of another unit":
        tau *= 1e3
    elif mistake == "a torque that is stuck":
        tau[len(tau) // 2 :, 0] = tau[len(tau) // 2, 0]
    elif mistake == "another rate":
        time = 1.02 * time
    elif mistake.startswith("velocities"):
        given = 1.05 * v
    elif mistake.startswith("stamps with"):
        time += np.random.default_rng(0).uniform(-0.49, 0.49, len(q)) / RATE
    elif mistake.startswith("a stamp"):
        time[5000] += 100.0 if "far" in mistake else np.inf
    elif mistake.endswith("others"):
        order = np.arange(len(q)) + np.tile([1, -1] + 998 * [0], len(q) // 1000)
        q, tau, time = q[order], tau[order], time[order]
    elif mistake.startswith("stamps"):
        time[5000:] += 3.0 if "pause" in mistake else -5.0
    online = RecursiveEstimator(leg, TERMS, rate=RATE)
    online.update(q, given, None, tau, time)
    found = online.estimate
    named = {finding.kind for finding in found.findings}
    assert named <= {*MISTAKES[mistake]}
    assert bool(named) == bool(MISTAKES[mistake])
    if "stamp" in mistake:  # one sample is left out, or none
        assert all(finding.severity == "info" for finding in found.findings)
    if mistake in ("none", "a torque that is stuck") or "stamp" in mistake:  # what is left out misleads no parameter
        assert (np.abs(found.values - truth) < 4.5 * found.std + 1e-3).all()


WRONG = [{"q": np.rad2deg([0.5, 0.6, 0.1])}, {"q": np.zeros(2)}, {"tau": None}, {"tau": ["a"] * 3}, {"v": np.ones(4)}]


@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_samples_are_refused(leg, wrong):
    online = RecursiveEstimator(leg, TERMS, rate=RATE)
    sample = {"q": np.zeros(3), "v": None, "a": None, "tau": np.zeros(3)}
    with pytest.raises(UnreadableInputError if wrong is WRONG[0] else BadArgumentError):  # degrees
        online.update(**(sample | wrong))


SETTINGS = [(x, -1.0) for x in ("rate", "memory", "cutoff", "reversal_speed", "torque_limits", "false_alarms")]


@pytest.mark.parametrize(("name", "value"), [*SETTINGS, ("cutoff", 90.0), ("torque_limits", (1.0,))])
def test_settings_out_of_range_are_refused(leg, name, value):
    with pytest.raises(BadArgumentError):
        RecursiveEstimator(leg, TERMS, **{name: value})


def test_what_cannot_be_estimated_is_refused(leg):
    online = RecursiveEstimator(leg, TERMS)
    with pytest.raises(NotIdentifiableError):  # no row so far
        _ = online.estimate
    online.update(np.zeros(3), None, None, np.zeros(3))
    for one in (online, plain(leg)):  # channels that come and go; without a filter nothing derives
        with pytest.raises(BadArgumentError):
            one.update(np.zeros(3), np.zeros(3), None, np.zeros(3))
    with pytest.raises(NotSupportedError):  # memory
        RecursiveEstimator(leg, (exoid.Coulomb(presliding=0.001),))


def test_the_last_digit_of_a_sample_changes_nothing(data):
    """Also before the first reversals, when Coulomb friction and offset are one column whose residuals are rounding."""
    one, other = (RecursiveEstimator(data.leg, rate=100.0, cutoff=6.0, memory=5.0, false_alarms=0.0) for _ in range(2))
    digits = 1.0 + 2.3e-16 * np.random.default_rng(0).choice([-1.0, 0.0, 1.0], (600, 3))
    one.update(data.train.q[:600], None, None, data.train.tau[:600])
    other.update(data.train.q[:600] * digits, None, None, data.train.tau[:600])
    np.testing.assert_allclose(other.state.std, one.state.std, rtol=1e-8)
    np.testing.assert_allclose(other.state.values, one.state.values, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("memory", [20.0, np.inf])
def test_a_passive_joint_is_as_in_a_log(memory):
    leg, log = hanging_log(1, passive=True)
    assert np.array_equal(log.tau[:, 1], np.zeros(len(log)))
    batch = exoid.identify(leg, log, (exoid.Viscous(),))
    settings = {"rate": log.sample_rate, "cutoff": 6.0, "memory": memory}
    for passive, start in ((("left_knee",), None), (None, batch)):  # an estimate to begin with says which are passive
        online = RecursiveEstimator(leg, (exoid.Viscous(),), start=start, passive=passive, **settings)
        online.update(log.q, None, None, np.where([False, True], np.nan, log.tau), log.time)
        found = online.estimate
        assert found.passive == ("left_knee",)
        assert (np.abs(found.values - np.append(leg.parameters, DAMPING)) < 4.0 * found.std).all()
        np.testing.assert_allclose(found.value("d_knee"), DAMPING[1], rtol=0.02)
        assert found.findings == ()
    with pytest.raises(BadArgumentError, match="declared passive"):
        online.update(log.q[0], None, None, np.ones(2))
    unsaid = RecursiveEstimator(leg, **settings)
    unsaid.update(log.q, None, None, log.tau, log.time)
    with pytest.raises(NotIdentifiableError, match=r"kept one value while their joint moved.*passive="):
        _ = unsaid.estimate
    with pytest.raises(BadArgumentError, match="all joints are passive"):
        RecursiveEstimator(leg, passive=leg.joint_names)


def test_a_spring_at_a_passive_joint_is_said():
    leg, log = hanging_log(1, passive=True, stiffness=16.0)
    online = RecursiveEstimator(leg, (exoid.Viscous(),), rate=log.sample_rate, cutoff=6.0, passive=log.passive)
    online.update(log.q, None, None, log.tau)
    assert ("large-residual", "left_knee", "error") in [(f.kind, f.joint, f.severity) for f in online.estimate.findings]


def test_a_continuous_joint_may_turn_many_times(leg, truth):
    q, _, _, tau = swing(leg, truth, 10.0)
    settings = {"terms": TERMS, "rate": RATE}
    turned = RecursiveEstimator(leg, **settings, largest_angle=np.inf)
    turned.update(q + 6.0 * np.pi, None, None, tau)
    plainly = RecursiveEstimator(leg, **settings)
    plainly.update(q, None, None, tau)
    apart = np.abs(turned.estimate.values - plainly.estimate.values)
    assert (apart < 0.01 * plainly.estimate.std).all()
    with pytest.raises(UnreadableInputError, match="largest_angle"):
        plainly.update(q + 6.0 * np.pi, None, None, tau)


def test_stamps_that_say_another_rate_are_named_and_those_in_bursts_are_not(leg, truth):
    q, _, _, tau = swing(leg, truth, 15.0)
    time, number = np.arange(len(q)) / RATE, np.arange(len(q)) % 400 - 200
    bursts = time + np.where(
        (number >= 0) & (number < 10), (10 - number) * 0.95 / RATE, 0.0
    )  # a bus that hung, and sends what waited
    for stamps, pace in ((1.002 * time, 1.002), (0.5 * time, 0.5), (bursts, 1.0), (1.01 * bursts, 1.01)):
        online = RecursiveEstimator(leg, TERMS, rate=RATE)
        online.update(q, None, None, tau, stamps)
        found = [finding for finding in online.findings if finding.kind == "stream-rate"]
        assert [finding.value for finding in found] == ([pytest.approx(pace, abs=2e-4)] if pace != 1.0 else [])
        assert all(finding.parameters == online.settings.model.names for finding in found)
