"""Each controller computes its equation, for one leg and for many, and refuses invalid settings."""

import runpy
import warnings
from pathlib import Path

import numpy as np
import pytest
from controlled_legs import cuhk_plant, exact_estimate, random_target, true_torque

from exoid import control
from exoid.control import (
    AHEAD,
    SHARP,
    SMOOTH,
    ControlModel,
    FrictionCompensation,
    State,
    gravity_friction_pd,
    pd,
)
from exoid.experiments import gait_for_leg, healthy_gait

STUDY = runpy.run_path(str(Path(__file__).resolve().parents[2] / "scripts" / "study_gains.py"))
KP, KD = (22.0, 56.0), (2.2, 5.6)
PLANT = cuhk_plant()


def random_state(seed=1, shape=(2,)):
    q, v = np.random.default_rng(seed).uniform(-1.0, 1.0, (2, *shape))
    return State(q, v)


def feedback(state, target):
    return np.array(KP) * (target.q - state.q) + np.array(KD) * (target.v - state.v)


def test_pd_is_its_equation():
    """Doc. 2, eq. (24)."""
    state, target = random_state(), random_target()
    np.testing.assert_allclose(pd(KP, KD).torque(state, target), feedback(state, target))


@pytest.mark.parametrize(
    ("friction", "sign"),
    [
        (None, lambda s, t: 0.0 * s.v),
        (SMOOTH, lambda s, t: np.tanh(s.v / 0.05)),
        (SHARP, lambda s, t: np.sign(s.v)),
        (AHEAD, lambda s, t: np.tanh(t.v / 0.05)),
    ],
)
@pytest.mark.parametrize("source", [PLANT, exact_estimate()], ids=["plant", "estimate"])
def test_gravity_friction_pd_is_its_equation(source, friction, sign):
    """Doc. 2, eq. (25), with Pinocchio's gravity."""
    state, target, zero = random_state(), random_target(), np.zeros(2)
    speed = target.v if friction is AHEAD else state.v
    viscous = PLANT.viscous[:, 0] * speed if friction else zero
    expected = feedback(state, target) + true_torque(PLANT, state.q, zero, zero)
    expected += PLANT.coulomb[:, 0] * sign(state, target) + viscous
    law = gravity_friction_pd(source, KP, KD, friction=friction)
    np.testing.assert_allclose(law.torque(state, target), expected, atol=1e-12)


def test_friction_may_be_compensated_in_part():
    state, target = random_state(), random_target()
    torque = {
        scale: gravity_friction_pd(PLANT, KP, KD, friction=FrictionCompensation(scale=scale)).torque(state, target)
        for scale in (0.0, 1.0, 1.5)
    }
    np.testing.assert_allclose(torque[1.5] - torque[0.0], 1.5 * (torque[1.0] - torque[0.0]))
    np.testing.assert_allclose(torque[0.0], gravity_friction_pd(PLANT, KP, KD, friction=None).torque(state, target))


def test_gains_cannot_be_changed_afterwards():
    law = pd(KP, KD)
    with pytest.raises(ValueError, match="read-only"):
        law.kp[0] = 1.0


def test_negative_friction_is_compensated_only_with_a_warning():
    wrong = ControlModel.of(PLANT).with_friction(-1.0)
    with pytest.warns(UserWarning, match=r"hip.*knee.*Table III"):
        gravity_friction_pd(wrong, KP, KD)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gravity_friction_pd(wrong, KP, KD, friction=None)
        gravity_friction_pd(PLANT, KP, KD)


def test_names_of_the_standard_laws_are_those_of_the_functions_that_make_them():
    assert all(callable(getattr(control, name)) for name in control.LAWS)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 4])
def test_on_own_legs_with_light_ankles_compensation_is_not_worse_than_pd(seed):
    """The ankle is held while hip and knee move: compensation at the measured velocity cancels what holds it."""
    plant = STUDY["drawn_leg"](seed)
    runs = STUDY["track"](plant, 4.0)
    assert "ankle" in plant.leg.joint_names
    assert (runs["desired"].peak_deg <= runs["pd"].peak_deg).all()
    assert (runs["desired"].rms_deg <= runs["pd"].rms_deg).all()
    assert runs["measured"].peak_deg[-1] > 2.0 * runs["desired"].peak_deg[-1]


@pytest.mark.slow
@pytest.mark.parametrize("period", [4.0, 10.0])
def test_with_default_gains_compensation_is_not_worse_than_pd(period):
    gait = gait_for_leg(PLANT.leg, healthy_gait(0.8, period))
    kp, kd = control.default_gains(PLANT, control.mean_pose(gait, period))
    laws = {"pd": pd(kp, kd), "compensated": gravity_friction_pd(PLANT, kp, kd)}
    runs = control.compare_laws(PLANT, laws, gait, 2.0 * period, settle=period)
    assert (runs["compensated"].peak_deg <= runs["pd"].peak_deg).all()
    assert (runs["compensated"].rms_deg <= runs["pd"].rms_deg).all()
