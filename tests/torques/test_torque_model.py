"""Rigid bodies and terms in one linear model: names, order, columns, regrouping and refusals."""

import numpy as np
import pytest
from planar_chains import assert_relative, random_motion

import exoid
from exoid import Armature, Coulomb, Leg, Offset, Stiffness, TorsoMotion, Viscous
from exoid.torques import Regrouped, Term, TorqueModel
from exoid.torques.model import BLOCK


def model_of(leg: Leg, *terms: object) -> TorqueModel:
    return TorqueModel(leg, terms)


def test_the_legs_parameters_come_first_then_each_term_joint_by_joint(leg):
    model = model_of(leg, Coulomb(), Viscous(joints=("knee",)), Stiffness(joints=("ankle",)))
    assert model.names == (
        *leg.parameter_names,
        *("c0_hip", "c0_knee", "c0_ankle"),
        "d_knee",
        *("b2_ankle", "b1_ankle", "b0_ankle"),
    )
    assert model.units == (*leg.parameter_units, *("N·m",) * 3, "N·m·s/rad", *("N·m/rad²", "N·m/rad", "N·m"))


@pytest.mark.parametrize("samples", [1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK + 5])
def test_the_regressor_is_the_columns_stacked_by_hand(leg, samples):
    q, v, a = random_motion(np.random.default_rng(samples), 3, samples)
    model = model_of(
        leg, Coulomb(smoothing=0.1), Viscous(), Armature(joints=("knee", "ankle")), Stiffness(joints=("hip",))
    )
    by_hand = np.zeros((samples, 3, 9 + 3 + 3 + 2 + 3))
    by_hand[:, :, :9] = leg.regressor(q, v, a)
    for joint in range(3):
        by_hand[:, joint, 9 + joint] = np.tanh(v[:, joint] / 0.1)
        by_hand[:, joint, 12 + joint] = v[:, joint]
    by_hand[:, 1, 15], by_hand[:, 2, 16] = a[:, 1], a[:, 2]
    by_hand[:, 0, 17], by_hand[:, 0, 18], by_hand[:, 0, 19] = q[:, 0] ** 2, q[:, 0], 1.0
    W = model.regressor(q, v, a)
    assert W.shape == (samples, 3, len(model.names))
    assert_relative(W, by_hand, 1e-15)


def test_terms_do_not_feel_the_torso_and_the_leg_does(leg):
    q, v, a = random_motion(np.random.default_rng(3), 3)
    torso = TorsoMotion(0.3, 0.1, -0.2, (1.0, 2.0))
    model = model_of(leg, Coulomb(), Stiffness())
    W = model.regressor(q, v, a, torso)
    np.testing.assert_array_equal(W[:, :, :9], leg.regressor(q, v, a, torso))
    np.testing.assert_array_equal(W[:, :, 9:], model.regressor(q, v, a)[:, :, 9:])


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
def test_a_rotor_at_the_hip_is_part_of_j1_and_at_the_others_a_parameter_of_its_own(name, side):
    leg = exoid.load_leg(name, side=side)
    model = model_of(leg, Armature())
    (regrouped,) = model.regrouped
    assert regrouped.name == "Ia_hip"
    assert regrouped.into == {"J1": pytest.approx(1.0, abs=1e-9)}
    assert str(regrouped) == "Ia_hip is regrouped into J1: no motion distinguishes them"
    assert model.names == (*leg.parameter_names, *(f"Ia_{joint}" for joint in leg.joint_labels[1:]))


def test_a_regrouped_rotor_keeps_the_torque(leg):
    """J1 + Ia_hip gives what both apart would."""
    q, v, a = random_motion(np.random.default_rng(6), 3)
    model = model_of(leg, Armature())
    beta = np.concatenate([leg.parameters, [0.2, 0.3]])
    beta[2] += 0.8
    assert_relative(model.regressor(q, v, a) @ beta, leg.inverse_dynamics(q, v, a) + a * [0.8, 0.2, 0.3], 1e-12)


def test_a_b0_after_an_offset_is_the_offset_and_the_other_columns_stay_in_place(leg):
    model = model_of(leg, Offset(), Stiffness(joints=("knee",)))
    assert [(m.name, list(m.into)) for m in model.regrouped] == [("b0_knee", ["offset_knee"])]
    assert model.names[9:] == ("offset_hip", "offset_knee", "offset_ankle", "b2_knee", "b1_knee")
    assert len(model.units) == len(model.names)
    q, v, a = random_motion(np.random.default_rng(7), 3)
    W = model.regressor(q, v, a)
    np.testing.assert_allclose(W[:, 1, 12], q[:, 1] ** 2, rtol=1e-15)
    np.testing.assert_array_equal(W[:, 1, 13], q[:, 1])


class GearedRotor(Term):
    """Twice a rotor, beside a constant and something of its own: regrouping must keep scales and columns apart."""

    @property
    def symbols(self) -> tuple[str, ...]:
        return ("constant", "rotor", "cube")

    @property
    def units(self) -> tuple[str, ...]:
        return ("N·m", "kg·m²", "N·m·s³/rad³")

    def fill(self, motion, out) -> None:
        out[0], out[1], out[2] = 3.0, 2.0 * motion.a, motion.v**3


def test_regrouped_parameters_state_their_share_and_leave_the_others_their_columns(leg):
    model = model_of(leg, Offset(), GearedRotor(joints=("hip",)))
    assert model.regrouped == (
        Regrouped("constant_hip", {"offset_hip": pytest.approx(3.0, abs=1e-9)}),
        Regrouped("rotor_hip", {"J1": pytest.approx(2.0, abs=1e-9)}),
    )
    assert str(model.regrouped[1]).startswith("rotor_hip is regrouped into J1 (× 2)")
    assert model.names[9:] == ("offset_hip", "offset_knee", "offset_ankle", "cube_hip")
    q, v, a = random_motion(np.random.default_rng(9), 3)
    W = model.regressor(q, v, a)
    np.testing.assert_array_equal(W[:, 0, 12], v[:, 0] ** 3)
    assert_relative(W[:, :, 2] * 2.0, np.stack([2.0 * a[:, 0], 0 * q[:, 1], 0 * q[:, 2]], axis=1), 1e-15)


def test_the_same_term_at_different_joints_may_have_different_settings(leg):
    model = model_of(leg, Coulomb(joints=("hip",), smoothing=0.5), Coulomb(joints=("knee", "ankle"), smoothing=0.0))
    assert model.names[9:] == ("c0_hip", "c0_knee", "c0_ankle")
    W = model.regressor(np.zeros((1, 3)), np.full((1, 3), 0.5), np.zeros((1, 3)))
    np.testing.assert_allclose(W[0, [0, 1, 2], [9, 10, 11]], [np.tanh(1.0), 1.0, 1.0])
