"""What is known beside the recordings: parameters held fixed, priors, and signs."""

import numpy as np
import pytest
from swings import TERMS, coloured, holds, log_of
from unchecked import identify

import exoid
from exoid import Armature, Coulomb, ExoidError, Offset, Viscous
from exoid.errors import BadArgumentError
from exoid.regression import Prior
from exoid.signals import FiniteDifference, ZeroPhase
from exoid.torques import LoadFriction, TorqueModel

PLAIN = FiniteDifference()
NOISE = np.array([1.0, 0.7, 0.3])


def still_ankle(swing, seed=0):
    """The ankle is held at 0.2 rad; torques with white noise."""
    q, v, a = (x * [1.0, 1.0, 0.0] for x in swing.motion)
    motion = q + np.array([0.0, 0.0, 0.2]), v, a
    return log_of(swing.leg, swing.time, motion, swing.friction(v), 0.3, seed, exact=True)


@pytest.mark.parametrize("estimator", ["ols", "wls", "huber"])
def test_known_parameters_are_those_of_a_problem_without_their_columns(swing, estimator):
    """As if their torque had been subtracted and their column never been there."""
    recording = swing.with_noise(np.random.default_rng(0), NOISE)
    offset = identify(swing.leg, recording, TERMS, estimator, preparation=PLAIN)
    known = dict.fromkeys(("offset_hip", "offset_knee", "offset_ankle"), 0.0)
    fixed = identify(swing.leg, recording, (*TERMS, Offset()), estimator, preparation=PLAIN, known=known)
    np.testing.assert_allclose(fixed.values[: len(offset.values)], offset.values, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(fixed.std[: len(offset.values)], offset.std, rtol=1e-6)
    assert fixed.dof == pytest.approx(offset.dof, rel=1e-6)
    assert (fixed.std[-3:] == 0.0).all()
    assert fixed.identifiability[-3:] == ("known",) * 3
    assert "known: offset_hip = 0, offset_knee = 0" in str(fixed)


def test_what_the_data_cannot_determine_may_be_known(swing):
    """A joint that stands still is refused unless all that only its motion shows is known."""
    recording = still_ankle(swing)
    with pytest.raises(ExoidError, match="stands still"):
        identify(swing.leg, recording, TERMS, preparation=PLAIN)
    with pytest.raises(ExoidError, match="stands still"):
        identify(swing.leg, recording, TERMS, preparation=PLAIN, known={"J3": 0.1})
    truth = dict(zip((*swing.leg.parameter_names,), swing.leg.parameters, strict=True))
    known = {name: truth[name] for name in ("X3", "Y3", "J3")} | {"c0_ankle": 0.4, "d_ankle": 0.2}
    estimate = identify(swing.leg, recording, TERMS, preparation=PLAIN, known=known)
    z = (estimate.values - swing.truth)[estimate.std > 0.0] / estimate.std[estimate.std > 0.0]
    assert np.abs(z).max() < 4.5
    prior = Prior({name: (value, 0.1 * abs(value) + 0.01) for name, value in known.items()})
    believed = identify(swing.leg, recording, TERMS, preparation=PLAIN, prior=prior)
    assert believed["c0_ankle"].identifiability == believed["d_ankle"].identifiability == "prior"
    assert believed["d_ankle"].std == pytest.approx(prior.values["d_ankle"][1], rel=1e-3)
    assert "prior: X3 = " in str(believed)


@pytest.mark.parametrize("preparation", [PLAIN, ZeroPhase()], ids=lambda p: p.name)
def test_a_prior_and_the_data_are_weighed_by_their_errors(swing, preparation):
    """As two independent measurements: also behind a filter, whose rows are redundant."""
    recording = swing.with_noise(np.random.default_rng(1), NOISE)
    alone = identify(swing.leg, recording, TERMS, preparation=preparation, noise="white")
    k = alone.names.index("J3")
    std = float(alone.std[k])
    prior = {"J3": (float(alone.values[k]) + std, std)}
    both = identify(swing.leg, recording, TERMS, preparation=preparation, noise="white", prior=prior)
    assert both.std[k] == pytest.approx(std / np.sqrt(2.0), rel=1e-3)
    assert both.values[k] == pytest.approx(alone.values[k] + 0.5 * std, abs=0.01 * std)
    others = alone.values + alone.covariance[:, k] / std**2 * 0.5 * std  # they follow as they are correlated
    np.testing.assert_allclose(both.values, others, atol=1e-3 * np.abs(alone.std).max())


@pytest.mark.slow
def test_intervals_with_a_prior_hold(swing):
    """95 % of them contain the truth where the prior is as far off as it says, under correlated noise too."""
    rng, inside = np.random.default_rng(5), []
    k = [0, 2, 5, 8]
    for _ in range(40):
        recording = swing.recording(tau=swing.torque + NOISE * coloured(rng, swing.torque.shape, 0.8))
        believed = {f"J{i}": (rng.normal(swing.truth[3 * i - 1], 0.02), 0.02) for i in (1, 2, 3)}
        estimate = identify(swing.leg, recording, TERMS, preparation=PLAIN, prior=believed)
        inside.append(holds(estimate, swing.truth)[k])
    coverage = np.mean(inside)
    print(f"coverage with a prior: {coverage:.3f}")
    assert 0.89 <= coverage <= 0.99


def test_a_prior_from_a_leg_spares_values_near_zero(swing):
    prior = Prior.from_leg(swing.leg, 0.2)
    assert set(prior.values) == set(swing.leg.parameter_names)
    value, std = prior.values["X1"]
    assert std == pytest.approx(0.2 * value)
    moments = [pair for name, pair in prior.values.items() if name[0] in "XY"]  # one is near zero
    assert min(std for _, std in moments) == pytest.approx(0.02 * max(abs(value) for value, _ in moments))


def negative_friction(swing, std=0.05):
    """A knee that pushes itself along."""
    rng = np.random.default_rng(2)
    tau = swing.torque - 1.3 * swing.viscous * swing.motion[1] * [0.0, 1.0, 0.0]
    return swing.recording(tau=tau + rng.normal(scale=std, size=tau.shape))


def test_friction_that_is_negative_beyond_its_error_is_named_not_hidden(swing):
    estimate = identify(swing.leg, negative_friction(swing), TERMS, preparation=PLAIN)
    assert estimate.value("d_knee") < -5.0 * estimate["d_knee"].std
    (found,) = estimate.findings
    assert (found.kind, found.severity, found.parameters) == ("negative-parameter", "warning", ("d_knee",))
    assert estimate["d_knee"].identifiability == "weakly"
    fine = identify(swing.leg, swing.with_noise(np.random.default_rng(2), 0.05), TERMS, preparation=PLAIN)
    assert not fine.findings


def test_an_inertia_that_cannot_be_is_named_in_a_warning(data):
    """Torques that the acceleration of the foot helps along, as those of a foot of negative inertia would be."""
    q, tau = np.array(data.train.q), np.array(data.train.tau)
    a = np.array(exoid.signals.ZeroPhase().kinematics(data.train).a)
    tau -= 0.1 * a.sum(axis=1, keepdims=True)
    odd = exoid.Recording(time=data.train.time, q=q, tau=tau, joint_names=data.train.joint_names)
    estimate = exoid.identify(data.leg, odd, (exoid.Coulomb(), exoid.Viscous()))
    assert estimate.value("J3") < 0.0
    assert "J3" in estimate.doubtful


@pytest.mark.parametrize("estimator", ["ols", "wls", "huber"])
def test_bounds_keep_friction_at_zero_and_say_so(swing, estimator):
    """The same as the fit without that column."""
    recording = negative_friction(swing)
    bounded = identify(swing.leg, recording, TERMS, estimator, preparation=PLAIN, nonnegative=True)
    assert bounded.bounded == ("d_knee",)
    assert bounded.value("d_knee") == 0.0
    assert "kept at zero: d_knee" in str(bounded)
    assert bounded["d_knee"].std > 0.0
    without = identify(swing.leg, recording, TERMS, estimator, preparation=PLAIN, known={"d_knee": 0.0})
    np.testing.assert_allclose(bounded.values, without.values, rtol=1e-3, atol=1e-6)
    unbound = identify(swing.leg, swing.recording(), TERMS, estimator, preparation=PLAIN, nonnegative=True)
    assert unbound.bounded == ()


@pytest.mark.nightly
def test_bounds_make_intervals_no_worse(swing):
    """A friction of zero: half of all estimates would be negative; intervals still contain the truth."""
    rng, inside = np.random.default_rng(8), []
    truth = np.append(swing.truth, [0.0, 0.0])
    for _ in range(60):
        recording = swing.with_noise(rng, NOISE)
        estimate = identify(
            swing.leg, recording, (*TERMS, Armature(joints=("knee", "ankle"))), preparation=PLAIN, nonnegative=True
        )
        inside.append(holds(estimate, truth))
    coverage = np.mean(inside, axis=0)
    print(f"coverage with bounds: {coverage.mean():.3f}, worst {coverage.min():.3f}")
    assert coverage.mean() >= 0.93
    assert coverage.min() >= 0.85


ALL = TorqueModel(exoid.load_leg("bleex"), (Coulomb(), Viscous(), Armature())).names


REFUSED = {
    "known": ({"X9": 1.0}, {"X1": np.nan}, {"X1": "heavy"}, dict.fromkeys((*ALL, "Ia_hip"), 1.0)),
    "prior": ({"J3": 0.05}, {"J3": (0.05, 0.0)}, {"Ia_hip": (0.1, 0.01)}),
    "noise": ("pink", "White"),
}
WRONG = [{name: value} for name, values in REFUSED.items() for value in values]


@pytest.mark.parametrize("given", [*WRONG, {"prior": {"J3": (0.05, 0.1)}, "known": {"J3": 0.05}}], ids=str)
def test_arguments_that_make_no_sense_are_refused(swing, given):
    with pytest.raises(BadArgumentError):
        identify(swing.leg, swing.recording(), (Coulomb(), Viscous(), Armature()), **given)


def test_assumptions_hold_beside_friction_that_makes_the_model_nonlinear(swing):
    """There is no friction under load in truth: what is known stays, and what must not be negative is not."""
    terms = (*TERMS, LoadFriction(smoothing=TERMS[0].smoothing, reversal_speed=0.0))
    known = {"X1": float(swing.leg.parameters[0])}
    est = identify(swing.leg, swing.recording(), terms, known=known, nonnegative=True, preparation=PLAIN)
    assert est.value("X1") == known["X1"]
    loads = [est.value(name) for name in est.names if name.startswith("mu_")]
    np.testing.assert_allclose(loads, 0.0, atol=1e-4)
    assert min(loads) >= 0.0
    np.testing.assert_allclose(est.values[: len(swing.truth)], swing.truth, atol=1e-2)


def test_where_the_bodies_are_known_the_rotor_of_the_hip_is_found(swing):
    """It acts as J1 does, but a known J1 cannot take it in; a rotor apart from unknown bodies stays in J1."""
    rotors = np.array([0.3, 0.2, 0.05])
    noise = np.random.default_rng(4).normal(scale=0.3 * NOISE, size=swing.motion[0].shape)
    tau = swing.recording().tau + rotors * swing.motion[2] + noise
    recording, terms = swing.recording(tau=tau), (*TERMS, Armature())
    bodies = dict(zip(swing.leg.parameter_names, swing.leg.parameters, strict=True))
    found = identify(swing.leg, recording, terms, preparation=PLAIN, known=bodies)
    for label, rotor in zip(swing.leg.joint_labels, rotors, strict=True):
        parameter = found[f"Ia_{label}"]
        assert abs(parameter.value - rotor) < 4.0 * parameter.std < 0.5 * rotor
    del bodies["J1"]
    merged = identify(swing.leg, recording, terms, preparation=PLAIN, known=bodies)
    assert "Ia_hip" not in merged.names
    assert merged.value("J1") == pytest.approx(swing.leg.parameters[2] + rotors[0], abs=4.0 * merged["J1"].std)
