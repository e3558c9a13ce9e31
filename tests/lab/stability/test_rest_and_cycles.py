"""Rest positions of a leg under a controller, the effect of stiction, and the difference of oscillations and rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from controlled_legs import LEG, cuhk_plant, exact_estimate, frictionless

from exoid import ExoidError, Recording
from exoid.control import (
    FrictionCompensation,
    SideBySide,
    Tracking,
    gravity_friction_pd,
    pd,
    simulate_law,
    simulate_many,
)
from exoid.experiments import Hold
from exoid.lab.stability import find_equilibrium, find_limit_cycle, regulate
from exoid.rig import Energy, Plant

KP, KD = np.array([22.1, 55.6]), np.array([2.21, 5.56])
TARGET = np.deg2rad([10.0, 40.0])
PLANT = cuhk_plant(end_stops=False)


def test_with_exact_gravity_the_leg_rests_on_the_target_within_c0_over_kp():
    found = find_equilibrium(PLANT, gravity_friction_pd(PLANT, KP, KD), TARGET)
    np.testing.assert_allclose(found.error, 0.0, atol=1e-10)
    np.testing.assert_allclose(found.stiffness, np.diag(KP), atol=1e-6)
    np.testing.assert_allclose(found.band, [1.445 / 22.1, 0.593 / 55.6], rtol=1e-6)
    for sign in (-1.0, 1.0):
        assert found.holds(TARGET + 0.999 * sign * found.band)
        assert not found.holds(TARGET + 1.001 * sign * found.band)


def test_pd_alone_sags_to_where_the_simulated_leg_comes_to_rest():
    """With much viscous friction and none of Coulomb's; the virtual rig knows nothing of equilibria."""
    plant = frictionless(cuhk_plant(0.0, end_stops=False, d_hip=12.0, d_knee=6.0))
    law = pd(KP, KD)
    found = find_equilibrium(plant, law, TARGET)
    run = simulate_law(plant, law, Hold(TARGET[:, None]), 12.0, start=TARGET)
    assert np.abs(run.v[-1]).max() < 1e-4
    np.testing.assert_allclose(run.q[-1], found.q, atol=1e-4)
    assert np.rad2deg(np.abs(found.error)).max() > 5.0
    np.testing.assert_allclose(found.imbalance(found.q), 0.0, atol=1e-9)


@pytest.mark.parametrize("start", [[0.06, 0.0], [-0.064, 0.01], [0.02, -0.009]])
def test_a_leg_released_within_the_band_stays_and_beyond_it_moves(start):
    law = gravity_friction_pd(PLANT, KP, KD, friction=FrictionCompensation(width=0.0))
    found = find_equilibrium(PLANT, law, TARGET)
    for scale in (1.0, 1.2):
        q = TARGET + scale * np.array(start) / 0.98
        run = simulate_law(PLANT, law, Hold(TARGET[:, None]), 0.5, start=q)
        assert found.holds(q) == (not run.v.any())


def test_a_law_with_wrong_gravity_rests_beside_the_target():
    """20 % of gravity missing: the error is what the rest of Kp must carry, and its band is no longer c0 / Kp."""
    estimate = exact_estimate()
    light = LEG.with_parameters(np.array(LEG.parameters) * np.array([0.8, 0.8, 1.0, 0.8, 0.8, 1.0]))
    found = find_equilibrium(PLANT, gravity_friction_pd(light, KP, KD), TARGET)
    missing = estimate.leg.gravity(found.q)[0] - light.gravity(found.q)[0] + [0.0, 0.5 * found.q[1]]
    np.testing.assert_allclose(KP * found.error, missing, atol=1e-9)
    assert np.abs(found.band / [1.445 / 22.1, 0.593 / 55.6] - 1.0).max() > 0.1


def test_springs_that_pull_away_leave_no_stable_rest():
    upside_down = np.array([np.pi, 0.0])
    with pytest.raises(ExoidError, match=r"unstable: gravity exceeds the stiffness Kp.*compensate gravity"):
        find_equilibrium(PLANT, pd(1.0, 0.1), upside_down)


def test_a_target_of_the_wrong_shape_is_refused():
    with pytest.raises(ExoidError, match="give 2 angles in rad"):
        find_equilibrium(PLANT, pd(KP, KD), [0.1, 0.2, 0.3])


