"""Joints whose torque was not measured move and give no rows; passive joints give rows of a torque that is zero."""

import dataclasses
import json
from functools import cache

import numpy as np
import pytest
from hanging_knee import DAMPING, hanging_log
from swings import TERMS, Swing, late
from unchecked import identify

import exoid
from exoid import Coulomb, ExoidError, Viscous
from exoid.errors import NotIdentifiableError
from exoid.identification.group_rows import Group
from exoid.identification.problem import Problem
from exoid.torques import TorqueModel

pytestmark = pytest.mark.slow

DRIVEN = tuple(dataclasses.replace(term, joints=("hip", "knee")) for term in TERMS)


@cache
def swing(seed=1):
    """Document 1's leg, with noise of one percent in all torques."""
    swing = Swing(exoid.load_leg("bleex"), seconds=20.0, seed=seed)
    noise = 0.01 * swing.torque.std(axis=0) * np.random.default_rng(seed).standard_normal(swing.torque.shape)
    return swing, swing.recording(tau=swing.torque + noise)


def without(log, *joints):
    """The log without the torque of some joints."""
    tau = np.array(log.tau)
    tau[:, [log.joint_names.index(joint) for joint in joints]] = np.nan
    return dataclasses.replace(log, tau=tau)


@pytest.mark.parametrize("estimator", ["ols", "wls"])
def test_the_estimate_is_that_of_the_other_joints_rows_alone(estimator):
    """The ankle may as well be locked at its true motion: the rows of hip and knee are solved here by themselves."""
    swing_, log = swing()
    found = identify(swing_.leg, without(log, "left_ankle"), TERMS, estimator)
    model = TorqueModel(swing_.leg, DRIVEN)
    assert found.names == model.names
    problem = Problem((Group("", model, [log], found.preparation),))
    factors = [r_factor.R for r_factor in problem.r_factors[:2]]
    weights = np.ones(2)
    for _ in range(1 if estimator == "ols" else 2):
        R = np.vstack([weight * R for weight, R in zip(weights, factors, strict=True)])
        expected = np.linalg.lstsq(R[:, :-1], R[:, -1])[0]
        weights = [1.0 / np.linalg.norm(R @ np.append(expected, -1.0)) for R in factors]
    np.testing.assert_allclose(found.values, expected, rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize("estimator", ["wls", "huber", pytest.param("ols", marks=pytest.mark.nightly)])
def test_intervals_without_a_joints_torque_are_as_true_as_with_it(estimator):
    rms = {}
    for measured in (True, False):
        scores = []
        for seed in range(1, 13):
            swing_, log = swing(seed)
            found = identify(swing_.leg, log if measured else without(log, "left_ankle"), TERMS, estimator)
            truth = dict(zip(TorqueModel(swing_.leg, TERMS).names, swing_.truth, strict=True))
            scores += [(found.value(name) - truth[name]) / found[name].std for name in found.names]
        rms[measured] = np.sqrt(np.mean(np.square(scores)))
    assert rms[True] < 1.3
    assert rms[False] < 1.1 * rms[True]


def test_a_joint_that_one_of_two_logs_measured_is_identified():
    swing_, log = swing()
    _, other = swing(2)
    found = identify(swing_.leg, [without(log, "left_ankle"), other], TERMS)
    assert "c0_ankle" in found.names
    assert found.trained == (True, True, True)
    (finding,) = (f for f in found.findings if f.kind == "unmeasured-torque")
    assert (finding.joint, finding.value) == ("left_ankle", 0.5)


def test_an_angle_with_the_wrong_sign_is_named_without_its_torque():
    """Coupling alone shows it, and less than 2 % of the torques: it was an angle read −0.53 times, or no leg's foot."""
    swing_, log = swing(2)
    turned = dataclasses.replace(without(log, "left_ankle"), q=log.q * [1.0, 1.0, -1.0], v=None, a=None)
    (one,) = (found for found in exoid.check(swing_.leg, turned) if found.severity == "error")
    assert (one.kind, one.joint) == ("angle-sign", "left_ankle")


def test_parameters_that_leave_no_trace_elsewhere_are_named():
    swing_, log = swing()
    ankle = (Coulomb(joints=("ankle",)),)
    for joint, terms, lost in (("left_hip", TERMS, ("X1", "Y1", "J1")), ("left_ankle", ankle, ("c0_ankle",))):
        with pytest.raises(NotIdentifiableError) as caught:
            identify(swing_.leg, without(log, joint), terms)
        assert caught.value.parameters[: len(lost)] == lost
    found = identify(swing_.leg, without(log, "left_ankle"), TERMS, known={"c0_ankle": 0.4})
    assert found.value("c0_ankle") == 0.4
    for joints, estimator in ((log.joint_names, "wls"), (("left_ankle",), "ml")):
        with pytest.raises(ExoidError):
            identify(swing_.leg, without(log, *joints), TERMS, estimator)


def test_checks_skip_a_joint_without_torque_and_find_faults_of_the_others():
    swing_, log = swing()
    partial = without(log, "left_ankle")
    assert {f.kind for f in exoid.check(swing_.leg, partial)} == {"unmeasured-torque"}
    tau = np.array(partial.tau)
    tau[:, 1] *= -1.0
    found = exoid.check(swing_.leg, dataclasses.replace(partial, tau=tau))
    assert ("torque-sign", "left_knee") in {(f.kind, f.joint) for f in found}


def test_a_log_of_currents_alone_says_what_is_missing():
    swing_, log = swing()
    with pytest.raises(ExoidError, match="has motor currents and no torque") as caught:
        identify(swing_.leg, dataclasses.replace(log, tau=None, current=log.tau), TERMS)
    assert "tau_left_hip=i_left_hip:0.118" in caught.value.command


# --- passive joints ---------------------------------------------------------------------------------------------


def test_rows_of_a_passive_joint_identify_its_friction_and_sharpen_the_rest():
    leg, log = hanging_log(1, passive=True)
    found = exoid.identify(leg, log, (Viscous(),))
    truth = np.concatenate([leg.parameters, DAMPING])
    assert found.names[-1] == "d_knee"
    assert np.sqrt(np.mean(((found.values - truth) / found.std) ** 2)) < 2.0
    np.testing.assert_allclose(found.value("d_knee"), DAMPING[1], rtol=0.02)
    unmeasured = identify(*hanging_log(1, passive=False), (Viscous(),))
    assert found["J2"].std < 0.9 * unmeasured["J2"].std
    assert [f for f in found.findings if f.severity != "info"] == []
    validation = exoid.validate(found, log)
    assert validation.verdict == "predicts"
    assert "–" in str(validation)


@pytest.mark.parametrize(("stiffness", "severity"), [(0.0, []), (4.0, ["warning"]), (16.0, ["error"])])
def test_a_spring_at_a_passive_joint_is_said(stiffness, severity):
    """It shrinks what acts there, as a torque that has to be zero then is smaller, too."""
    leg, log = hanging_log(1, passive=True, stiffness=stiffness)
    found = exoid.identify(leg, log, (Viscous(),))
    said = [one for one in found.findings if one.kind == "large-residual" and one.joint == "left_knee"]
    assert [one.severity for one in said] == severity
    assert not severity or found["X2"].identifiability != "well"


def test_passive_joints_alone_give_only_ratios():
    leg, log = hanging_log(1, passive=True)
    with pytest.raises(ExoidError, match="only ratios of parameters"):
        identify(leg, dataclasses.replace(log, passive=leg.joint_names, tau=None), (Viscous(),))


# --- what else takes recordings ----------------------------------------------------------------------------------


def test_delays_of_the_other_torques_are_taken_out():
    swing_, log = swing()
    log = without(late(log, 0.02, [1]), "left_ankle")
    found = identify(swing_.leg, log, TERMS, delay="auto")
    np.testing.assert_allclose(found.torque_delays, [0.0, 0.02, 0.0], atol=1e-3)
    validation = exoid.validate(found, log)
    assert (validation.nrmse[:2] < 0.02).all()
    assert np.isnan(validation.rmse).tolist() == [False, False, True]
    json.dumps(validation.to_json(), allow_nan=False)
