"""Each controller computes its equation, for one leg and for many, and refuses invalid settings."""

import warnings

import numpy as np
import pytest
from controlled_legs import LEG, cuhk_plant, exact_estimate, random_target, true_torque

from exoid.control import (
    AHEAD,
    SHARP,
    SMOOTH,
    ControlModel,
    FrictionCompensation,
    SideBySide,
    State,
    gravity_friction_pd,
    p,
    pd,
)
from exoid.errors import ExoidError
from exoid.rig import Target

KP, KD = (22.0, 56.0), (2.2, 5.6)
PLANT = cuhk_plant()


def random_state(seed=1, shape=(2,)):
    q, v = np.random.default_rng(seed).uniform(-1.0, 1.0, (2, *shape))
    return State(q, v)


def feedback(state, target):
    return np.array(KP) * (target.q - state.q) + np.array(KD) * (target.v - state.v)


def test_p_is_its_equation():
    state, target = random_state(), random_target()
    np.testing.assert_allclose(p(KP).torque(state, target), np.array(KP) * (target.q - state.q))


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


LAWS = {"p": p(KP), "pd": pd(KP, KD), "pd+g+f": gravity_friction_pd(exact_estimate(), KP, KD)}


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("count", [1, 2, 7])
def test_many_legs_at_once_get_what_each_gets_alone(name, count):
    """Also as many legs as joints, where (n,) and (n, B) look alike."""
    state, target = random_state(shape=(2, count)), Target(*np.random.default_rng(5).uniform(-1.0, 1.0, (3, 2, count)))
    torque = LAWS[name].torque(state, target)
    assert torque.shape == (2, count)
    for k in range(count):
        alone = LAWS[name].torque(State(state.q[:, k], state.v[:, k]), Target(*(x[:, k] for x in target)))
        np.testing.assert_allclose(torque[:, k], alone, atol=1e-12)


def test_a_law_does_not_remember():
    """The same question gets the same answer, whatever was asked in between, and inputs stay as they are."""
    for law in LAWS.values():
        state, target = random_state(), random_target()
        before = [x.copy() for x in (state.q, state.v, target.q, target.v)]
        first = law.torque(state, target)
        law.torque(random_state(9), random_target(8))
        np.testing.assert_array_equal(law.torque(state, target), first)
        for x, kept in zip((state.q, state.v, target.q, target.v), before, strict=True):
            np.testing.assert_array_equal(x, kept)


def test_laws_side_by_side_drive_a_leg_each():
    laws = (LAWS["pd"], LAWS["pd+g+f"], LAWS["p"])
    state, target = random_state(shape=(2, 3)), random_target()
    column = Target(*(x[:, None] for x in target))
    torque = SideBySide(laws).torque(state, column)
    for k, law in enumerate(laws):
        np.testing.assert_allclose(torque[:, k], law.torque(State(state.q[:, k], state.v[:, k]), target), atol=1e-12)


def test_laws_of_different_rates_do_not_go_side_by_side():
    with pytest.raises(ExoidError, match=r"30.*100"):
        SideBySide((pd(KP, KD, rate=30.0), pd(KP, KD)))
    for shape, word in (((2, 3), "2 controllers for 3 rigs"), ((2,), "2 controllers for 1 rigs")):
        with pytest.raises(ExoidError, match=word):
            SideBySide((pd(KP, KD), pd(KP, KD))).torque(random_state(shape=shape), random_target())


@pytest.mark.parametrize("bad", [-1.0, np.nan, (1.0, np.inf), (1.0, -2.0), np.ones((2, 2, 2))])
def test_bad_gains_are_refused(bad):
    for make in (
        lambda: pd(bad, 1.0),
        lambda: pd(1.0, bad),
        lambda: p(bad),
        lambda: gravity_friction_pd(LEG, bad, 1.0),
    ):
        with pytest.raises(ExoidError, match=r"k[pd] ="):
            make()


@pytest.mark.parametrize("rate", [0.0, -1.0, np.inf, np.nan])
def test_bad_rates_are_refused(rate):
    for make in (lambda: pd(1.0, 1.0, rate=rate), lambda: gravity_friction_pd(LEG, 1.0, 1.0, rate=rate)):
        with pytest.raises(ExoidError, match="Hz"):
            make()


@pytest.mark.parametrize("bad", [{"velocity": "wished"}, {"width": -0.1}, {"width": np.nan}, {"scale": np.inf}])
def test_bad_friction_compensation_is_refused(bad):
    with pytest.raises(ExoidError, match="friction compensation"):
        FrictionCompensation(**bad)


@pytest.mark.parametrize("shape", [(2,), (2, 4)])
def test_gains_of_another_number_of_joints_are_refused(shape):
    state = random_state(shape=shape)
    target = Target(*np.zeros((3, *shape)))
    for make in (pd, lambda kp, kd: gravity_friction_pd(LEG, kp, kd)):
        with pytest.raises(ExoidError, match="3 gains or limits for 2 joints"):
            make((1.0, 2.0, 3.0), 0.1).torque(state, target)


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
