"""Terms that depend on several joints and act on several, through every step of exoid."""

import numpy as np
import pytest
from swings import Swing
from unchecked import identify

import exoid
from exoid import Armature, Coulomb, Estimate, ExoidError, Offset, Viscous
from exoid.control import ControlModel
from exoid.identification import select_terms
from exoid.torques import CouplingFriction, CouplingInertia, CouplingSpring, TorqueModel
from exoid.torques.motion import random_motion

LEG = exoid.load_leg("bleex")
SPRING = CouplingSpring(joints=("hip", "knee"), ratios=(1.0, -0.6))
DRAG = CouplingFriction(joints=("knee", "hip"), ratios=(1.0, 1.0))
ROTOR = CouplingInertia(joints=("hip", "knee", "ankle"), ratios=(1.0, 1.0, -0.5))
ALL = (SPRING, DRAG, ROTOR)
VALUES = {
    **{"k_hip_knee": 12.0, "preload_hip_knee": 1.5},
    **{"c0_knee_hip": 0.7, "d_knee_hip": 0.4, "Ia_hip_knee_ankle": 0.3},
}
INDEX = {"hip": 0, "knee": 1, "ankle": 2}


def coordinate(term, x) -> np.ndarray:
    """Σ r_j x_j, (N,)."""
    return x[:, [INDEX[joint] for joint in term.joints]] @ np.array(term.ratios)


def torque_of(values, q, v, a) -> np.ndarray:
    """Torque of all couplings by their equations, without exoid's columns (N, 3)."""
    tau = np.zeros_like(q)

    def add(term, force):
        for joint, ratio in zip(term.joints, term.ratios, strict=True):
            tau[:, INDEX[joint]] += ratio * force

    add(SPRING, values["k_hip_knee"] * coordinate(SPRING, q) + values["preload_hip_knee"])
    rate = coordinate(DRAG, v)
    add(DRAG, values["c0_knee_hip"] * np.tanh(rate / DRAG.smoothing) + values["d_knee_hip"] * rate)
    add(ROTOR, values["Ia_hip_knee_ankle"] * coordinate(ROTOR, a))
    return tau


def swing_with_couplings(seed=1, values=VALUES) -> exoid.Recording:
    swing = Swing(LEG, seed=seed)
    tau = swing.torque + torque_of(values, *swing.motion)
    noise = np.random.default_rng(seed).normal(scale=0.02, size=tau.shape)
    return swing.recording(tau=tau + noise, v=None, a=None)


TERMS = (Coulomb(), Viscous(), *ALL)


@pytest.fixture(scope="module")
def estimate() -> Estimate:
    return identify(LEG, [swing_with_couplings(1), swing_with_couplings(2)], TERMS)


def test_the_whole_model_is_the_sum_of_its_equations():
    model, (q, v, a) = TorqueModel(LEG, ALL), random_motion(50, 3)
    values = np.append(LEG.parameters, [VALUES[name] for name in model.names[len(LEG.parameters) :]])
    expected = LEG.inverse_dynamics(q, v, a) + torque_of(VALUES, q, v, a)
    np.testing.assert_allclose(model.regressor(q, v, a) @ values, expected, atol=1e-10)
    acting = model.acting[:, len(LEG.parameters) :]
    assert acting.sum(axis=0).tolist() == [2, 2, 2, 2, 3]


def test_couplings_are_found_beside_everything_else(estimate):
    truth = dict(zip(estimate.names, [*LEG.parameters, *Swing(LEG).coulomb, *Swing(LEG).viscous], strict=False))
    truth.update(VALUES)
    z = [(estimate.value(name) - truth[name]) / estimate.std[k] for k, name in enumerate(estimate.names)]
    assert np.abs(z).max() < 4.5, dict(zip(estimate.names, z, strict=True))
    assert estimate.value("k_hip_knee") == pytest.approx(12.0, rel=0.02)
    assert estimate.value("Ia_hip_knee_ankle") == pytest.approx(0.3, rel=0.05)


