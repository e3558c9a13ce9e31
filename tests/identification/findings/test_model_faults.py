"""Faults that only a model shows: delays, signs, orders, units, zeros, lengths, springs."""

import dataclasses

import numpy as np
import pytest
from logs import clean, kinds, of_kind, with_column
from swings import late

import exoid


def test_delay_auto_finds_the_parameters_of_the_log_without_delay():
    leg, log = clean()
    right = exoid.identify(leg, log)
    bad = late(log, 0.02, range(3))
    wrong, mended = exoid.identify(leg, bad), exoid.identify(leg, bad, delay="auto")

    def worst(estimate):
        return (np.abs(estimate.values - right.values) / right.std).max()

    assert worst(wrong) > 10.0
    assert worst(mended) < 2.0
    shifts = [finding for finding in mended.findings if finding.kind == "torque-delay"]
    assert {finding.severity for finding in shifts} == {"info"}
    assert [finding.value for finding in shifts] == pytest.approx([0.02] * 3, abs=0.001)


def test_a_torque_in_another_unit_hides_no_scale_of_another_joint():
    leg, log = clean()
    both = with_column(with_column(log, "tau", 2, lambda x: 1000.0 * x), "tau", 1, lambda x: 1.2 * x)
    found = {one.joint: one.value for one in exoid.check(leg, both) if one.kind == "torque-scale"}
    assert found[leg.joint_names[2]] == pytest.approx(1000.0, rel=0.1)
    assert found[leg.joint_names[1]] == pytest.approx(1.2, abs=0.05)
    two_leg, two = clean("cuhk")
    found = exoid.check(two_leg, with_column(two, "tau", 0, lambda x: 1000.0 * x))
    assert [one.joint for one in found if one.kind == "torque-scale"] == [two_leg.joint_names[0]]


def test_a_wrong_length_is_named():
    leg, log = clean()
    offsets = leg.chain.offsets.copy()
    offsets[0] *= 1.1
    (limb,) = leg.limbs
    limb = dataclasses.replace(limb, chain=dataclasses.replace(limb.chain, offsets=offsets))
    longer = dataclasses.replace(leg, machine=dataclasses.replace(leg.machine, limbs=(limb,)))
    finding = of_kind(exoid.check(longer, log), "segment-length")
    assert finding.joint == leg.joint_names[0]
    assert finding.value == pytest.approx(1.0 / 1.1 - 1.0, abs=0.03)


def test_a_spring_is_an_unmodelled_force_unless_it_is_modelled():
    leg, log = clean()
    pulled = dataclasses.replace(log, tau=log.tau + np.array([0.0, 5.0, 0.0]) * log.q)
    assert of_kind(exoid.check(leg, pulled), "unmodelled-force").joint == leg.joint_names[1]
    terms = (*exoid.torques.DEFAULT_TERMS, exoid.Stiffness(joints=("knee",)))
    assert kinds(exoid.check(leg, pulled, terms)) == set()


def test_a_constant_torque_is_named_unless_it_is_modelled():
    """It was a strap or a spring, at two joints."""
    leg, log = clean()
    biased = with_column(log, "tau", 1, lambda x: x + 0.5)
    (finding,) = exoid.check(leg, biased, (exoid.Coulomb(smoothing=0.015), exoid.Viscous()))
    assert (finding.kind, finding.joint) == ("torque-offset", leg.joint_names[1])
    assert finding.value == pytest.approx(0.5, abs=0.02)
    assert kinds(exoid.check(leg, biased)) == set()


FORMS = {
    "quadratic": lambda v, load: v * np.abs(v) / v.std() ** 2,
    "asymmetric": lambda v, load: np.abs(v) / v.std(),
    "Stribeck": lambda v, load: np.tanh(v / 0.02) * np.exp(-((v / 0.2) ** 2)),
    "changes with time": lambda v, load: np.tanh(v / 0.02) * np.linspace(0.0, 4.0, len(v)),
    "load": lambda v, load: np.tanh(v / 0.02) * np.abs(load) / load.std(),
}


@pytest.mark.parametrize("form", FORMS)
def test_friction_of_another_form_is_named(form):
    leg, log = clean()
    v = np.gradient(log.q[:, 1]) * log.sample_rate
    extra = 0.05 * log.tau[:, 1].std() * FORMS[form](v, log.tau[:, 1])
    finding = of_kind(exoid.check(leg, with_column(log, "tau", 1, lambda x: x + extra)), "unmodelled-friction")
    assert finding.joint == leg.joint_names[1]
    assert form in finding.message
    assert "c0_knee" in finding.parameters or "d_knee" in finding.parameters


def test_torque_that_is_only_noise_is_found():
    leg, log = clean()
    noise = np.random.default_rng(0).standard_normal(len(log))
    found = exoid.check(leg, with_column(log, "tau", 1, lambda x: x.std() * noise))
    assert ("large-residual", leg.joint_names[1]) in {(finding.kind, finding.joint) for finding in found}


def acceleration(log):
    """Derivative of the angles [rad/s²]."""
    v = np.gradient(log.q, axis=0) * log.sample_rate
    return np.gradient(v, axis=0) * log.sample_rate


def test_inertia_that_no_leg_can_have_is_found():
    leg, log = clean()
    less = 0.5 * leg.parameters[2] * acceleration(log)[:, 0]  # J1 less J2 becomes negative
    finding = of_kind(exoid.check(leg, with_column(log, "tau", 0, lambda x: x - less)), "impossible-leg")
    assert finding.value > 4.5
    assert "left_thigh" in finding.message or "J1" in finding.message
    assert "J1" in finding.parameters
    little = 0.01 * less
    assert kinds(exoid.check(leg, with_column(log, "tau", 0, lambda x: x - little))) == set()


def test_a_segment_on_the_wrong_side_of_its_joint_is_found():
    leg, log = clean()
    v = np.gradient(log.q, axis=0) * log.sample_rate
    moment = leg.regressor(log.q, v, acceleration(log))[..., 3:5] @ leg.parameters[3:5]
    found = exoid.check(leg, dataclasses.replace(log, tau=log.tau - 1.4 * moment))
    assert "impossible-leg" in kinds(found)


def test_negative_rotor_inertia_is_a_warning():
    leg, log = clean()
    less = 0.5 * leg.parameters[5] * acceleration(log)[:, 1]
    estimate = exoid.identify(leg, with_column(log, "tau", 1, lambda x: x - less))
    assert ("negative-parameter", ("Ia_knee",)) in {(one.kind, one.parameters) for one in estimate.findings}


def test_a_shared_factor_of_torque_and_model_changes_no_finding():
    """A log in other units of force and the leg in the same units have the same faults."""
    leg, log = clean()
    bad = with_column(log, "q", 1, lambda x: x + 0.1)
    other = leg.with_parameters(2.0 * leg.parameters)
    one, two = exoid.check(leg, bad), exoid.check(other, dataclasses.replace(bad, tau=2.0 * bad.tau))
    assert [(f.kind, f.joint) for f in one] == [(f.kind, f.joint) for f in two]
    assert [f.value for f in one] == pytest.approx([f.value for f in two], rel=1e-3)
