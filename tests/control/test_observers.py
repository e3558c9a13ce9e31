"""Observers read what a wearer does to a leg: exact dynamics, stated delay and band, honest alarms, refused logs."""

from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from observing import (
    ANGLE_NOISE,
    COUNT,
    FRICTION,
    TERMS,
    TORQUE_NOISE,
    WornLog,
    estimate_of,
    nrmse,
    slow_tachometer,
    sticking_run,
    worn_run,
)
from planar_chains import random_chain
from scipy.signal import lfilter
from small_urdfs import spatial_arm

import exoid
from exoid import ExoidError, Recording, TorsoMotion
from exoid.control import ControlModel, MomentumObserver, SensorNoise
from exoid.control.observers.momentum import MomentumModel
from exoid.control.observers.noise import threshold
from exoid.errors import BadArgumentError, NotSupportedError, UnreadableInputError
from exoid.rig import Plant

BLEEX, CUHK = exoid.load_leg("bleex"), exoid.load_leg("cuhk")
NOISE = SensorNoise(TORQUE_NOISE, 0.01, ANGLE_NOISE)
HELD = 0.5e-3


@pytest.fixture(scope="module")
def estimate():
    return estimate_of(BLEEX)


@pytest.fixture(scope="module")
def worn():
    return WornLog(BLEEX, 6.0, seed=2)


@pytest.fixture(scope="module")
def sticking():
    return sticking_run(BLEEX, 6, 14.0)