def test_the_preload_is_part_of_the_offsets_of_all_its_joints():
    model = TorqueModel(LEG, (Offset(), SPRING))
    (regrouped,) = model.regrouped
    assert regrouped.name == "preload_hip_knee"
    assert regrouped.into == pytest.approx({"offset_hip": 1.0, "offset_knee": -0.6})
    assert model.names[-1] == "k_hip_knee"


def test_one_joint_with_torque_is_enough_and_none_is_refused():
    log = swing_with_couplings()
    one = np.where([True, False, True], log.tau, np.nan)
    found = identify(LEG, exoid.Recording(log.time, log.q, tau=one, joint_names=LEG.joint_names), (SPRING, *TERMS[:2]))
    assert {"k_hip_knee", "preload_hip_knee"} <= set(found.names)
    none = np.where([False, False, True], log.tau, np.nan)
    with pytest.raises(ExoidError, match="k_hip_knee, preload_hip_knee left no trace"):
        identify(LEG, exoid.Recording(log.time, log.q, tau=none, joint_names=LEG.joint_names), (SPRING,))


@pytest.mark.nightly
def test_the_friction_of_each_joint_is_chosen_beside_a_spring_over_two_joints():
    log = swing_with_couplings(1, {**VALUES, "c0_knee_hip": 0.0, "d_knee_hip": 0.0, "Ia_hip_knee_ankle": 0.0})
    found = select_terms(LEG, log, folds=3, beside=(SPRING,))
    estimate = found.identify(log)
    assert estimate.value("k_hip_knee") == pytest.approx(12.0, rel=0.02)
    assert all("c0" in one.coefficients for one in found.joints)
    assert (found.candidate.nrmse < 0.03).all()


@pytest.mark.slow
def test_the_checks_find_no_fault_where_the_couplings_are_in_the_model():
    checked = exoid.identify(LEG, [swing_with_couplings(1), swing_with_couplings(2)], TERMS)
    assert [finding for finding in checked.findings if finding.severity != "info"] == []
    without = exoid.identify(LEG, [swing_with_couplings(1), swing_with_couplings(2)], (Coulomb(), Viscous()))
    assert [finding for finding in without.findings if finding.severity != "info"]


@pytest.fixture(scope="module")
def control(estimate) -> ControlModel:
    return ControlModel.of(estimate)


def test_a_controller_compensates_couplings_at_one_sample_and_at_many(estimate, control):
    q, v, a = random_motion(20, 3)
    whole = estimate.torque(q, v, a)
    found = control.inverse_dynamics(q.T, v.T, a.T) + control.friction(q.T, v.T, DRAG.smoothing)
    np.testing.assert_allclose(found.T, whole, atol=1e-9)
    for k in range(3):
        single = control.inverse_dynamics(q[k], v[k], a[k]) + control.friction(q[k], v[k], DRAG.smoothing)
        np.testing.assert_allclose(single, whole[k], atol=1e-9)


def test_the_mass_matrix_has_the_rotor_across_joints(estimate, control):
    q = random_motion(1, 3)[0, 0]
    row = np.array(ROTOR.ratios)
    added = control.mass_matrix(q) - control.leg.mass_matrix(q)[0]
    np.testing.assert_allclose(added, estimate.value("Ia_hip_knee_ankle") * np.outer(row, row), atol=1e-12)
    several = control.rotors(random_motion(5, 3)[0])
    np.testing.assert_allclose(several, np.broadcast_to(added, (5, 3, 3)), atol=1e-12)


def test_a_rotor_over_two_joints_is_regrouped_beside_the_rotor_of_the_second():
    """Its inertia between the joints is also that of J2, and its own at each joint that of J1 and of the rotor."""
    two = CouplingInertia(joints=("hip", "knee"), ratios=(1.0, -0.5))
    model = TorqueModel(LEG, (Armature(), two))
    assert [one.name for one in model.regrouped] == ["Ia_hip", "Ia_hip_knee"]
    assert set(model.regrouped[1].into) == {"J1", "J2", "Ia_knee"}
    assert "Ia_hip_knee" in TorqueModel(LEG, (two,)).names
    three = CouplingInertia(joints=("hip", "knee", "ankle"), ratios=(1.0, 0.4, -0.5))
    assert "Ia_hip_knee_ankle" in TorqueModel(LEG, (Armature(), three)).names
