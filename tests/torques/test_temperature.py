"""Friction that depends on temperature, in every part of exoid that meets it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from swings import Swing

import exoid
from exoid import Coulomb, Viscous
from exoid.codegen.forms import c_form
from exoid.estimate import predict_motion
from exoid.torques import TemperatureFriction, TorqueModel

LEG = exoid.load_leg("cuhk")
SWING = Swing(LEG, rate=50.0, seconds=40.0)
TERMS = (Coulomb(), Viscous(), TemperatureFriction())
Q, V, A = SWING.motion
TEMPERATURE = (25.0 + 20.0 * (SWING.time - SWING.time[0]) / 40.0)[:, None] + np.zeros(2)
C0T, DT = -0.3 * SWING.coulomb / 20.0, -0.3 * SWING.viscous / 20.0
TORQUE = SWING.torque + (C0T * np.tanh(V / 0.02) + DT * V) * (TEMPERATURE - 25.0)
TRUTH = np.concatenate([SWING.truth, np.column_stack([C0T, DT]).ravel()])
"""Friction falls by 30 % while the joints warm up by 20 K."""


def recording(seed=0, std=0.02, **changes):
    tau = TORQUE + np.random.default_rng(seed).normal(scale=std, size=TORQUE.shape)
    return SWING.recording(**{"tau": tau, "temperature": TEMPERATURE, **changes})


@pytest.fixture(scope="module")
def estimate():
    return exoid.identify(LEG, recording(), TERMS)


def test_truth_is_recovered_and_a_model_without_it_is_worse(estimate):
    assert estimate.names[-4:] == ("c0T_hip", "dT_hip", "c0T_knee", "dT_knee")
    assert np.abs((estimate.values - TRUTH) / estimate.std).max() < 4.0
    assert np.abs(estimate.values[-4:] / TRUTH[-4:] - 1.0).max() < 0.25
    cold = exoid.identify(LEG, recording(), (Coulomb(), Viscous()), check=False)
    assert (cold.residual_rms > 1.3 * estimate.residual_rms).all()


def test_intervals_cover_the_truth():
    inside = []
    for seed in range(8):
        found = exoid.identify(LEG, recording(seed), TERMS, check=False)
        lower, upper = found.interval().T
        inside.append((lower <= TRUTH) & (upper >= TRUTH))
    assert 0.85 <= np.mean(inside) <= 1.0


def test_the_reference_changes_c0_and_d_and_not_the_torque(estimate):
    other = exoid.identify(LEG, recording(), (*TERMS[:2], TemperatureFriction(reference=40.0)), check=False)
    shift = 15.0 * estimate.value("c0T_hip")
    assert other.value("c0_hip") == pytest.approx(estimate.value("c0_hip") + shift, rel=1e-6)
    torques = [each.torque(Q, V, A, temperature=TEMPERATURE) for each in (estimate, other)]
    np.testing.assert_allclose(*torques, atol=1e-7)


def test_it_predicts_validates_and_is_saved(estimate, tmp_path):
    test = recording(seed=5)
    validation = exoid.validate(estimate, test)
    assert str(validation).rstrip().endswith("verdict: predicts")
    estimate.save(tmp_path / "estimate.json")
    again = exoid.Estimate.load(tmp_path / "estimate.json")
    torque = again.torque(Q, V, A, temperature=TEMPERATURE)
    np.testing.assert_array_equal(torque, estimate.torque(Q, V, A, temperature=TEMPERATURE))
    np.testing.assert_allclose(torque, TORQUE, atol=0.05)
    band = estimate.torque_band(Q, V, A, temperature=TEMPERATURE)
    assert np.mean((band.lower < TORQUE) & (band.upper > TORQUE)) > 0.95


def test_the_predicted_motion_has_the_friction_of_its_temperature(estimate):
    """At the wrong temperature, the motion under the measured torques is another one."""
    test = recording(std=0.0).slice(1500, 2000)
    cold = dataclasses.replace(test, temperature=np.full((500, 2), 25.0))
    right, wrong = (np.abs(predict_motion(estimate, log, 0.5).q - test.q).max() for log in (test, cold))
    assert right < 0.5 * wrong


def test_a_constant_temperature_is_refused_and_one_that_hardly_changes_is_not_determined():
    for constant, why in ((25.0, "left no trace"), (40.0, "cannot be told apart")):
        with pytest.raises(exoid.ExoidError, match=why) as refused:
            exoid.identify(LEG, recording(temperature=np.full_like(TEMPERATURE, constant)), TERMS)
        assert "c0T_hip" in str(refused.value)
    jitter = 40.0 + 0.05 * np.random.default_rng(1).normal(size=TEMPERATURE.shape)
    found = exoid.identify(LEG, recording(temperature=jitter), TERMS)
    assert {found[name].identifiability for name in ("c0T_hip", "c0T_knee", "c0_hip")} == {"not"}


def test_a_missing_temperature_is_refused_by_joint_and_column(estimate):
    of_hip = TEMPERATURE * [1.0, np.nan]
    for given in (None, of_hip):
        for call in (lambda log: exoid.identify(LEG, log, TERMS), lambda log: exoid.validate(estimate, log)):
            with pytest.raises(exoid.ExoidError, match="needs the temperature of") as refused:
                call(recording(temperature=given))
    assert "temp_" in str(refused.value)
    with pytest.raises(exoid.ExoidError, match="needs the temperature of"):
        estimate.torque(Q, V, A)
    with pytest.raises(exoid.ExoidError, match="shape"):
        estimate.torque(Q, V, A, temperature=TEMPERATURE[:, 0])
    with pytest.raises(exoid.ExoidError, match="no array of numbers"):
        estimate.torque(Q, V, A, temperature="warm")
    hip_only = (*TERMS[:2], TemperatureFriction(joints=("hip",)))
    assert "c0T_hip" in exoid.identify(LEG, recording(temperature=of_hip), hip_only, check=False).names


def test_poses_need_no_temperature():
    poses = np.random.default_rng(2).uniform(-0.5, 0.5, (20, 2))
    held = exoid.signals.Poses(
        poses, LEG.inverse_dynamics(poses, 0.0 * poses, 0.0 * poses), joint_names=LEG.joint_names
    )
    found = exoid.identify(LEG, [recording(), held], TERMS, check=False)
    assert np.abs((found.values - TRUTH) / found.std).max() < 4.5


def test_what_has_no_temperature_refuses_it_by_name(estimate, tmp_path):
    with pytest.raises(exoid.ExoidError, match=r"TemperatureFriction .*temperature"):
        exoid.control.ControlModel.of(estimate)
    estimate.to_urdf(tmp_path / "leg.urdf")
    with pytest.raises(exoid.ExoidError, match="c0T_hip of the term temperature-friction"):
        exoid.rig.Plant.from_urdf(tmp_path / "leg.urdf")
    with pytest.raises(exoid.ExoidError, match="depends on temperature"):
        c_form(TemperatureFriction())
    with pytest.raises(exoid.ExoidError, match="depends on load or temperature"):
        exoid.identify(LEG, recording(), TERMS, estimator="ml")
    with pytest.raises(exoid.ExoidError, match="needs the temperature of"):
        TorqueModel(LEG, TERMS).regressor(Q, V, A)
