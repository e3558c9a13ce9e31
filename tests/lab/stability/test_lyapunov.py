"""Document 2's Lyapunov function: eqs. (29) to (32) along exact solutions, and along what a sampled law really does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
import scipy
from controlled_legs import cuhk_plant

from exoid import ExoidError
from exoid.control import FrictionCompensation, SideBySide, pd, simulate_law, simulate_many
from exoid.control.laws import gravity_friction_pd
from exoid.experiments import Hold
from exoid.experiments.cuhk import validation_motion
from exoid.lab.stability import find_limit_cycle, lyapunov, regulate

KP, KD = np.array([22.1, 55.6]), np.array([2.21, 5.56])
TARGET, AWAY = np.deg2rad([10.0, 40.0]), np.deg2rad([25.0, -30.0])
BARE = {"c0_hip": 0.0, "d_hip": 0.0, "c0_knee": 0.0, "d_knee": 0.0, "b1_knee": 0.0}


@pytest.fixture(scope="module")
def bare():
    """The plant without friction or springs."""
    return cuhk_plant(end_stops=False, **BARE)


def test_v_is_kinetic_energy_plus_that_of_a_spring_to_the_target(bare):
    """Kinetic energy by Pinocchio, rotors added."""
    run = simulate_law(
        bare, gravity_friction_pd(bare, KP, KD, friction=None), Hold(TARGET[:, None]), 1.0, start=TARGET + AWAY
    )
    model, data = bare.leg.model, bare.leg.model.createData()
    kinetic = [pin.computeKineticEnergy(model, data, q, v) for q, v in zip(run.q, run.v, strict=True)]
    expected = np.array(kinetic) + 0.5 * 0.8 * (run.v**2).sum(axis=1) + 0.5 * ((TARGET - run.q) ** 2 @ KP)
    found = lyapunov(run, bare, KP, KD)
    np.testing.assert_allclose(found.value, expected, rtol=1e-12)
    assert found.value[0] == pytest.approx(9.725, abs=5e-4)


def test_the_law_of_the_document_in_continuous_time_never_raises_v(bare):
    """The theorem itself, by an integrator and accelerations that are not exoid's: V falls at −θ̇ᵀ Kd θ̇ throughout."""
    model = bare.leg.model.copy()
    model.armature[:] += 0.8
    data = model.createData()

    def motion(_, x):
        q, v = x[:2], x[2:]
        tau = KP * (TARGET - q) - KD * v + pin.computeGeneralizedGravity(model, data, q)
        return np.concatenate([v, pin.aba(model, data, q, v, tau)])

    start = np.concatenate([TARGET + AWAY, np.zeros(2)])
    time = np.linspace(0.0, 20.0, 20_001)
    done = scipy.integrate.solve_ivp(motion, (0.0, 20.0), start, "DOP853", time, rtol=1e-12, atol=1e-13)
    q, v = done.y[:2].T, done.y[2:].T
    M = bare.leg.mass_matrix(q) + 0.8 * np.eye(2)
    V = 0.5 * np.einsum("ki,kij,kj->k", v, M, v) + 0.5 * ((TARGET - q) ** 2 @ KP)
    assert np.diff(V).max() <= 1e-9 * V[0]
    assert V[-1] < 1e-3 * V[0]
    fall = scipy.integrate.cumulative_simpson((v**2) @ KD, x=time, initial=0.0)
    np.testing.assert_allclose(V, V[0] - fall, atol=1e-8 * V[0])


def test_a_sampled_law_raises_v_where_the_leg_turns_and_the_rise_vanishes_as_the_cube_of_the_period(bare):
    """A held torque lags: V rises by about Kd v̇² T³ / 6 after a joint turns. At 2000 Hz that is below 1e-9 of V₀."""
    rise = {}
    for rate in (50.0, 100.0, 2000.0):
        law = gravity_friction_pd(bare, KP, KD, friction=None, rate=rate)
        run = simulate_law(bare, law, Hold(TARGET[:, None]), 2.0, start=TARGET + AWAY, log_rate=rate)
        rise[rate] = lyapunov(run, bare, KP, KD).largest_increase
    assert rise[2000.0] <= 1e-9
    assert 1e-7 < rise[100.0] < 1e-5
    assert 4.0 < rise[50.0] / rise[100.0] < 16.0


def test_the_rate_is_the_derivative_of_v_whatever_the_law(bare):
    """Under PD alone, with friction and springs, along a motion: between two samples of the law V̇ integrates to V."""
    plant = cuhk_plant(end_stops=False, c0_hip=0.0, c0_knee=0.0)
    run = simulate_law(plant, pd(KP, KD, rate=50.0), validation_motion(), 1.0, log_rate=2000.0)
    found = lyapunov(run, plant, KP, KD)
    steps = np.arange(40 * 10 + 2, 40 * 11)  # inside one period of the law
    slope = np.gradient(found.value, found.time)
    np.testing.assert_allclose(found.rate[steps[1:-1]], slope[steps[1:-1]], rtol=1e-3, atol=1e-3)


def test_friction_takes_from_v_what_eq_32_leaves_out():
    """Not compensated, its power is what V̇ is below −θ̇ᵀ Kd θ̇; at 2000 Hz the torque hardly lags."""
    plant = cuhk_plant(end_stops=False)
    law = gravity_friction_pd(plant, KP, KD, friction=None, rate=2000.0)
    run = simulate_law(plant, law, Hold(TARGET[:, None]), 0.5, start=TARGET + AWAY)
    found = lyapunov(run, plant, KP, KD)
    moving = (np.abs(run.v) > 0.05).all(axis=1)
    assert moving.sum() > 200
    friction = np.abs(run.v) @ plant.coulomb[:, 0] + run.v**2 @ plant.viscous[:, 0]
    np.testing.assert_allclose((found.ideal_rate - found.rate)[moving], friction[moving], rtol=0.1)