def made_up(error_deg, rate=100.0) -> Tracking:
    """A run whose errors are given, (N, 2)."""
    error = np.deg2rad(np.column_stack(error_deg))
    time = np.arange(len(error)) / rate
    still = np.zeros_like(error)
    recording = Recording(time=time, q=still, tau=still, joint_names=("hip", "knee"))
    zero = np.zeros(())
    return Tracking(
        "made up", rate, ("hip", "knee"), time, error, still, still, still, recording, Energy(zero, zero, zero, zero)
    )


TIME = np.arange(2000) / 100.0


def test_a_steady_oscillation_is_a_limit_cycle_with_its_amplitude_and_period():
    found = find_limit_cycle(made_up([3.0 + 4.0 * np.sin(2 * np.pi * TIME / 1.25), 0.0 * TIME]))
    assert found.exists
    assert found.lasting.tolist() == [True, False]
    assert found.peak_to_peak_deg == pytest.approx([8.0, 0.0], abs=1e-3)
    assert found.period[0] == pytest.approx(1.25, rel=0.02)
    assert np.isnan(found.period[1])


def test_a_dying_oscillation_and_rest_are_none():
    assert not find_limit_cycle(made_up([8.0 * np.exp(-0.3 * TIME) * np.sin(5.0 * TIME), 2.0 + 0.0 * TIME])).exists
    assert not find_limit_cycle(made_up([0.01 * np.sin(5.0 * TIME), 0.0 * TIME])).exists  # less than 0.05° in all


@pytest.mark.parametrize(("last", "words"), [(0.0, "between 0 and 1"), (1.5, "between 0 and 1"), (1e-3, "log more")])
def test_a_part_that_shows_nothing_is_refused(last, words):
    with pytest.raises(ExoidError, match=words):
        find_limit_cycle(made_up([TIME, TIME]), last)


def test_a_leg_that_is_not_planar_is_regulated_one_run_after_the_other(monkeypatch):
    """Forced here for a planar one, whose runs must be the same."""
    together = regulate(PLANT, KP, KD, TARGET, [0.1, -0.1], shares=(1.0,), duration=0.3)
    numeric = Plant(**{name: getattr(PLANT, name) for name in PLANT.__dataclass_fields__})
    object.__setattr__(numeric, "leg", replace(LEG, machine=None))
    monkeypatch.setattr(type(LEG), "regressor", None)
    apart = regulate(numeric, KP, KD, TARGET, [0.1, -0.1], shares=(1.0,), duration=0.3)
    for one, other in zip(together.runs, apart.runs, strict=True):
        np.testing.assert_allclose(one.run.q, other.run.q, atol=1e-9)


# --------------------------------------------------------------------------------- regulation to a constant target

AWAY = np.deg2rad([25.0, -30.0])


@pytest.fixture(scope="module")
def regulations():
    """Regulation from (25°, −30°) off the target at 100 Hz."""
    return regulate(cuhk_plant(end_stops=False), KP, KD, TARGET, AWAY, duration=15.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("share", "outcome", "swing"),
    [
        *((share, "stops", 0.0) for share in ("× 0", "× 0.5", "× 0.8", "× 1")),
        *(("× 1.2", "limit cycle", 5.0), ("× 1.5", "limit cycle", 15.0)),
    ],
)
def test_compensated_exactly_or_less_the_leg_stops_within_the_band_and_compensated_too_much_never(
    regulations, share, outcome, swing
):
    """Stable, but not asymptotically; more than 5° peak to peak with too much."""
    run, band = regulations[share], np.rad2deg([1.445, 0.593] / KP)
    assert run.outcome == outcome
    assert run.cycle.exists == (outcome != "stops")
    np.testing.assert_allclose(np.rad2deg(run.equilibrium.band), band, rtol=1e-6)
    if outcome == "stops":
        assert (np.abs(run.final_error_deg) <= band).all()
        assert np.abs(run.final_error_deg).max() > 0.1, "not on the target: stable, but not asymptotically"
    else:
        assert run.cycle.lasting[0]
        assert run.cycle.peak_to_peak_deg[0] > swing


@pytest.mark.slow
def test_without_friction_the_leg_nears_the_target(regulations):
    run = regulations["no friction"]
    assert run.outcome == "still settling"
    assert np.abs(run.final_error_deg).max() < 1.0
    assert not run.equilibrium.band.any()


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
    for word in ("× 1.2", "limit cycle", "stops", "100 Hz", "no friction"):
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