@pytest.mark.parametrize("leg", [BLEEX, CUHK, random_chain(np.random.default_rng(3), 4).leg(), spatial_arm("abc")])
def test_momentum_and_its_torques_are_those_of_pinocchio(leg):
    """M v, and Cᵀv − G with Pinocchio's Coriolis matrix, sample by sample."""
    n, rng = len(leg.joint_names), np.random.default_rng(0)
    q, v = rng.uniform(-1.5, 1.5, (2, 50, n)) * [[[1.0]], [[3.0]]]
    found, model = MomentumModel(ControlModel.of(leg), 0.05, 1.2).over(q, v), leg.model
    data = model.createData()
    for k in range(50):
        at = q[k] if model.nq == n else np.column_stack([np.cos(q[k]), np.sin(q[k])]).ravel()
        M = pin.crba(model, data, at)
        M = np.triu(M) + np.triu(M, 1).T
        C = pin.computeCoriolisMatrix(model, data, at, v[k]).copy()
        np.testing.assert_allclose(found.M[k], M, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(found.p[k, 0], M @ v[k], rtol=1e-12, atol=1e-12)
        expected = C.T @ v[k] - pin.computeGeneralizedGravity(model, data, at)
        np.testing.assert_allclose(found.u[k, 0], expected, rtol=1e-12, atol=1e-11)


def first_velocity(observer, q):
    """Mean velocity over the delay of the channels."""
    count = max(1, round(observer.alignment.delay * observer.rate))
    return (q[count] - q[0]) * observer.rate / count


@pytest.mark.slow
@pytest.mark.parametrize("case", ["derived", "tachometer", "no filter", "lags", "leg"])
def test_a_log_at_once_is_the_same_as_sample_by_sample(case, estimate):
    log = WornLog(BLEEX, 0.5, seed=4, tachometer=0.01 if case in ("tachometer", "no filter") else None)
    lags = {"torque_delay": (0.0, 2.3e-3, -0.5e-3), "velocity_delay": 0.7e-3} if case == "lags" else {}
    cutoff = np.inf if case == "no filter" else None
    source = BLEEX if case == "leg" else estimate
    observer = MomentumObserver(source, 10.0, 1000.0, noise=NOISE, cutoff=cutoff, **lags)
    recording = log.recording()
    found = observer.run(recording)
    speed = recording.v[0] if recording.v is not None else first_velocity(observer, recording.q)
    memory = observer.begin(recording.q[0], speed, recording.tau[0])
    for k in range(len(recording)):
        v = None if recording.v is None else recording.v[k]
        reading, memory = observer.step(memory, recording.q[k], v, recording.tau[k])
        scale = np.abs(found.torque).max()
        np.testing.assert_allclose(reading.torque, found.torque[k], rtol=0.0, atol=1e-12 * max(scale, 1.0))
        np.testing.assert_allclose(reading.std, found.std[k], rtol=1e-12)
        np.testing.assert_allclose(reading.stiction, found.stiction[k], rtol=1e-10, atol=1e-12)
        np.testing.assert_array_equal(reading.detected, found.detected[k])


def test_blocks_of_a_long_log_join(estimate, monkeypatch, worn):
    observer = MomentumObserver(estimate, 10.0, 1000.0, noise=NOISE)
    recording = worn.recording().slice(0, 500)
    whole = observer.run(recording)
    monkeypatch.setattr("exoid.control.observers.momentum_observer.BLOCK", 37)
    pieces = observer.run(recording)
    np.testing.assert_allclose(pieces.torque, whole.torque, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(pieces.std, whole.std, rtol=1e-12)


def held_log(rate: float, pushed, samples: int = 400) -> Recording:
    """Leg at rest that its actuators hold against a wearer."""
    q = np.tile([0.4, -0.6, 0.1], (samples, 1))
    time = np.arange(samples) / rate
    tau = BLEEX.gravity(q) - pushed(time)[:, None]
    return Recording(time, q, np.zeros_like(q), tau=tau, joint_names=BLEEX.joint_names)


@pytest.mark.parametrize("rate", [10.0, 100.0, 1000.0])
def test_a_constant_torque_is_read_by_the_exact_exponential_at_every_rate(rate):
    """Even K T = 126, where forward Euler diverges."""
    for bandwidth in (3.0, 200.0):
        observer = MomentumObserver(BLEEX, bandwidth, rate, cutoff=np.inf, noise=NOISE)
        recording = held_log(rate, lambda time: np.where(time >= 10.0 / rate - 1e-9, 5.0, 0.0))
        read = observer.run(recording).torque[:, 0]
        K, since = 2.0 * np.pi * bandwidth, np.clip(recording.time - 10.0 / rate, 0.0, None)
        late = 1.0 - 0.5 * (1.0 - np.exp(-K / rate))  # the interval of the step has half of it
        expected = 5.0 * (1.0 - late * np.exp(-K * since))
        np.testing.assert_allclose(read[10:], expected[10:], rtol=1e-10)
        assert not np.abs(read[:10]).max() > 1e-12


def measured_response(observer, frequency):
    """Complex gain of each joint for a torque of the wearer at a frequency, (n,)."""
    w = 2.0 * np.pi * frequency
    recording = held_log(1000.0, lambda time: np.cos(w * time), 6000)
    read = observer.run(recording).torque[2000:]
    response = 2.0 * (np.exp(-1j * w * recording.time[2000:])[:, None] * read).mean(axis=0)
    return response / np.cos(0.5 * w / 1000.0)  # a sampled cosine, by the trapezoidal rule


@pytest.mark.parametrize("cutoff", [None, 60.0, np.inf])
def test_the_delay_is_that_of_a_slow_torque(cutoff):
    observer = MomentumObserver(BLEEX, 10.0, 1000.0, cutoff=cutoff, noise=NOISE, torque_delay=0.0)
    late = -np.angle(measured_response(observer, 0.5)) / (2.0 * np.pi * 0.5)
    np.testing.assert_allclose(late, observer.delay, rtol=2e-3)


def test_the_bandwidth_is_the_one_asked_for():
    observer = MomentumObserver(BLEEX, 8.0, 1000.0, cutoff=np.inf, noise=NOISE)
    assert observer.delay == pytest.approx(0.5 / (np.pi * observer.bandwidth), rel=1e-3)
    assert abs(measured_response(observer, 8.0)) == pytest.approx([0.5**0.5] * 3, 1e-2)


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "bandwidth"), [("bleex", 36.0), ("cuhk", 45.0)])
def test_torque_of_walking_wearers_is_read_to_a_quarter_within_25_ms(name, bandwidth):
    leg = exoid.load_leg(name)
    run = worn_run(leg, np.array([1.1, 1.3]), 4.0)
    model = estimate_of(leg, zero=0.0)
    observer = MomentumObserver(model, bandwidth, 1000.0, torque_delay=HELD, noise=SensorNoise.of(run.recording(0)))
    assert observer.delay < 0.025
    for k in range(2):
        found = observer.run(run.recording(k))
        assert nrmse(found.torque, run.interaction[..., k], 1000).max() < 0.25
        late = round(observer.delay * 1000.0)
        assert nrmse(found.torque[late:], run.interaction[:-late, :, k], 1000).max() < 0.2
        assert found.detected[1000:].mean() > 0.3


