"""Runs: sensors, rates, seeds, batches and refusals."""

import numpy as np
import pytest
from one_joint import URDF
from rigs import BLEEX, EVERYTHING, FRICTION, Swing

from exoid import ExoidError, Leg
from exoid.rig import (
    HydraulicServo,
    IdealTorque,
    Plant,
    ProportionalDerivative,
    Rates,
    Sensors,
    Target,
    simulate,
)
from exoid.rig.sensors import read_angle, read_torque, read_velocity

SERVO = HydraulicServo(5000.0, 0.01, 10.0)
PLANT = Plant.build(BLEEX, EVERYTHING)
NOISY = Sensors(encoder_counts=2.0**14, angle_noise=1e-4, velocity_noise=0.01, torque_noise=(0.3, 0.2, 0.1))


def run(plant=PLANT, duration=1.0, **options):
    options = {"rates": Rates(step=1e-3), **options}
    return simulate(plant, options.pop("reference", Swing()), ProportionalDerivative(1.0), SERVO, duration, **options)


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


@pytest.mark.parametrize(("delay", "control", "log"), [(1, 100.0, 100.0), (4, 100.0, 100.0), (2, 50.0, 200.0)])
def test_delayed_readings_are_those_of_earlier_control_periods(delay, control, log):
    """However often the log reads."""
    late = run(sensors=Sensors(np.inf, delay=delay), rates=Rates(control=control, log=log, step=1e-3))
    delay *= round(log / control)  # in samples of the log
    np.testing.assert_array_equal(late.q_measured[delay:], late.q[:-delay])
    np.testing.assert_array_equal(late.v_measured[delay:], late.v[:-delay])
    np.testing.assert_array_equal(late.tau_measured[delay:], late.tau[:-delay])
    np.testing.assert_array_equal(late.q_measured[:delay], np.broadcast_to(late.q[0], (delay, 3, 1)))


@pytest.mark.slow
def test_the_same_seed_gives_the_same_bytes_and_another_one_does_not():
    one, same, other = (run(sensors=NOISY, seed=seed) for seed in (3, 3, 4))
    for name in ("time", "q", "v", "tau", "q_measured", "v_measured", "tau_measured", "target"):
        assert getattr(one, name).tobytes() == getattr(same, name).tobytes()
    assert (one.tau_measured != other.tau_measured).mean() > 0.99


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


def test_a_joint_that_turns_is_recorded_in_radians(tmp_path):
    """Four turns are no degrees."""

    class Turning:
        def at(self, time):
            return Target(np.array([[8.0 * time]]), np.array([[8.0]]))

    path = tmp_path / "one.urdf"
    path.write_text(URDF.replace("revolute", "continuous"), encoding="utf-8")
    plant = Plant.build(Leg.from_urdf(path), {})
    turned = simulate(plant, Turning(), ProportionalDerivative(500.0, 20.0), IdealTorque(), 3.0).recording()
    assert turned.q[-1, 0] == pytest.approx(24.0, abs=0.5)
