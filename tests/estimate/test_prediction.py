"""A predicted motion is what the identified equations say, integrated; SciPy's solver on Pinocchio is the truth."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

import exoid
from exoid import Armature, Coulomb, Estimate, ExoidError, Recording, TorsoMotion, Viscous, Wrench
from exoid.estimate import predict_motion
from exoid.signals import FiniteDifference
from exoid.torques import TorqueModel

RATE = 100.0
TIME = np.arange(150) / RATE
FRICTION = {"c0": 0.4, "d": 0.7, "Ia": 0.05}
START = np.array([0.2, -0.3, 0.1, 0.5, -1.0, 0.2])


def known(leg, terms):
    """An estimate that is exact."""
    model = TorqueModel(leg, terms)
    extra = [FRICTION[name.split("_")[0]] for name in model.names[len(leg.parameter_names) :]]
    values = np.concatenate([leg.parameters, extra])
    for regrouped in model.regrouped:  # the rotor inertia of the hip is part of J1
        for target, share in regrouped.into.items():
            values[model.names.index(target)] += share * FRICTION[regrouped.name.split("_")[0]]
    P = len(values)
    return Estimate(model, values, 1e-12 * np.eye(P), 1.0, 1e3, np.zeros(3), "exact", FiniteDifference())


def torque(t):
    """What the actuators do, straight between samples as in a prediction."""
    wave = np.array([18.0, 9.0, 1.5]) * np.sin(2.0 * np.pi * np.outer(np.append(TIME, 1.5), [0.7, 1.1, 1.3]) + 0.4)
    return np.array([np.interp(t, np.append(TIME, 1.5), column) for column in wave.T]).T


@cache
def moved(pitch=0.0):
    """The true motion of BLEEX's left leg with friction and rotors, (150, 6)."""
    leg = exoid.load_leg("bleex")
    model = pin.Model(leg.model)
    model.armature = np.full(3, FRICTION["Ia"])
    model.gravity.linear = leg.gravity_of_tilted_torso(pitch)
    data = model.createData()

    def rate(t, x):
        q, v = x[:3], x[3:]
        loss = FRICTION["c0"] * np.tanh(v / 0.02) + FRICTION["d"] * v
        return np.concatenate([v, pin.aba(model, data, q, v, torque(t) - loss)])

    return solve_ivp(rate, (0.0, 1.49), START, t_eval=TIME, rtol=1e-9, atol=1e-10, max_step=1e-2).y.T


def log_of(leg, true, **about):
    """The recording of a true motion."""
    return Recording(time=TIME, q=true[:, :3], v=true[:, 3:], tau=torque(TIME), joint_names=leg.joint_names, **about)


@pytest.fixture(scope="module")
def exact(leg):
    return known(leg, (Coulomb(), Viscous(), Armature()))


@pytest.mark.slow
@pytest.mark.parametrize("horizon", [0.1, 0.5, 10.0])
def test_an_exact_model_predicts_the_true_motion(leg, exact, horizon):
    true = moved()
    recording = log_of(leg, true)
    predicted = predict_motion(exact, recording, horizon)
    np.testing.assert_array_equal(predicted.time, TIME)
    np.testing.assert_allclose(predicted.q, true[:, :3], atol=2e-4)
    assert np.ptp(predicted.q[:, 0]) > 0.2


@pytest.mark.slow
def test_a_tilted_torso_is_part_of_the_prediction(leg, exact):
    pitch = 0.3
    true = moved(pitch)
    recording = log_of(leg, true, torso=TorsoMotion(pitch))
    np.testing.assert_allclose(predict_motion(exact, recording, 1.0).q, true[:, :3], atol=2e-4)
    assert np.abs(predict_motion(exact, log_of(leg, true), 1.0).q - true[:, :3]).max() > 0.02


def test_a_wrong_model_parts_from_the_measurement_until_it_starts_anew(leg):
    true = moved()
    recording = log_of(leg, true)
    error = np.abs(predict_motion(known(leg, ()), recording, 0.5).q - true[:, :3]).max(axis=1)
    assert np.all(error[[0, 50, 100]] == 0.0)
    assert error[[48, 98, 148]].min() > 0.01


def test_what_cannot_be_predicted_is_refused(leg, exact):
    true = moved()
    recording = log_of(leg, true)
    with pytest.raises(ExoidError, match="no torque"):
        predict_motion(exact, Recording(time=TIME, q=true[:, :3], joint_names=leg.joint_names))
    for horizon in (0.0, -1.0, 0.005, np.nan, np.inf):
        with pytest.raises(ExoidError, match="horizon"):
            predict_motion(exact, recording, horizon)
    pushing = [-50.0 if name.startswith("d_") else value for name, value in zip(exact.names, exact.values, strict=True)]
    absurd = replace(exact, values=np.array(pushing))
    with pytest.raises(ExoidError, match="diverges"):
        predict_motion(absurd, recording, 1.5)


def test_a_leg_on_the_ground_is_not_predicted_as_one_in_the_air(leg, exact):
    true = moved()
    recording = log_of(leg, true)
    rail = Wrench(np.ones((len(TIME), 3)), np.zeros((len(TIME), 3)))
    for changes in ({"wrenches": {"torso": rail}}, {"contacts": {"left_foot": TIME > 1.0}}):
        with pytest.raises(ExoidError, match=f"the surroundings act on {next(iter(*changes.values()))}"):
            predict_motion(exact, replace(recording, **changes))
    unloaded = Wrench(np.zeros((len(TIME), 3)), np.zeros((len(TIME), 3)))
    swing = replace(recording, wrenches={"torso": unloaded}, contacts={"left_foot": TIME < 0.0})
    assert not swing.loaded_links
    assert np.array_equal(predict_motion(exact, swing).q, predict_motion(exact, recording).q)