def test_all_channels_must_be_delayed_alike(estimate):
    """A tachometer with a low-pass of 5 Hz: read as it is, the hip's torque is lost; with its lag told, it is there."""
    log = WornLog(BLEEX, 10.0, seed=2)
    recording, lag = slow_tachometer(log, 5.0)
    errors = []
    for told in (0.0, lag):
        observer = MomentumObserver(estimate, 10.0, 1000.0, cutoff=np.inf, noise=log.sensors, velocity_delay=told)
        with nullcontext() if told else pytest.warns(UserWarning, match="give the observer velocity_delay="):
            read = observer.run(recording)
        late = round(float(observer.delay - told + lag) * 1000.0)
        errors.append(nrmse(read.torque[late:], log.wearer[:-late], read.settling))
    wrong, right = errors
    assert wrong[0] > 0.8
    assert right.max() < 0.25
    assert (wrong[:2] > 4.0 * right[:2]).all()


def test_a_torque_that_lags_is_aligned_by_the_delay_of_the_estimate(estimate):
    log = WornLog(BLEEX, 8.0, seed=6, noise=0.0, late=0.02)
    recording = log.recording()
    late = replace(estimate, torque_delays=np.full(3, 0.02))
    told, untold = (MomentumObserver(est, 10.0, 1000.0, noise=NOISE) for est in (late, estimate))
    assert told.delay == pytest.approx(untold.delay + 0.02)
    errors = []
    for observer in (told, untold):
        read = observer.run(recording).torque
        shift = round(told.delay * 1000.0)
        errors.append(nrmse(read[shift:], log.wearer[:-shift], 1000))
    assert errors[0].max() < 0.06
    assert errors[1].max() > 0.3


@pytest.mark.parametrize("tachometer", [None, 0.01])
def test_standard_deviation_is_that_of_readings_where_nobody_is(tachometer):
    log = WornLog(BLEEX, 40.0, seed=7, size=0.0, tachometer=tachometer)
    truth = ControlModel.of_parameters(log.model, log.values)
    smooth = {"width": TERMS[0].smoothing, "stiction": 0.0}
    observer = MomentumObserver(truth, 10.0, 1000.0, noise=log.sensors, cutoff=30.0, **smooth)
    found = observer.run(log.recording())
    ratio = np.sqrt(np.mean((found.torque / found.std)[observer.settling :] ** 2, axis=0))
    np.testing.assert_allclose(ratio, 1.0, atol=0.1)


@pytest.mark.slow
def test_band_of_the_parameters_is_the_spread_of_readings_with_other_parameters(estimate):
    """Readings of an exact log with parameters drawn from the estimate's covariance."""
    recording = WornLog(BLEEX, 1.5, seed=8, size=0.0, noise=0.0, tachometer=0.0).recording()
    settings = {"cutoff": np.inf, "width": TERMS[0].smoothing, "noise": SensorNoise(0.0)}
    wide = replace(estimate, covariance=100.0 * estimate.covariance, model_error=None)
    exact = MomentumObserver(replace(wide, residual_rms=np.zeros(3)), 10.0, 1000.0, **settings)
    draws = np.random.default_rng(0).multivariate_normal(estimate.values, wide.covariance, 200)
    models = [ControlModel.of_parameters(estimate.model, values) for values in draws]
    readings = np.array([MomentumObserver(one, 10.0, 1000.0, **settings).run(recording).torque for one in models])
    found = exact.run(recording)
    np.testing.assert_allclose(readings.std(axis=0)[300:].mean(axis=0), found.std[300:].mean(axis=0), rtol=0.08)


