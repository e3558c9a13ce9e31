"""The torque of the wearer is what joints need and actuators do not give; its band holds the truth."""

import dataclasses

import numpy as np
import pytest
from observing import nrmse
from standing import session, standing
from swings import with_payloads
from walking import Walk
from worn import filtered, log, push, swing, unworn_estimate

import exoid
from exoid import ExoidError, Payload, Recording
from exoid.actuators import Motor

LEGS = ("bleex", "cuhk")


@pytest.fixture(scope="module", params=LEGS)
def leg(request):
    return exoid.load_leg(request.param)


@pytest.fixture(scope="module")
def estimate(leg):
    return unworn_estimate(leg)


@pytest.fixture(scope="module")
def worn(leg):
    motion = swing(leg, 7)
    return motion, log(motion, push(motion)), push(motion)


def test_without_noise_it_is_the_filtered_torque_of_the_wearer(leg):
    exact = unworn_estimate(leg, noise=0.0)
    motion = swing(leg, 7)
    truth = push(motion)
    recording = log(motion, truth, noise=0.0)
    found = exoid.interaction(exact, recording)
    error = nrmse(found.torque, filtered(exact, recording, truth, found.time))
    assert error.max() < 0.02  # friction has another width than that of the term


def test_the_band_holds_the_truth_in_95_of_100_samples(leg, estimate):
    inside = []
    for seed in range(20, 28):
        motion = swing(leg, seed)
        truth = push(motion, seed)
        recording = log(motion, truth, seed=seed)
        found = exoid.interaction(estimate, recording)
        inside.append(np.abs(found.torque - filtered(estimate, recording, truth, found.time)) <= found.band)
    share = np.mean(np.concatenate(inside), axis=0)
    assert ((share > 0.93) & (share < 0.975)).all()


def test_the_sign_is_that_of_the_torque_on_the_leg(estimate, worn):
    motion, recording, _ = worn
    pushed = dataclasses.replace(recording, tau=recording.tau - 2.0)  # the wearer carries 2 N·m more
    difference = exoid.interaction(estimate, pushed).torque - exoid.interaction(estimate, recording).torque
    assert np.allclose(difference, 2.0, atol=1e-6)
    drives = log(motion, 4.0 * motion.motion[1])  # along the velocity
    assert (exoid.interaction(estimate, drives).power > 0.0).all()


def test_an_unworn_leg_is_not_called_worn(leg, estimate):
    for seed in range(30, 36):
        for factor in (1.0, 2.0):
            assert not exoid.interaction(estimate, log(swing(leg, seed, base=0.15 * factor), seed=seed)).worn


@pytest.mark.parametrize("rate", [0.05, 0.1])
def test_the_band_holds_the_friction_of_a_joint_that_creeps(leg, rate):
    """At a few hundredths of a rad/s the model's smooth sign is part of the friction, and real friction is whole."""
    time, n = np.arange(6000) / 100.0, len(leg.joint_names)
    estimate = exoid.identify(leg, log(swing(leg, 1)), check=False)
    phase = 2.0 * np.pi * rate * time[:, None] + np.arange(n)
    q, v = 0.02 / rate / 2.0 / np.pi * np.sin(phase), 0.02 * np.cos(phase)
    coulomb = [estimate.value(f"c0_{label}") for label in leg.joint_labels]
    tau = estimate.torque(q, v, 0.0 * q) + coulomb * (np.sign(v) - np.tanh(v / 0.015))
    found = exoid.interaction(estimate, Recording(time=time, q=q, tau=tau, joint_names=leg.joint_names))
    assert (found.outside_band < 0.05).all()


def test_a_torque_twice_as_large_as_the_smallest_that_the_test_notices_is_noticed(leg, estimate):
    motion = swing(leg, 9)
    least = np.array([action.least for action in exoid.interaction(estimate, log(motion)).actions])
    shape = push(motion)
    found = exoid.interaction(estimate, log(motion, 2.0 * least * shape / shape.std(axis=0)))
    assert all(action.acts for action in found.actions)


@pytest.mark.parametrize(
    "name", ["bleex_swing", pytest.param("dfki_double_pendulum", marks=pytest.mark.real_data("dfki_double_pendulum"))]
)
def test_logs_without_a_wearer_are_not_worn(name):
    data = getattr(exoid.datasets, name)()
    estimate = exoid.identify(data.leg, data.train)
    assert not exoid.interaction(estimate, data.test).worn
    assert not exoid.interaction(estimate, data.train).worn


