"""Ground that leans under feet: gravity is turned, and all mass moments would be."""

import re
from dataclasses import replace

import numpy as np
import pytest
from standing import TERMS, friction, mirrored, session, standing, with_imu

import exoid
from exoid import Wrench

pytestmark = pytest.mark.slow


def logs(exo, lean, seed):
    return [log.recording for log in runs(exo, lean, seed)]


def runs(exo, lean, seed):
    options = {"noise": 0.4, "encoder": 1e-4, "friction": friction, "lean": lean}
    return session(exo, 20 * seed, seconds=10.0, **options)


def deviation(estimate, exo):
    """Root mean square of the errors of all parameters over their standard deviations."""
    truth = [*exo.parameters, *(1.5,) * 6, *(0.8,) * 6]
    return np.sqrt(np.mean(np.square((estimate.values - truth) / estimate.std)))


@pytest.mark.nightly
@pytest.mark.parametrize("degrees", [pytest.param(0.5, marks=pytest.mark.nightly), -3.0])
def test_the_lean_is_found_and_intervals_hold(exo, degrees):
    deviations = []
    for seed in (1000, 1001):
        estimate = exoid.identify(exo, logs(exo, np.deg2rad(degrees), seed), TERMS)
        (finding,) = (one for one in estimate.findings if one.kind == "base-from-feet")
        low, high = finding.interval
        assert low - 0.03 < abs(degrees) < high + 0.03
        assert high - low < 0.03  # as on level ground, not 0.35° by the noise of a fit that takes it for level
        assert finding.severity == ("warning" if abs(degrees) > 1.0 else "info")
        assert not any(one.severity == "error" for one in estimate.findings)
        deviations.append(
            (estimate.values[: len(exo.parameters)] - exo.parameters) / estimate.std[: len(exo.parameters)]
        )
    assert np.sqrt(np.mean(np.square(deviations))) < 1.4
    assert np.mean(np.abs(deviations) < 2.0) > 0.88


@pytest.mark.parametrize("degrees", [0.0, -3.0])
def test_feet_on_ground_that_leans_are_no_bias_of_an_imu(exo, degrees):
    """A bias of 0.5 m/s² that level feet would tell moved the mass by 1 %; the torques say that the ground leans."""
    measured = [with_imu(log, k) for k, log in enumerate(runs(exo, np.deg2rad(degrees), 1000))]
    estimate = exoid.identify(exo, measured, TERMS, check=False)
    assert deviation(estimate, exo) < 1.4
    biases = [one.value for one in estimate.findings if one.kind == "imu-bias"]
    np.testing.assert_allclose(biases, np.hypot(0.1, 0.15), atol=0.01)
    leans = [one for one in estimate.findings if one.kind in ("base-from-feet", "imu-position")]
    assert [(one.severity, round(one.value, 1)) for one in leans] == ([("warning", 3.0)] if degrees else [])


def test_a_lean_counts_for_logs_with_and_without_an_imu(exo):
    """Feet told the bias of the sensor as if on level ground, 0.5 m/s² too much; the other logs say that it leans."""
    every = runs(exo, np.deg2rad(-3.0), 1000)
    mixed = [with_imu(every[0], 0), *(log.recording for log in every[1:])]
    estimate = exoid.identify(exo, mixed, TERMS, check=False)
    assert deviation(estimate, exo) < 1.4
    (bias,) = (one for one in estimate.findings if one.kind == "imu-bias")
    assert bias.value == pytest.approx(np.hypot(0.1, 0.15), abs=0.03)  # not 0.6, as of level ground
    (leans,) = (one for one in estimate.findings if one.kind == "base-from-feet")
    assert (leans.severity, round(leans.value, 1)) == ("warning", 3.0)


def rocking(time):
    """Angle of a foot that rocks by 8 mrad [rad]."""
    return 0.008 * (np.sin(5.3 * time) + np.sin(3.1 * time + 1.0))


RIDGE = 0.03 - 0.117j


def rocking_logs(exo, sole, plates=False):
    options = {"noise": 0.4, "encoder": 1e-4, "friction": friction, "sole": sole, "pivot": RIDGE}
    every, rng = session(exo, 60, seconds=10.0, **options), np.random.default_rng(6)
    if not plates:
        return [log.recording for log in every]

    def measured(wrench):
        force, moment = rng.standard_normal((2, *wrench.force.shape))
        return Wrench(wrench.force + force, wrench.moment + 0.2 * moment)

    wrenches = [{link: measured(wrench) for link, wrench in log.wrenches.items()} for log in every]
    return [replace(log.recording, wrenches=of_log) for log, of_log in zip(every, wrenches, strict=True)]


def test_bands_of_torques_hold_feet_that_rock(exo):
    """Without what the motion of the feet leaves open of the base, they held 1 to 8 % of the torque."""
    estimate = exoid.identify(exo, logs(exo, 0.0, 3), TERMS, check=False)
    options = {"noise": 0.4, "encoder": 1e-4, "friction": friction}
    for sole, least in ((np.zeros_like, 0.96), (rocking, 0.8)):
        new = standing(exo, "both", seconds=10.0, seed=77, sole=sole, **options).recording
        assert exoid.validate(estimate, new).coverage.min() > least