@pytest.mark.parametrize("pole", [0.0, 0.8, 0.98])
def test_noise_crosses_the_threshold_as_often_as_asked(pole):
    rng = np.random.default_rng(0)
    samples, rate = 2_000_000, 1000.0
    noise = lfilter([np.sqrt(1.0 - pole**2)], [1.0, -pole], rng.standard_normal(samples))
    above = np.abs(noise) > threshold(30.0, pole, rate)
    alarms = np.count_nonzero(above[1:] & ~above[:-1])
    assert alarms / (samples / rate / 60.0) == pytest.approx(30.0, rel=0.12)


def alarms_of(run, observer) -> np.ndarray:
    return np.array([observer.run(run.recording(k)).alarms for k in range(run.plant.count)]).sum(axis=0)


@pytest.mark.nightly
def test_joints_that_stick_raise_no_alarm(sticking):
    """The servo leaves torque on resting joints; without the band of stiction it counts as a wearer."""
    friction = {
        f"{s}_{label}": x for s in ("c0", "d") for label, x in zip(BLEEX.joint_labels, FRICTION[s], strict=True)
    }
    truth = Plant.build(BLEEX, friction)
    noise = SensorNoise.of(sticking.recording(0))
    assert ((np.abs(sticking.v) < 1e-9).mean(axis=(0, 2)) > 0.001).all()
    with_band, without = (
        MomentumObserver(truth, 10.0, 1000.0, noise=noise, torque_delay=HELD, stiction=x, cutoff=20.0)
        for x in (1.2, 0.0)
    )
    assert not alarms_of(sticking, with_band).any()
    assert alarms_of(sticking, without).any()


@pytest.mark.nightly
def test_ten_minutes_without_wearer_raise_no_alarm():
    run = sticking_run(BLEEX, 30, 20.5, seed=1)
    noise = SensorNoise.of(run.recording(0))
    observer = MomentumObserver(estimate_of(BLEEX, zero=0.0), 10.0, 1000.0, noise=noise, torque_delay=HELD)
    assert not alarms_of(run, observer).any()


def test_a_push_is_detected_within_a_few_delays(estimate):
    recording = WornLog(BLEEX, 4.0, seed=9, size=0.0).recording()
    tau = recording.tau.copy()
    tau[2500:, 0] -= 10.0
    pushed = replace(recording, tau=tau)
    observer = MomentumObserver(estimate, 10.0, 1000.0, noise=SensorNoise.of(recording))
    found = observer.run(pushed)
    first = np.argmax(found.detected[:, 0])
    assert 2500 < first < 2500 + 3.0 * observer.delay * 1000.0
    assert not found.detected[:2500].any()
    assert not found.detected[:, 1:].any()
    assert found.alarms[0] == 1.0
    assert "left_hip" in str(found)


def test_noise_is_measured_from_a_log():
    log = WornLog(BLEEX, 10.0, seed=11, tachometer=0.01)
    found = SensorNoise.of(log.recording())
    np.testing.assert_allclose(found.torque, TORQUE_NOISE, rtol=0.05)
    np.testing.assert_allclose(found.velocity, 0.01, rtol=0.05)
    np.testing.assert_allclose(found.angle, COUNT / np.sqrt(6.0), rtol=0.05)
    rng = np.random.default_rng(0)
    noisy = replace(log.recording(), q=log.walk.joints[0] + 1e-4 * rng.standard_normal((10_000, 3)))
    np.testing.assert_allclose(SensorNoise.of(noisy).angle, 1e-4, rtol=0.05)


def test_unknown_noise_is_measured_by_run_and_step_says_that_it_detects_nothing(estimate, worn):
    recording = worn.recording()
    observer = MomentumObserver(estimate, 10.0, 1000.0)
    given = replace(observer, noise=SensorNoise.of(recording))
    np.testing.assert_array_equal(observer.run(recording).std, given.run(recording).std)
    with pytest.warns(UserWarning, match="nothing is detected"):
        memory = observer.begin(recording.q[0])
    assert not observer.step(memory, recording.q[0], None, recording.tau[0] + 1e4)[0].detected.any()


