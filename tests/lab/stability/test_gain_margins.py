"""Gain margins of a sampled controller, against simulation and a case with a closed solution."""

from __future__ import annotations

import numpy as np
import pytest
from controlled_legs import cuhk_plant, frictionless

import exoid
from exoid import ExoidError
from exoid.control import SHARP, SMOOTH, gravity_friction_pd, pd, simulate_law
from exoid.experiments import Hold
from exoid.lab.stability.gain_margin import gain_margins, spectral_radius
from exoid.rig import Plant, Sensors

KP, KD = np.array([22.1, 55.6]), np.array([2.21, 5.56])
POSE = np.deg2rad([10.0, 40.0])
BARE = frictionless(cuhk_plant(0.0, end_stops=False))


def law(scale, rate):
    return gravity_friction_pd(BARE, scale * KP, scale * KD, friction=None, rate=rate)


@pytest.fixture(scope="module")
def margins():
    return gain_margins(BARE, law, POSE, rates=(30.0, 100.0, 300.0), delays=(0, 1, 2))


def test_a_faster_law_bears_more_gain_and_a_later_one_less(margins):
    assert (np.diff(margins.margins, axis=0) > 0.0).all()
    assert (np.diff(margins.margins, axis=1) < 0.0).all()


def test_fast_laws_bear_gain_in_proportion_to_their_rate(margins):
    """The damping limits: Kd T / M is what counts."""
    assert margins.margins[2, 0] / margins.margins[1, 0] == pytest.approx(3.0, rel=0.1)


def test_the_radius_is_one_at_the_margin(margins):
    for k, rate in enumerate(margins.rates):
        for j, delay in enumerate(margins.delays):
            scale = margins.margins[k, j]
            assert spectral_radius(BARE, law(scale, rate), POSE, delay) == pytest.approx(1.0, abs=1e-5)
            assert spectral_radius(BARE, law(0.9 * scale, rate), POSE, delay) < 1.0
            assert spectral_radius(BARE, law(1.1 * scale, rate), POSE, delay) > 1.0


@pytest.mark.parametrize("rate", [30.0, 100.0])
@pytest.mark.parametrize("delay", [0, 1])
def test_the_simulated_leg_settles_below_the_margin_and_not_above(margins, rate, delay):
    """Started half a hundredth of a degree off, with readings that are late."""
    margin = margins.margins[margins.rates.index(rate), margins.delays.index(delay)]
    grown = {}
    for share in (0.85, 1.15):
        run = simulate_law(
            BARE,
            law(share * margin, rate),
            Hold(POSE[:, None]),
            60.0 / rate,
            start=POSE + np.deg2rad([0.005, -0.005]),
            sensors=Sensors(encoder_counts=np.inf, delay=delay),
            log_rate=rate,
        )
        size = np.abs(run.error).max(axis=1)
        grown[share] = size[-15:].max() / size[:15].max()
    assert grown[0.85] < 0.5
    assert grown[1.15] > 2.0


def test_one_joint_without_gravity_is_the_case_that_can_be_done_by_hand():
    """J ÷ (Kd T) of a damper on a free joint: x⁺ = (1 − Kd T / J) x is stable up to Kd T / J = 2."""
    pendulum = exoid.Leg.from_urdf(exoid.catalog.urdf_folder() / "cuhk.urdf", ("left_knee",))
    inertia = float(pendulum.parameters[pendulum.parameter_names.index("J1")])
    weightless = Plant.build(pendulum, {"X1": 0.0, "Y1": 0.0}, end_stops=False)
    # an angle that nothing pulls back keeps an eigenvalue of exactly one: a touch of stiffness moves it inside
    found = gain_margins(weightless, lambda s, rate: pd(1e-6, s, rate=rate), [0.3], rates=[50.0], delays=[0])
    assert found.margins[0, 0] == pytest.approx(2.0 * inertia * 50.0, rel=1e-4)


def test_a_law_that_is_unstable_at_every_gain_has_no_margin():
    def pushing(scale, rate):
        return pd(scale * KP, 0.0, rate=rate)

    weightless = Plant.build(BARE.leg, {"X1": 1e-9}, end_stops=False)
    assert gain_margins(weightless, pushing, POSE, rates=[30.0], delays=[1]).margins[0, 0] == 0.0


def test_sharp_friction_compensation_is_refused_as_it_has_no_derivative():
    plant = cuhk_plant(end_stops=False)
    sharp = gravity_friction_pd(plant, KP, KD, friction=SHARP)
    with pytest.raises(ExoidError, match=r"no derivatives at rest.*leave out friction compensation"):
        spectral_radius(plant, sharp, POSE)


def test_smooth_friction_compensation_undamps_a_leg_that_has_no_friction():
    """c0 / width beside Kd: the linear reason for the limit cycles of over-compensation."""
    plant = cuhk_plant(end_stops=False)
    compensating = gravity_friction_pd(plant, KP, KD, friction=SMOOTH)
    assert spectral_radius(plant, compensating, POSE) > 1.0
    assert spectral_radius(plant, gravity_friction_pd(plant, KP, KD, friction=None), POSE) < 1.0


@pytest.mark.parametrize("delay", [-1, 0.5])
def test_impossible_delays_are_refused(delay):
    with pytest.raises(ExoidError, match="give a whole number"):
        spectral_radius(BARE, law(1.0, 100.0), POSE, delay)


def test_the_table_and_its_json(margins):
    for word in ("rate [Hz]", "gains × (delay 1)", "300", "without Coulomb friction"):
        assert word in str(margins)
    assert margins.to_json()["margins"] == margins.margins.tolist()
