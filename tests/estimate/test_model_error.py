"""Bands of predicted torque where friction is not of the form of the terms, inside and beyond the training's motion."""

import dataclasses

import numpy as np
import pytest
from made_estimates import from_file
from swings import Swing, log_of

import exoid
from exoid import Armature, Coulomb, Offset, Viscous
from exoid.estimate.model_error import COUNT
from exoid.torques import Presliding

SMOOTH = (Coulomb(smoothing=0.02, reversal_speed=0.0), Viscous(), Armature(), Offset())
"""Terms without a reversal speed: friction is tanh(v / 0.02) throughout, and all rows count."""

SLOW, FAST = 0.1, 0.2
"""First harmonic of the training and of a motion at twice the speed [Hz]."""


def size_of(leg):
    """RMS torque of each joint in the slow motion [N·m], (n,)."""
    return np.sqrt((leg.inverse_dynamics(*Swing(leg, seconds=20.0, base=SLOW).motion) ** 2).mean(axis=0))


def friction(form, q, v):
    """Friction of unit size, (N, n)."""
    sign = np.tanh(v / 0.01)
    if form == "coulomb":
        return sign + 0.5 * v
    if form == "quadratic":
        return sign + 0.3 * v + 0.25 * v * np.abs(v)
    falling = 1.0 + 0.6 * np.exp(-((v / 0.3) ** 2))
    if form == "stribeck":
        return sign * falling + 0.5 * v
    states = [Presliding(8e-3).states(q[:, j], v[:, j]) for j in range(q.shape[1])]
    return np.column_stack(states) * falling + 0.5 * v


def log(leg, form, base, seed):
    """A minute of a motion with noise on angles and torques."""
    swing = Swing(leg, seconds=60.0, seed=seed, base=base)
    q, v, _ = swing.motion
    rng, size = np.random.default_rng(seed), size_of(leg)
    angles = q + rng.normal(scale=1e-4, size=q.shape)
    acting = 0.06 * size * friction(form, q, v)
    return dataclasses.replace(log_of(leg, swing.time, swing.motion, acting, 0.03 * size, rng), q=angles)


def without(estimate):
    """The same estimate without its model error: bands as they were before."""
    return dataclasses.replace(estimate, model_error=None)


def coverage(estimate, leg, form, base, seeds=(8, 9)):
    return np.array([exoid.validate(estimate, log(leg, form, base, seed)).coverage for seed in seeds])


@pytest.fixture(scope="module")
def estimates(cuhk_leg):
    forms = ("coulomb", "quadratic", "stribeck", "presliding")
    return {form: exoid.identify(cuhk_leg, log(cuhk_leg, form, SLOW, 1)) for form in forms}


OTHER_FORMS = ("stribeck", "presliding", "quadratic")
"""Forms of friction that the terms do not have."""


@pytest.mark.parametrize("form", OTHER_FORMS)
def test_at_twice_the_speed_the_band_still_contains_the_torque(cuhk_leg, form):
    """Without the model error it does not: parameters and noise know nothing of another form of friction."""
    estimate = exoid.identify(cuhk_leg, log(cuhk_leg, form, SLOW, 1), SMOOTH)
    before, now = coverage(without(estimate), cuhk_leg, form, FAST), coverage(estimate, cuhk_leg, form, FAST)
    print(f"{form}: share inside the band {before.mean(axis=0).round(3)}, with model error {now.mean(axis=0).round(3)}")
    assert before.min() < 0.85
    assert now.mean() > 0.9
    assert now.min() > before.min() + 0.05


@pytest.mark.parametrize("form", OTHER_FORMS)
def test_the_band_of_the_default_terms_contains_the_torque_at_twice_the_speed(cuhk_leg, estimates, form):
    """With the default terms presliding leaves little to the model error: reversals are taken out of the fit."""
    assert coverage(estimates[form], cuhk_leg, form, FAST).mean() > 0.9


@pytest.mark.parametrize("form", ["coulomb", "quadratic", "stribeck", "presliding"])
def test_inside_the_training_the_band_does_not_become_wider(cuhk_leg, estimates, form):
    recording = log(cuhk_leg, form, SLOW, 1)
    old, new = (exoid.validate(each, recording) for each in (without(estimates[form]), estimates[form]))
    ratio = np.sqrt((new.half_width**2).mean(axis=0) / (old.half_width**2).mean(axis=0))
    print(f"{form}: width over that before {ratio.round(3)}, share inside {new.coverage.round(3)}")
    assert (ratio < 1.03).all()
    assert (new.coverage > 0.93).all()


def band_rows(estimate, *motion):
    model = estimate.band_model
    return model.columns(model.motion(*motion)).transpose(2, 1, 0)


def test_the_model_error_grows_beyond_the_training(cuhk_leg, estimates):
    error, estimate = estimates["stribeck"].model_error, estimates["stribeck"]
    slow, fast = (Swing(cuhk_leg, seconds=20.0, base=base).motion for base in (SLOW, 2.5 * SLOW))
    inside, outside = (error.variance(band_rows(estimate, *motion)).mean(axis=0) for motion in (slow, fast))
    assert (outside > 3.0 * inside).all()
    assert (inside < 2.0 * estimate.residual_rms**2).all()


def test_alternatives_are_columns_of_each_joint_alone(cuhk_leg, estimates):
    q, v, a = Swing(cuhk_leg, seconds=5.0).motion
    estimate = estimates["coulomb"]
    rows = band_rows(estimate, q, v, a)
    count = len(estimate.values)
    np.testing.assert_array_equal(rows[..., :count], estimate.model.regressor(q, v, a))
    np.testing.assert_array_equal(rows[:, 1, count], Presliding(3e-3).states(q[:, 1], v[:, 1]))
    np.testing.assert_allclose(rows[..., count + COUNT - 2], v * np.abs(v))
    rigid = len(cuhk_leg.parameter_names)
    load = np.abs(cuhk_leg.with_parameters(estimate.values[:rigid]).inverse_dynamics(q, v, a))
    np.testing.assert_allclose(np.abs(rows[..., -1]), load * np.abs(np.tanh(v / 0.02)), rtol=1e-9, atol=1e-12)


def test_it_survives_saving_to_the_last_bit(cuhk_leg, estimates, tmp_path):
    estimate = estimates["presliding"]
    fast, loaded = log(cuhk_leg, "presliding", FAST, 8), from_file(estimate, tmp_path)
    np.testing.assert_array_equal(exoid.validate(loaded, fast).half_width, exoid.validate(estimate, fast).half_width)


def test_without_checks_there_is_none_and_bands_are_those_of_parameters_and_noise(cuhk_leg):
    estimate = exoid.identify(cuhk_leg, log(cuhk_leg, "stribeck", SLOW, 1), check=False)
    assert estimate.model_error is None
    band = estimate.torque_band(*Swing(cuhk_leg, seconds=5.0).motion)
    assert (band.upper - band.torque >= 1.96 * estimate.residual_rms).all()


def test_one_state_alone_has_a_band(estimates):
    """The direction of motion is that of the velocity where there is no motion before."""
    band = estimates["presliding"].torque_band([[0.1, 0.2]], [[0.5, 0.5]], [[0.0, 0.0]])
    assert (band.upper - band.torque < 10.0 * estimates["presliding"].residual_rms).all()