def jump(recording):
    q = recording.q.copy()
    q[1234:, 1] += 2.0 * np.pi
    return replace(recording, q=q, largest_angle=np.inf)


def derived(recording):
    return np.gradient(recording.q, recording.time, axis=0)


def frozen(recording):
    q, v = recording.q.copy(), derived(recording)
    q[1000:, 1] = q[1000, 1]
    return replace(recording, q=q, v=v)


IN, RIGHT = UnreadableInputError, ("right_hip", "right_knee", "right_ankle")
LOGS = {
    "another rate": (lambda r: replace(r, time=2.0 * r.time), BadArgumentError, ()),
    "a gap": (lambda r: replace(r, time=r.time + 0.1 * (r.time > 2.0)), IN, ()),
    "a jump": (jump, IN, ("left_knee",)),
    "no torque": (lambda r: replace(r, tau=None), IN, BLEEX.joint_names),
    "currents": (lambda r: replace(r, tau=None, current=r.tau), IN, BLEEX.joint_names),
    "a joint without torque": (lambda r: replace(r, tau=r.tau * [1.0, np.nan, 1.0]), IN, ("left_knee",)),
    "a frozen angle": (frozen, IN, ("left_knee",)),
    "a velocity of the other sign": (lambda r: replace(r, v=derived(r) * [1.0, 1.0, -1.0]), IN, ("left_ankle",)),
    "a velocity of another scale": (lambda r: replace(r, v=derived(r) * [1.0, 1.5, 1.0]), IN, ("left_knee",)),
    "another leg": (lambda r: replace(r, joint_names=RIGHT), ExoidError, BLEEX.joint_names),
    "a tilt": (lambda r: replace(r, torso=TorsoMotion(pitch=0.2)), NotSupportedError, ()),
}


@pytest.mark.parametrize("mistake", LOGS)
def test_mistakes_of_logs_are_refused(mistake, estimate, worn):
    change, kind, joints = LOGS[mistake]
    observer = MomentumObserver(estimate, 10.0, 1000.0, noise=NOISE)
    with pytest.raises(kind) as raised:
        observer.run(change(worn.recording()))
    assert raised.value.joints == joints


REST, SHORT = np.zeros(3), np.zeros(2)
READINGS = [
    (np.array([0.1, np.nan, 0.0]), REST, UnreadableInputError, ("left_knee",)),
    (REST, np.array([0.0, 0.0, np.inf]), UnreadableInputError, ("left_ankle",)),
    (np.array([0.0, 0.0, 1.0]), REST, UnreadableInputError, ("left_ankle",)),
    (SHORT, REST, BadArgumentError, ()),
    (SHORT, SHORT, BadArgumentError, ()),
]


@pytest.mark.parametrize(("q", "tau", "kind", "joints"), READINGS)
def test_a_bad_reading_is_refused_and_the_memory_stays_good(q, tau, kind, joints, estimate):
    observer = MomentumObserver(estimate, 10.0, 1000.0, noise=NOISE)
    memory = observer.begin(REST)
    with pytest.raises(kind) as raised:
        observer.step(memory, q, None, tau)
    assert raised.value.joints == joints
    reading, after = observer.step(memory, REST, None, REST)
    assert np.isfinite(reading.torque).all()
    with pytest.raises(BadArgumentError):  # velocities that come at some samples only
        observer.step(after, REST, REST, REST)


SETTINGS = [("bandwidth", 0.0), ("bandwidth", (1.0, 2.0)), ("rate", -1.0), ("cutoff", 600.0), ("velocity_delay", 5.0)]
SETTINGS += [("false_alarms", 0.0), ("false_alarms", -1.0), ("width", 0.0), ("torque_delay", (0.0, 1.0))]


@pytest.mark.parametrize(("name", "value"), [*SETTINGS, ("noise", SensorNoise((1.0, 2.0)))])
def test_settings_that_make_no_sense_are_refused(name, value):
    with pytest.raises(ExoidError):
        MomentumObserver(**{"source": BLEEX, "bandwidth": 10.0, "rate": 1000.0, "noise": NOISE, name: value})
