"""Parameters that a motion hardly tells apart are named, and never called well determined."""

import dataclasses

import numpy as np
import pytest
from swings import TERMS, Swing, harmonics, log_of
from unchecked import identify

import exoid
from exoid import Stiffness
from exoid.identification.group_rows import Group
from exoid.identification.problem import Problem
from exoid.regression.diagnostics import HOPELESS, ILL_CONDITIONED, Collinearity, identifiability_class, reference_scale
from exoid.regression.least_squares import factorize, solve
from exoid.signals import FiniteDifference
from exoid.torques import Stribeck, TorqueModel

EXACT = FiniteDifference()


def of_columns(W):
    noise = np.random.default_rng(1).standard_normal(len(W))
    factor = factorize(np.column_stack([W, noise]), len(W), float(len(W)))
    return Collinearity.of(solve(factor, [f"p{k}" for k in range(W.shape[1])]))


def test_two_columns_that_are_nearly_one_are_found_and_a_third_is_not_blamed():
    """Of columns u and u + εw the condition index is 2/ε, w being of unit length and orthogonal to u."""
    Q, _ = np.linalg.qr(np.random.default_rng(0).standard_normal((50, 3)))
    W = np.column_stack([Q[:, 0], Q[:, 2], Q[:, 0] + 0.01 * Q[:, 1]])
    found = of_columns(W)
    np.testing.assert_allclose(found.indices[[0, 2]], 200.0, rtol=1e-3)
    assert found.indices[1] < 2.0
    ((index, columns),) = found.directions
    assert sorted(columns) == [0, 2]
    assert index == pytest.approx(200.0, rel=1e-3)
    (remark,) = found.warnings(("X1", "Y1", "J1"))
    assert "X1" in remark
    assert "J1" in remark
    assert "Y1" not in remark


def test_proportions_are_those_of_the_variances():
    """Directions of a lower index make up at most half of a variance, those up to it at least half."""
    rng = np.random.default_rng(1)
    W = rng.standard_normal((80, 6))
    W[:, 4] = W[:, 1] + 0.003 * W[:, 4]
    W[:, 5] = W[:, 0] + W[:, 2] + 0.02 * W[:, 5]
    unit = W / np.linalg.norm(W, axis=0)
    _, sigma, Vt = np.linalg.svd(unit, full_matrices=False)
    whole = np.diag(np.linalg.inv(unit.T @ unit))
    for column, index in enumerate(of_columns(W).indices):
        share = [
            (Vt[kept, column] ** 2 / sigma[kept] ** 2).sum() / whole[column]
            for kept in (sigma[0] / sigma < index * (1 - 1e-9), sigma[0] / sigma <= index * (1 + 1e-9))
        ]
        assert share[0] <= 0.5 <= share[1]


@pytest.mark.parametrize(("index", "expected"), [(99.0, "well"), (101.0, "weakly"), (301.0, "not")])
def test_what_moves_together_is_at_best_weakly_determined(index, expected):
    assert identifiability_class(1.0, 1e-6, 1.0, 1.0, index) == expected
    assert identifiability_class(1.0, 0.5, 1.0, 1.0, index) == "not"


def slow(leg, seed=0):
    """One sine of 0.05 Hz at each joint: accelerations are the angles again, and so nearly is gravity."""
    time = np.arange(6000) / 100.0
    q, v, a = harmonics(time, 0.2, 2.0 * np.pi * 0.05, np.array([[0.3], [1.1]]))
    return log_of(leg, time, (q, v, a), 0.5 * np.tanh(v / 0.02) + 0.1 * v, 1e-3, seed, exact=True)


