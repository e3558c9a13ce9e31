"""The model inside a controller agrees with Pinocchio and the estimate."""

import numpy as np
import pytest
from controlled_legs import LEG, TERMS, cuhk_plant, estimate_of, exact_estimate, true_torque

from exoid import Leg
from exoid.control import ControlModel
from exoid.leg.description import describe
from exoid.torques import Coulomb, LoadFriction, Stribeck, TorqueModel, Viscous

RNG = np.random.default_rng(3)


def test_inverse_dynamics_is_pinocchios_with_springs_and_rotors():
    plant = cuhk_plant(b2_hip=0.3, b1_hip=-0.7, b0_hip=1.1, b0_knee=-0.4)
    model = ControlModel.of(plant)
    viscous = plant.viscous[:, 0]
    for q, v, a in RNG.uniform(-1.0, 1.0, (20, 3, 2)):
        whole = model.inverse_dynamics(q, v, a) + viscous * v
        np.testing.assert_allclose(whole, true_torque(plant, q, v, a), rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(model.statics(q), true_torque(plant, q, 0.0 * v, 0.0 * a), atol=1e-12)


def test_everything_together_is_the_torque_that_the_estimate_predicts():
    """With the smoothing that the estimate was identified with."""
    est = exact_estimate()
    model = ControlModel.of(est)
    width = next(term.smoothing for term in TERMS if isinstance(term, Coulomb))
    for q, v, a in RNG.uniform(-1.0, 1.0, (20, 3, 2)):
        whole = model.inverse_dynamics(q, v, a) + model.friction(q, v, width)
        np.testing.assert_allclose(whole, est.torque(q, v, a)[0], rtol=1e-12, atol=1e-12)


def test_friction_of_a_slide_is_as_smooth_as_that_of_the_terms():
    """A tenth of a width in rad/s counts in m/s."""
    leg = Leg.from_description(describe(LEG.description.text.replace("revolute", "prismatic", 1)), LEG.joint_names)
    model = TorqueModel(leg, (Coulomb(smoothing=0.015), Stribeck()))
    values, v = np.append(leg.parameters, [1.0, 2.0, 0.5, 0.7]), RNG.uniform(-0.02, 0.02, (10, 2))
    friction = model.regressor(0.0 * v, v, 0.0 * v)[:, :, -4:] @ values[-4:]
    found = ControlModel.of_parameters(model, values).friction(0.0 * v.T, v.T, 0.015).T
    np.testing.assert_allclose(found, friction, atol=1e-12)


class Cubic(Viscous):
    """A friction that exoid does not have, τ = e v³ + f."""

    symbols, units = ("e", "f"), ("N·m·s³/rad³", "N·m")

    def fill(self, motion, out):
        out[0], out[1] = motion.v**3, 1.0


@pytest.mark.parametrize("shape", [(2,), (2, 4)])
def test_a_term_of_an_unknown_kind_is_compensated_too(shape):
    model = TorqueModel(LEG, (Cubic(joints=("knee",)), Coulomb(smoothing=0.05)))
    own = dict(zip(LEG.parameter_names, LEG.parameters, strict=True))
    est = estimate_of(model, {**own, "e_knee": 0.7, "f_knee": -0.2, "c0_hip": 1.0, "c0_knee": 0.5})
    control = ControlModel.of(est)
    q, v, a = RNG.uniform(-1.0, 1.0, (3, *shape))
    whole = control.inverse_dynamics(q, v, a) + control.friction(q, v, 0.05)
    np.testing.assert_allclose(whole.T.reshape(-1, 2), est.torque(q.T, v.T, a.T), atol=1e-12)


@pytest.mark.parametrize("shape", [(2,), (2, 4)])
def test_friction_that_grows_with_load_is_that_of_the_leg_at_rest_under_gravity(shape):
    model = TorqueModel(LEG, (LoadFriction(split=True, smoothing=0.02),))
    own = dict(zip(LEG.parameter_names, LEG.parameters, strict=True))
    est = estimate_of(model, {**own, "mu_drive_hip": 0.2, "mu_back_hip": 0.1, "mu_drive_knee": 0.3})
    control = ControlModel.of(est)
    q, v = RNG.uniform(-1.0, 1.0, (2, *shape))
    gravity = LEG.gravity(q.T)
    drive, back = np.array([0.2, 0.3]), np.array([0.1, 0.0])
    z = np.tanh(v.T.reshape(-1, 2) / 0.02)
    share = 0.5 * (drive * (1.0 + z * np.sign(gravity)) + back * (1.0 - z * np.sign(gravity)))
    np.testing.assert_allclose(control.friction(q, v, 0.02).T.reshape(-1, 2), np.abs(gravity) * z * share, atol=1e-12)
