"""Runs: sensors, rates, seeds, batches and refusals."""

import re

import numpy as np
import pytest
from planar_chains import random_chain
from rigs import BLEEX, EVERYTHING, FRICTION, Swing

import exoid
from exoid import ExoidError, Leg
from exoid.experiments import Hold
from exoid.leg.description import describe
from exoid.rig import (
    HydraulicServo,
    IdealTorque,
    Plant,
    Proportional,
    ProportionalDerivative,
    Rates,
    Sensors,
    simulate,
)
from exoid.rig.sensors import read_angle, read_torque, read_velocity

SERVO = HydraulicServo(5000.0, 0.01, 10.0)
PLANT = Plant.build(BLEEX, EVERYTHING)
NOISY = Sensors(encoder_counts=2.0**14, angle_noise=1e-4, velocity_noise=0.01, torque_noise=(0.3, 0.2, 0.1))


def run(plant=PLANT, duration=1.0, **options):
    options = {"rates": Rates(step=1e-3), **options}
    return simulate(plant, options.pop("reference", Swing()), Proportional(1.0), SERVO, duration, **options)


def test_an_encoder_counts():
    q = np.random.default_rng(0).normal(size=(3, 500))
    read = read_angle(Sensors(encoder_counts=2.0**10), q, np.random.default_rng(0))
    count = 2 * np.pi / 2**10
    np.testing.assert_allclose(read / count, np.rint(read / count), atol=1e-9)
    assert 0.4 * count < np.abs(read - q).max() <= 0.5 * count * (1 + 1e-9)


def test_noise_has_the_standard_deviation_asked_for():
    rng, true = np.random.default_rng(1), np.zeros((3, 40_000))
    sensors = Sensors(
        np.inf, angle_noise=(0.1, 0.2, 0.3), velocity_noise=0.5, torque_noise=(1.0, 0.0, 2.0), torque_offset=3.0
    )
    np.testing.assert_allclose(read_angle(sensors, true, rng).std(axis=1), [0.1, 0.2, 0.3], rtol=0.02)
    np.testing.assert_allclose(read_velocity(sensors, true, rng).std(axis=1), 0.5, rtol=0.02)
    torque = read_torque(sensors, true, rng)
    np.testing.assert_allclose(torque.std(axis=1), [1.0, 0.0, 2.0], rtol=0.02)
    np.testing.assert_allclose(torque.mean(axis=1), 3.0, atol=0.05)


@pytest.mark.parametrize("delay", [1, 4])
def test_delayed_readings_are_those_of_earlier_control_periods(delay):
    rates = Rates(control=100.0, log=100.0, step=1e-3)
    late = run(sensors=Sensors(np.inf, delay=delay), rates=rates)
    np.testing.assert_array_equal(late.q_measured[delay:], late.q[:-delay])
    np.testing.assert_array_equal(late.v_measured[delay:], late.v[:-delay])
    np.testing.assert_array_equal(late.tau_measured[delay:], late.tau[:-delay])
    np.testing.assert_array_equal(late.q_measured[:delay], np.broadcast_to(late.q[0], (delay, 3, 1)))


def test_a_delay_counts_in_control_periods_however_often_the_log_reads():
    often = run(sensors=Sensors(np.inf, delay=2), rates=Rates(control=50.0, log=200.0, step=1e-3))
    np.testing.assert_array_equal(often.q_measured[8:], often.q[:-8])


def test_the_same_seed_gives_the_same_bytes_and_another_one_does_not():
    one, same, other = (run(sensors=NOISY, seed=seed) for seed in (3, 3, 4))
    for name in ("time", "q", "v", "tau", "q_measured", "v_measured", "tau_measured", "target"):
        assert getattr(one, name).tobytes() == getattr(same, name).tobytes()
    assert (one.tau_measured != other.tau_measured).mean() > 0.99


def test_rigs_in_a_batch_behave_like_single_rigs():
    plants = [Plant.build(BLEEX, {**FRICTION, "b1_knee": x, "Ia_hip": 0.1 * x}, pitch=0.1 * x) for x in range(5)]
    together = run(Plant.concatenate(plants))
    for k, plant in enumerate(plants):
        alone = run(plant)
        np.testing.assert_allclose(together.q[..., k], alone.q[..., 0], rtol=0, atol=1e-10)
        np.testing.assert_allclose(together.tau[..., k], alone.tau[..., 0], rtol=0, atol=1e-6)
        np.testing.assert_allclose(together.energy.work[k], alone.energy.work[0], rtol=1e-8)
    assert np.abs(together.tau[..., 0] - together.tau[..., 4]).max() > 1.0


def test_a_leg_that_is_not_planar_runs_on_pinocchio():
    first, rest = random_chain(np.random.default_rng(2), 2).text.split("<axis", 1)
    turned = re.sub(r'xyz="[^"]*"', 'xyz="0.6 0 0.8"', rest, count=1)
    leg = Leg.from_description(describe(f"{first}<axis{turned}"))
    assert leg.chain is None
    plant = Plant.build(leg, {"c0_hip": 0.5, "c0_knee": 0.5, "d_hip": 0.1})
    law = ProportionalDerivative(50.0, 5.0)
    done = simulate(plant, Hold(np.full((2, 1), 0.2)), law, IdealTorque(), 2.0, start=np.zeros((2, 1)))
    assert np.abs(done.q[-1]).max() > 0.0
    assert done.energy.relative_error[0] < 1e-4


def test_a_log_becomes_a_recording():
    done = run(Plant.build(BLEEX, FRICTION, pitch=0.2), sensors=NOISY)
    recording = done.recording(velocity=True)
    assert recording.joint_names == BLEEX.joint_names
    assert recording.sample_rate == pytest.approx(50.0)
    assert recording.torso.pitch == pytest.approx(0.2)
    np.testing.assert_array_equal(recording.tau, done.tau_measured[..., 0])
    np.testing.assert_array_equal(recording.v, done.v_measured[..., 0])
    assert done.recording().v is None
    with pytest.raises(ExoidError, match="no rig 1"):
        done.recording(1)


def test_a_rig_obeys_its_own_inverse_dynamics():
    """A run sampled at every step, differentiated: torque = RNEA + friction + springs + rotor where the leg moves."""
    leg = exoid.load_leg("cuhk")
    plant = Plant.build(leg, {"c0_hip": 1.4, "d_knee": 0.2, "b1_knee": 0.5, "Ia_hip": 0.8}, end_stops=False)
    reference = Hold(np.array([[0.5], [0.9]]))
    step = 2e-4
    done = simulate(
        plant,
        reference,
        Proportional(80.0),
        IdealTorque(),
        0.5,
        start=np.zeros((2, 1)),
        rates=Rates(100.0, 1 / step, step),
    )
    q, v = (0.5 * (x[1:, :, 0] + x[:-1, :, 0]) for x in (done.q, done.v))
    a = np.diff(done.v[..., 0], axis=0) / step
    expected = leg.inverse_dynamics(q, v, a)
    expected[:, 0] += 1.4 * np.sign(v[:, 0]) + 0.8 * a[:, 0]
    expected[:, 1] += 0.2 * v[:, 1] + 0.5 * q[:, 1]
    turning = (np.sign(done.v[1:, 0, 0]) != np.sign(done.v[:-1, 0, 0])) | (np.abs(v[:, 0]) < 0.01)
    assert turning.mean() < 0.2
    error = np.abs(done.tau[1:, :, 0] - expected)[~turning]
    assert np.median(error) < 1e-3
    assert error.max() < 0.05  # in the one step after each jump of the command, of tens of N·m