def test_a_slow_motion_does_not_make_an_inertia_sure_however_small_its_error():
    leg = exoid.load_leg("cuhk")
    estimate = identify(leg, slow(leg), TERMS, preparation=EXACT)
    assert estimate.condition_number > ILL_CONDITIONED
    assert {estimate[name].identifiability for name in ("J1", "J2", "X1")} <= {"weakly", "not"}
    (warning,) = [text for text in estimate.warnings if "hardly tell apart" in text]
    assert "J1" in warning
    assert "X1" in warning
    assert "hardly tell apart" in " ".join(str(estimate).split())
    evidence = dataclasses.replace(estimate.evidence, collinearity=None, reference_scale=None)
    blind = dataclasses.replace(estimate, evidence=evidence)
    assert blind["J1"].identifiability == "well"  # without these rules it would be called so


def test_a_stiffness_that_an_upright_leg_shows_only_as_gravity_is_not_determined(leg):
    swing = Swing(leg)
    terms = (*TERMS, Stiffness(joints=("hip",)))
    recording = swing.with_noise(np.random.default_rng(0), 1e-3)
    estimate = identify(leg, recording, terms, preparation=EXACT)
    assert estimate.condition_number > HOPELESS
    hip = {estimate[name].identifiability for name in ("b0_hip", "b1_hip", "b2_hip", "X1", "Y1")}
    assert hip <= {"weakly", "not"}
    assert "not" in hip
    assert estimate["J3"].identifiability == estimate["X3"].identifiability == "well"
    known = identify(leg, recording, terms, preparation=EXACT, known={"b1_hip": 0.0, "b2_hip": 0.0})
    assert set(known.identifiability) == {"well", "known"}


def test_sizes_of_a_calm_exercise_are_smaller_where_a_recording_hardly_excites(leg):
    """‖τ‖ / (largest |W_i| / √3) over states of up to 1 rad/s and π rad/s²: exact for friction, inertia and offset."""
    swing = Swing(leg, base=0.02)
    model = TorqueModel(leg, (*TERMS, exoid.Offset(), Stribeck(velocity=0.05)))
    problem = Problem((Group("", model, [swing.recording()], EXACT),))
    angles = swing.motion[0].min(axis=0), swing.motion[0].max(axis=0)
    sizes = dict(zip(model.names, reference_scale(model, *angles, problem.r_factors), strict=True))
    rms = np.sqrt(np.mean(swing.torque[1:-1] ** 2, axis=0))
    assert sizes["offset_hip"] == pytest.approx(np.sqrt(3.0) * rms[0])
    assert sizes["c0_knee"] == pytest.approx(np.sqrt(3.0) * rms[1])
    assert sizes["d_ankle"] == pytest.approx(np.sqrt(3.0) * rms[2], rel=0.01)
    peak = np.max(np.exp(-((np.linspace(0, 1, 9999) / 0.05) ** 2)) * np.tanh(np.linspace(0, 1, 9999) / 0.015))
    assert sizes["cs_hip"] == pytest.approx(np.sqrt(3.0) * rms[0] / peak, rel=0.05)
    estimate = identify(leg, swing.with_noise(np.random.default_rng(0), 0.3), TERMS, preparation=EXACT)
    inertia = estimate.names.index("J1")
    assert estimate.reference_scale[inertia] < 0.1 * estimate.parameter_scale[inertia]


def test_friction_of_slow_motion_that_few_samples_show_is_not_called_well():
    """Beside 20 N·m anything below 10 N·m would be little, were it judged by its root mean square."""
    swing = Swing(exoid.load_leg("bleex"), seconds=10.0)
    terms = (*TERMS, Stribeck(velocity=0.01))
    estimate = identify(swing.leg, swing.with_noise(np.random.default_rng(0), 3.0), terms, preparation=EXACT)
    hip = estimate.names.index("cs_hip")
    assert estimate.std[hip] > np.abs(estimate.values[hip])
    assert estimate.identifiability[hip] != "well"
    blind = dataclasses.replace(estimate, evidence=dataclasses.replace(estimate.evidence, reference_scale=None))
    assert blind.identifiability[hip] == "well"
