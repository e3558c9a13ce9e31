"""The cut-off follows the noise of the angles."""

import dataclasses

import numpy as np
import one_joint
import pytest
from one_joint import write_urdf

import exoid
from exoid.signals import Recording, ZeroPhase, choose_preparation
from exoid.signals.cutoff import robust_std, white_noise


def log(noise=0.0, rate=500.0, seconds=20.0, seed=0, amplitude=0.4, joints=2):
    """Sines of 0.5 and 0.3 Hz, and white noise of so many radians."""
    time = np.arange(round(seconds * rate)) / rate
    q = amplitude * np.sin(2.0 * np.pi * np.array([0.5, 0.3]) * time[:, None])[:, :joints]
    q = q + noise * np.random.default_rng(seed).standard_normal(q.shape)
    return Recording(time, q, joint_names=("a", "b")[:joints])


def noise_of_acceleration(recording, cutoff, noise):
    """Noise over acceleration of the rows, root mean square, from the two recordings themselves."""
    preparation = ZeroPhase(cutoff, kinematics_cutoff=2.0 * cutoff)

    def acceleration(data):
        a, valid = preparation.kinematics(data)[2:]
        inside = np.zeros((len(a), 1))
        inside[valid] = 1.0
        return preparation.filter(a * inside, data.sample_rate)[valid]

    quiet, loud = (acceleration(data) for data in (recording(0.0), recording(noise)))
    return np.sqrt(((loud - quiet) ** 2).mean(axis=0) / (quiet**2).mean(axis=0))


def test_quiet_angles_get_the_highest():
    assert choose_preparation([log()]).cutoff == 8.0
    assert choose_preparation([log(1e-6)]).cutoff == 8.0


@pytest.mark.parametrize(("noise", "rate"), [(1e-3, 500.0), (1e-4, 50.0), (1e-3, 50.0)])
def test_the_acceleration_of_the_rows_has_about_two_percent_of_noise(noise, rate):
    cutoff = choose_preparation([log(noise, rate)]).cutoff
    assert 1.0 < cutoff < 8.0
    share = noise_of_acceleration(lambda level: log(level, rate), cutoff, noise)
    assert 0.01 < share.max() < 0.03


def test_ten_times_the_density_of_noise_lowers_it_by_the_fifth_root_of_ten():
    fast, slow = (choose_preparation([log(1e-3, rate)]).cutoff for rate in (500.0, 50.0))
    assert fast / slow == pytest.approx(10.0**0.2, rel=0.1)


def test_a_joint_that_rests_in_one_of_several_recordings_does_not_count_there():
    """As in experiments that move one joint at a time."""
    whole = log(1e-4)
    first, second = (dataclasses.replace(whole, q=whole.q * mask + 1e-5) for mask in ([1.0, 1e-3], [1e-3, 1.0]))
    assert choose_preparation([first, second]).cutoff == pytest.approx(choose_preparation([whole]).cutoff, abs=1.5)


def test_the_noisiest_joint_decides():
    loud, quiet = log(1e-3), log()
    q = np.column_stack([quiet.q[:, 0], loud.q[:, 1]])
    assert choose_preparation([dataclasses.replace(quiet, q=q)]).cutoff == pytest.approx(
        choose_preparation([loud]).cutoff, abs=0.3
    )


def test_what_touch_downs_shake_passes_up_to_where_it_meets_noise():
    quiet = log(1e-4)
    ringing = 0.01 * np.exp(-10.0 * (quiet.time % 1.0)) * np.sin(2.0 * np.pi * 30.0 * quiet.time)
    shaken = dataclasses.replace(quiet, q=quiet.q + ringing[:, None])
    down = {"foot": quiet.time % 1.0 < 0.6}
    assert 35.0 < choose_preparation([dataclasses.replace(shaken, contacts=down)]).kinematics_cutoff < 150.0
    assert choose_preparation([dataclasses.replace(quiet, contacts=down)]).kinematics_cutoff is None
    assert choose_preparation([shaken]).kinematics_cutoff is None  # of a drive's ripple nothing is known


def test_a_short_recording_keeps_half_of_its_samples():
    short = log(3e-3, 100.0, 3.0)
    cutoff = choose_preparation([short]).cutoff
    assert cutoff > choose_preparation([log(3e-3, 100.0, 30.0)]).cutoff
    assert 2 * ZeroPhase(cutoff).edge(100.0) <= 0.5 * len(short)


@pytest.mark.parametrize("recorded", [False, True])
@pytest.mark.parametrize("rate", [5.0, 10.0, 20.0, 25.0])
def test_a_slow_log_is_accepted_with_a_lower_cutoff(tmp_path, rate, recorded):
    """Also if it contains accelerations, whose noise is that of their sensor."""
    leg = write_urdf(tmp_path / "one.urdf")
    log = one_joint.swing(leg, seconds=120.0, rate=rate)
    if recorded:
        motion = ZeroPhase(cutoff=0.2 * rate).kinematics(log)
        log = dataclasses.replace(log, v=motion.v, a=motion.a)
    assert choose_preparation([log]).cutoff == pytest.approx(0.2 * rate)
    estimate = exoid.identify(leg, log)
    np.testing.assert_allclose([estimate["X1"].value, estimate["J1"].value], leg.parameters[[0, 2]], rtol=0.02)


def test_outliers_hardly_change_the_robust_standard_deviation():
    x = 3.0 * np.random.default_rng(0).standard_normal(10_000)
    x[:200] = 1e6
    assert float(robust_std(x)) == pytest.approx(3.0, rel=0.05)


def test_white_noise_is_found_beside_a_motion():
    time = np.arange(0.0, 20.0, 0.002)
    sizes = np.array([1e-4, 0.05])
    noise = sizes * np.random.default_rng(1).standard_normal((len(time), 2))
    motion = np.column_stack([np.sin(6.0 * time), 9.81 + 3.0 * np.cos(9.0 * time)])
    np.testing.assert_allclose(white_noise(motion + noise), sizes, rtol=0.05)
