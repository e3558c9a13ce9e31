"""Each controller computes its equation, for one leg and for many, and refuses invalid settings."""

import warnings
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import study_gains as study
from controlled_legs import cuhk_plant, exact_estimate, random_target, true_torque

from exoid import control
from exoid.control import AHEAD, SHARP, SMOOTH, ControlModel, FrictionCompensation, State, gravity_friction_pd, pd

KP, KD = (22.0, 56.0), (2.2, 5.6)
PLANT = cuhk_plant()

KNOWN, MODEL = exact_estimate(), ControlModel.of(PLANT)
Q, V = np.random.default_rng(1).uniform(-1.0, 1.0, (2, 2))
AIM, STILL = random_target(), np.zeros(2)
FEEDBACK = np.array(KP) * (AIM.q - Q) + np.array(KD) * (AIM.v - V)
VISCOUS = PLANT.viscous[:, 0]


def rubbing(v, sign):
    """Friction c0 sign + d v of the plant."""
    return PLANT.coulomb[:, 0] * sign + VISCOUS * v


def rigid(q, v, a):
    """Pinocchio's torque of the bodies with rotors and springs, without friction."""
    return true_torque(PLANT, q, v, a) - VISCOUS * v


SMOOTH_SIGN, WEIGHT = np.tanh(V / 0.05), rigid(Q, STILL, STILL)
EQUATIONS = {  # name: law of a source, torque written out
    "pd": (lambda source: pd(KP, KD), FEEDBACK),  # doc. 2, eq. (24)
    "gravity": (lambda source: gravity_friction_pd(source, KP, KD, friction=None), FEEDBACK + WEIGHT),
    "gravity, smooth": (  # doc. 2, eq. (25)
        lambda source: gravity_friction_pd(source, KP, KD, friction=SMOOTH),
        FEEDBACK + WEIGHT + rubbing(V, SMOOTH_SIGN),
    ),
    "gravity, sharp": (
        lambda source: gravity_friction_pd(source, KP, KD, friction=SHARP),
        FEEDBACK + WEIGHT + rubbing(V, np.sign(V)),
    ),
    "gravity, ahead": (
        lambda source: gravity_friction_pd(source, KP, KD, friction=AHEAD),
        FEEDBACK + WEIGHT + rubbing(AIM.v, np.tanh(AIM.v / 0.05)),
    ),
    "gravity, in part": (
        lambda source: gravity_friction_pd(source, KP, KD, friction=FrictionCompensation(scale=1.5)),
        FEEDBACK + WEIGHT + 1.5 * rubbing(V, SMOOTH_SIGN),
    ),
    "feedforward": (
        lambda source: control.feedforward_pd(source, KP, KD),
        FEEDBACK + rigid(*AIM) + rubbing(AIM.v, np.tanh(AIM.v / 0.05)),
    ),
    "computed torque": (
        lambda source: control.computed_torque(source, KP, KD, friction=None),
        rigid(Q, V, AIM.a + FEEDBACK),
    ),
    "impedance": (lambda source: control.impedance(source, KP, KD, friction=None), FEEDBACK + rigid(Q, V, AIM.a)),
    "support": (lambda source: control.gravity_support(source, (0.4, 1.0)), np.array([0.4, 1.0]) * WEIGHT),
    "transparent": (
        lambda source: control.gravity_support(source, friction=control.PASSIVE),
        WEIGHT + np.where(rubbing(V, SMOOTH_SIGN) * V > 0.0, 0.9 * rubbing(V, SMOOTH_SIGN), 0.0),
    ),
}


@pytest.mark.parametrize("source", [PLANT, KNOWN], ids=["plant", "estimate"])
@pytest.mark.parametrize("name", EQUATIONS)
def test_a_law_is_its_equation(name, source):
    make, expected = EQUATIONS[name]
    np.testing.assert_allclose(make(source).torque(State(Q, V), AIM), expected, atol=1e-11)


def test_negative_friction_is_compensated_only_with_a_warning():
    right = ControlModel.of(PLANT)
    wrong = replace(right, coulomb=-right.coulomb, viscous=-right.viscous)
    for make in (partial(gravity_friction_pd, kd=KD), control.gravity_support, partial(control.impedance, damping=KD)):
        with pytest.warns(UserWarning, match=r"hip.*knee.*Table III"):
            make(wrong, 0.5, friction=SMOOTH)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gravity_friction_pd(wrong, KP, KD, friction=None)
        control.gravity_support(wrong, 0.5, friction=control.PASSIVE)
        gravity_friction_pd(PLANT, KP, KD)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.nightly)])
def test_on_own_legs_with_light_ankles_compensation_is_not_worse_than_pd(seed):
    """The ankle is held while hip and knee move: compensation at the measured velocity cancels what holds it."""
    plant = study.drawn_leg(seed)
    runs = study.track(plant, 4.0)
    assert "ankle" in plant.leg.joint_names
    assert (runs["desired"].peak_deg <= runs["pd"].peak_deg).all()
    assert (runs["desired"].rms_deg <= runs["pd"].rms_deg).all()
    assert runs["measured"].peak_deg[-1] > 2.0 * runs["desired"].peak_deg[-1]