@pytest.mark.nightly
@pytest.mark.parametrize(("sole", "plates"), [(np.zeros_like, False), (rocking, False), (rocking, True)])
def test_feet_that_rock_without_an_imu_are_named_and_intervals_hold(exo, sole, plates):
    """Masses were wrong by up to 90 % at narrow intervals while such feet counted as flat."""
    estimate = exoid.identify(exo, rocking_logs(exo, sole, plates), TERMS, check=False)
    named = [one for one in estimate.findings if one.kind == "rocking-foot"]
    assert len(named) == (sole is rocking)
    assert deviation(estimate, exo) < 1.4
    if named:
        assert named[0].value == pytest.approx(0.008, rel=0.1)
        assert named[0].severity == "warning"
        assert "M" in named[0].parameters
        before, below = map(
            float, re.search(r"left_foot about a place (\S+) .* and (\S+) ±", named[0].message).groups()
        )
        assert np.hypot(before - 30.0, below - 117.0) < 30.0


def test_feet_that_rock_for_too_long_to_be_found_are_an_error(exo, monkeypatch):
    monkeypatch.setattr("exoid.identification.on_ground.MOST", 10)
    estimate = exoid.identify(exo, rocking_logs(exo, rocking), TERMS, check=False)
    (named,) = (one for one in estimate.findings if one.kind == "rocking-foot")
    assert named.severity == "error"
    assert named.parameters == exo.parameter_names


def test_feet_that_rock_tell_no_bias(exo):
    """The foot leans by 10 mrad in each log, now forward and now back: torques tell the bias, which is one of all."""
    measured = []
    for k, lean in enumerate((0.01, -0.01)):
        options = {"noise": 0.4, "encoder": 1e-4, "friction": friction, "sole": lambda t, lean=lean: lean + 0.0 * t}
        log = standing(exo, "left", seconds=10.0, seed=30 + k, **options)
        measured.append(with_imu(mirrored(log) if k else log, k))
    whole = with_imu(standing(exo, "both", seconds=10.0, seed=32, noise=0.4, encoder=1e-4, friction=friction), 2)
    estimate = exoid.identify(exo, [whole, *measured], TERMS, check=False)
    assert deviation(estimate, exo) < 1.4
    (finding,) = (one for one in estimate.findings if one.kind == "imu-bias")
    low, high = finding.interval
    assert low < np.hypot(0.1, 0.15) < high


def thrice(time):
    """Angle of a foot that stands level, then tips onto its toe, then onto its heel [rad]."""
    return 0.0052 * (np.tanh((time - 4.0) / 0.05) - 2.0 * np.tanh((time - 8.0) / 0.05) - 1.0)


def test_rests_that_differ_tell_no_bias_and_are_named(exo):
    """The foot stands thrice, each time otherwise by 10 mrad: the other logs of the session tell the bias."""
    whole, left, right = runs(exo, 0.0, 1001)
    options = {"noise": 0.4, "encoder": 1e-5, "friction": friction}
    turns = standing(exo, "left", seconds=12.0, seed=5, sole=thrice, **options)
    moves = (np.abs(turns.recording.time[:, None] - (4.0, 8.0)) < 0.4).any(axis=1)
    unrested = replace(with_imu(turns, 1, noise=0.1), mask=~moves, contacts={"left_foot": ~moves})
    estimate = exoid.identify(exo, [unrested, *(with_imu(log, 2) for log in (whole, left, right))], TERMS, check=False)
    (rocking,) = (one for one in estimate.findings if one.kind == "rocking-foot")
    assert rocking.severity == "warning"
    assert rocking.value == pytest.approx(0.0086, rel=0.1)  # of -10, 0 and 10 mrad, a third of the time each
    assert deviation(estimate, exo) < 1.4


@pytest.fixture(scope="module")
def of_level_ground(exo):
    return exoid.identify(exo, logs(exo, 0.0, 1002), TERMS, check=False)


@pytest.mark.parametrize(("degrees", "imu"), [(0.0, False), (3.0, False), (-3.0, True)])
def test_bands_of_the_ground_force_hold_on_the_ground_of_a_log_that_is_predicted(exo, of_level_ground, degrees, imu):
    """On ground that leans by 3° they held 67 to 70 %; the torques of the log say how its ground leans."""
    options = {"noise": 0.4, "encoder": 1e-4, "friction": friction, "lean": np.deg2rad(degrees)}
    log = standing(exo, "left", seconds=5.0, seed=1100, **options)
    ground = exoid.ground_forces(of_level_ground, with_imu(log, 7) if imu else log.recording)["left_foot"]
    wrench, rows = log.wrenches["left_foot"], np.searchsorted(log.recording.time, ground.time)
    forward, up = (np.abs(ground.force - wrench.force[rows])[:, axis] <= ground.force_half[:, axis] for axis in (0, 2))
    pitch = np.abs(ground.moment - wrench.moment[rows])[:, 1] <= ground.moment_half[:, 1]
    assert min(forward.mean(), up.mean(), pitch.mean()) > 0.93
    assert np.median(ground.force_half[:, 0]) < 0.02 * np.median(wrench.force[:, 2])