def test_sampling_keeps_the_moments_of_the_law(bare):
    law = gravity_friction_pd(bare, KP, KD, friction=None, rate=50.0)
    run = simulate_law(bare, law, Hold(TARGET[:, None]), 0.5, start=TARGET + AWAY, log_rate=500.0)
    found = lyapunov(run, bare, KP, KD)
    np.testing.assert_allclose(found.sampled().time, np.arange(26) / 50.0, atol=1e-12)
    odd = simulate_law(bare, law, Hold(TARGET[:, None]), 1.0, start=TARGET + AWAY, log_rate=40.0)
    with pytest.raises(ExoidError, match="does not have the samples of a controller at 50 Hz"):
        lyapunov(odd, bare, KP, KD).sampled()


def test_a_tilted_torso_is_refused(bare):
    run = simulate_law(bare, pd(KP, KD), Hold(TARGET[:, None]), 0.2)
    tilted = cuhk_plant(end_stops=False)
    object.__setattr__(tilted, "pitch", np.array([0.1]))
    with pytest.raises(ExoidError, match="torso of the plant is tilted"):
        lyapunov(run, tilted, KP, KD)


@pytest.fixture(scope="module")
def regulations():
    """Regulation from (25°, −30°) off the target at 100 Hz."""
    return regulate(cuhk_plant(end_stops=False), KP, KD, TARGET, AWAY, duration=15.0)


@pytest.mark.slow
@pytest.mark.parametrize("share", ["× 0", "× 0.5", "× 0.8", "× 1"])
def test_compensated_exactly_or_less_v_never_increases_and_the_leg_stops_within_the_band(regulations, share):
    """At every sample of a law at 100 Hz. What rises at all under exact compensation is the error of the rig's step."""
    run = regulations[share]
    assert run.lyapunov.sampled().never_increases(1e-9)
    assert run.stopped
    assert run.outcome == "stops"
    band = np.rad2deg([1.445, 0.593] / KP)
    np.testing.assert_allclose(np.rad2deg(run.equilibrium.band), band, rtol=1e-6)
    assert (np.abs(run.final_error_deg) <= band).all()
    assert np.abs(run.final_error_deg).max() > 0.1, "not on the target: stable, but not asymptotically"
    assert not run.cycle.exists


@pytest.mark.slow
@pytest.mark.parametrize(("share", "swing"), [("× 1.2", 5.0), ("× 1.5", 15.0)])
def test_compensated_too_much_the_leg_never_stops(regulations, share, swing):
    """More than 5° peak to peak, and V rises again and again: the claim of stability needs exact friction."""
    run = regulations[share]
    assert run.outcome == "limit cycle"
    assert run.cycle.lasting[0]
    assert run.cycle.peak_to_peak_deg[0] > swing
    assert run.lyapunov.share_increasing > 0.2
    assert not run.lyapunov.never_increases(1e-6)


@pytest.mark.slow
def test_without_friction_v_falls_and_the_leg_nears_the_target(regulations):
    """At 100 Hz V trembles by millionths, as the torque is held; see the cube of the period above."""
    run = regulations["no friction"]
    assert run.lyapunov.largest_increase < 1e-5
    assert run.lyapunov.value[-1] < 1e-3 * run.lyapunov.value[0]
    assert not run.cycle.exists
    assert run.outcome == "still settling"


@pytest.mark.slow
def test_turning_round_is_not_stopping(regulations):
    """Cut off at the very moment at which stiction holds a cycling leg, it has not stopped."""
    cycling = regulations["× 1.2"]
    still = np.flatnonzero((cycling.run.v == 0.0).all(axis=1))
    moment = int(still[still > 0.8 * len(cycling.run.time)][0])
    arrays = {name: getattr(cycling.run, name)[: moment + 1] for name in ("time", "target", "q", "v", "tau")}
    cut = replace(cycling, run=replace(cycling.run, **arrays))
    assert not cut.run.v[-1].any()
    assert not cut.stopped
    assert cut.outcome == "limit cycle"


@pytest.mark.slow
def test_the_table_names_every_run(regulations):
    text = str(regulations)
    for word in ("× 1.2", "limit cycle", "stops", "V₀ = 9.725 J", "100 Hz", "no friction"):
        assert word in text
    with pytest.raises(ExoidError, match="no run '× 9'"):
        regulations["× 9"]


@pytest.mark.slow
def test_a_smooth_sign_ends_the_cycle_only_where_it_is_smooth_enough():
    """Over 0.05 rad/s at 1.2 times the friction but not at 1.5 times; over 0.2 rad/s at both."""
    plant = cuhk_plant(end_stops=False)
    sizes = {(0.05, 1.2): False, (0.05, 1.5): True, (0.2, 1.5): False}
    laws = tuple(
        gravity_friction_pd(plant, KP, KD, friction=FrictionCompensation(width=width, scale=scale))
        for width, scale in sizes
    )
    start = (TARGET + AWAY)[:, None]
    runs = simulate_many(plant.repeat(len(laws)), SideBySide(laws), Hold(TARGET[:, None]), 15.0, start=start)
    for run, cycles in zip(runs, sizes.values(), strict=True):
        found = find_limit_cycle(run, 0.25)
        assert found.exists == cycles
        assert (found.peak_to_peak_deg[0] > 10.0) == cycles