def test_the_base_may_move():
    leg = exoid.load_leg("bleex")
    estimate = exoid.identify(leg, Walk(leg, seconds=60.0, seed=1).recording(), terms=())
    walk = Walk(leg, seconds=30.0, seed=2)
    truth = 8.0 * np.column_stack([np.sin(2.0 * np.pi * f * walk.time) for f in (0.6, 1.1, 0.9)])
    unworn = walk.recording()
    recording = dataclasses.replace(unworn, tau=unworn.tau - truth)
    found = exoid.interaction(estimate, recording)
    assert nrmse(found.torque, filtered(estimate, recording, truth, found.time)).max() < 0.08
    assert found.worn
    assert not exoid.interaction(estimate, unworn).worn


def test_drives_give_the_torque_of_the_actuators(estimate, leg, worn):
    motion, recording, _ = worn
    motors = {name: Motor(torque_constant=0.1, ratio=50.0) for name in leg.joint_names}
    current = recording.tau / (0.1 * 50.0)
    driven = Recording(motion.time, recording.q, current=current, joint_names=leg.joint_names)
    found = exoid.interaction(estimate, driven, actuators=motors)
    assert np.allclose(found.torque, exoid.interaction(estimate, recording).torque, atol=1e-9)
    with pytest.raises(ExoidError):
        exoid.interaction(estimate, driven)


def test_a_stated_payload_is_not_taken_for_a_wearer(leg, estimate):
    motion = swing(leg, 7)
    sand = Payload(leg.joint_names[1], 3.0, (0.0, 0.0, -0.3))
    recording = log(dataclasses.replace(motion, leg=with_payloads(leg, [sand])))
    stated = exoid.interaction(estimate, dataclasses.replace(recording, payloads=(sand,)))
    assert not stated.worn
    forgotten = exoid.interaction(estimate, recording)
    assert forgotten.worn
    (finding,) = [each for each in forgotten.findings if each.kind == "body-like-interaction"]
    assert "more torque than the estimate says" in finding.message
    assert "payload" in finding.remedy


def test_samples_near_the_ends_are_left_out_and_so_are_those_outside_segments(estimate, worn):
    recording = worn[1]
    found = exoid.interaction(estimate, recording)
    assert recording.time[0] < found.time[0]
    assert found.time[-1] < recording.time[-1]
    part = exoid.interaction(estimate, recording.segments([(10.0, 15.0), (20.0, 30.0)]))
    assert ((part.time <= 15.0) | (part.time >= 20.0)).all()
    common = np.isin(np.round(found.time, 6), np.round(part.time[(part.time > 21.0) & (part.time < 29.0)], 6))
    inner = (part.time > 21.0) & (part.time < 29.0)
    assert np.allclose(found.torque[common], part.torque[inner], atol=1e-6)


@pytest.mark.nightly
def test_a_foot_on_the_ground_needs_a_measured_wrench():
    exo = exoid.load_exo("bleex", base="floating")
    options = {"seconds": 20.0, "noise": 0.4, "encoder": 1e-4}
    estimate = exoid.identify(exo, [log.recording for log in session(exo, **options)], terms=())
    log = standing(exo, "left", seed=7, **options)
    with pytest.raises(ExoidError):
        exoid.interaction(estimate, log.recording)
    measured = dataclasses.replace(log.recording, wrenches={"left_foot": log.wrenches["left_foot"]})
    assert not exoid.interaction(estimate, measured).worn
    truth = 8.0 * np.column_stack([np.sin(2.0 * np.pi * (0.5 + 0.1 * k) * log.recording.time) for k in range(6)])
    recording = dataclasses.replace(measured, tau=measured.tau - truth)
    found = exoid.interaction(estimate, recording)
    assert found.worn
    assert nrmse(found.torque, filtered(estimate, recording, truth, found.time)).max() < 0.2


LOGS = {
    "no torque": lambda log: dataclasses.replace(log, tau=None),
    "torques that are not numbers": lambda log: dataclasses.replace(log, tau=np.full_like(log.tau, np.nan)),
    "too short": lambda log: log.between(log.time[0], log.time[0] + 0.12),
    "none at all": lambda log: [],
    "a name": lambda log: ["log.csv"],
}


@pytest.mark.parametrize("what", LOGS)
def test_logs_that_say_nothing_are_refused(estimate, worn, what):
    with pytest.raises(ExoidError):
        exoid.interaction(estimate, LOGS[what](worn[1]))
