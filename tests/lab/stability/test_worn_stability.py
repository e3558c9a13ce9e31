"""Stability of worn legs: linearised loops against independent integration, closed solutions and other code."""

from collections import deque
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import pytest
import scipy
from controlled_legs import LEG, TERMS, cuhk_plant, estimate_of, frictionless

import exoid
from exoid import ExoidError, published
from exoid.control import ControlModel, State, gravity_friction_pd, pd, sensitivity_amplification, stateful
from exoid.control.lqr import linearise
from exoid.experiments import Hold
from exoid.lab.stability import largest_amplification
from exoid.lab.stability.draws import draw_truths
from exoid.lab.stability.linear_law import linear_law, loop_matrices
from exoid.lab.stability.worn_leg import HeldLeg, hold, linear_leg, linear_legs, linear_wearer
from exoid.lab.stability.worn_loop import WornLoop, poses_of
from exoid.rig import Plant, Target, Wearer
from exoid.tools.numbers import ROUNDED
from exoid.torques import Coulomb, TorqueModel, Viscous

POSE = np.deg2rad([12.0, 35.0])
PLANT = frictionless(cuhk_plant(end_stops=False))
MODEL = ControlModel.of(PLANT)
AMPLIFIED = partial(sensitivity_amplification, bandwidth=30.0, rate=250.0)


@pytest.fixture(scope="module")
def wearer():
    """Muscles that hold a pose."""
    return Wearer.build(LEG, height=1.7, mass=65.0, intention=Hold(POSE[:, None]))


def heavier(factor):
    """A model whose bodies and rotors are all too heavy by a factor."""
    leg = MODEL.leg.with_parameters(factor * MODEL.leg.parameters)
    return replace(MODEL, leg=leg, armature=factor * MODEL.armature)


def wrong_estimate(std=0.1):
    """An estimate with relative standard deviations, of bodies with friction."""
    model = TorqueModel(LEG, (Coulomb(), Viscous()))
    est = estimate_of(model, {**published.cuhk_parameters(), **published.cuhk_resistances()})
    return replace(est, covariance=np.diag((std * np.abs(est.values)) ** 2))


class WornLeg:
    """Nonlinear leg and limb with constant torques that make a pose an equilibrium under a controller.

    Integrated by SciPy with Pinocchio's accelerations, independent of the rig.
    """

    def __init__(self, model, wearer, law, pose, delay):
        self.model, self.wearer, self.law = model, wearer, stateful(law)
        self.pose, self.delay, self.n = pose, delay, model.n
        self.k, self.d, self.km, self.dm = (
            np.broadcast_to(np.ravel(x), pose.shape)
            for x in (wearer.cuff_stiffness, wearer.cuff_damping, wearer.muscle_stiffness, wearer.muscle_damping)
        )
        self.data, self.limb_data = model.pinocchio.createData(), wearer.limb.model.createData()
        still = np.zeros(self.n)
        state = State(pose, still, interaction=still)
        torque, _ = self.law.step(self.law.begin(state), state, Target(pose, still, still))
        self.balance = model.statics(pose) - torque, wearer.limb.gravity(pose[None])[0]

    def rate_of_change(self, x, torque):
        q, v, p, w = np.split(x, 4)
        worn = self.k * (p - q) + self.d * (w - v)
        springs = self.model.statics(q) - self.model.gravity(q) + self.model.viscous * v
        a = pin.aba(self.model.pinocchio, self.data, q, v, torque + worn + self.balance[0] - springs)
        muscles = self.km * (p - self.pose) + self.dm * w
        b = pin.aba(self.wearer.limb.model, self.limb_data, p, w, self.balance[1] - worn - muscles)
        return np.concatenate([v, a, w, b])

    def run(self, x, periods):
        """States at the samples, (periods + 1, 4 n), from a start with a past at that start."""
        target = Target(self.pose, np.zeros(self.n), np.zeros(self.n))
        late = deque([self.reading(x)] * (self.delay + 1), maxlen=self.delay + 1)
        memory, states, last = self.law.begin(late[0]), [x], None
        for _ in range(periods):
            torque, memory = self.law.step(memory, late[0]._replace(last=last), target)
            last = torque
            found = scipy.integrate.solve_ivp(
                lambda _, y, held=torque: self.rate_of_change(y, held),
                (0.0, 1.0 / self.law.rate),
                states[-1],
                method="DOP853",
                rtol=1e-9,
                atol=1e-13,
            )
            states.append(found.y[:, -1])
            late.append(self.reading(states[-1]))
        return np.array(states)

    def reading(self, x):
        q, v, p, w = np.split(x, 4)
        worn = self.k * (p - q) + self.d * (w - v)
        return State(q, v, interaction=worn)


def test_the_linear_leg_is_that_of_pinocchios_derivatives():
    """Without Coulomb friction; the velocity derivative of Coriolis torques cancels."""
    model = ControlModel.of(cuhk_plant())
    A, B = linearise(replace(model, coulomb=np.zeros(2)), POSE, np.zeros(2), np.zeros(2))
    found = linear_leg(model, POSE)
    inverse = np.linalg.inv(found.M[0])
    np.testing.assert_allclose(inverse, B[2:], rtol=1e-9)
    np.testing.assert_allclose(-inverse @ found.K[0], A[2:, :2], rtol=1e-6)
    np.testing.assert_allclose(-inverse @ found.D[0], A[2:, 2:], rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("name", ["cuhk", "bleex"])
def test_draws_of_parameters_give_the_same_legs_as_control_models(name):
    model = TorqueModel(exoid.load_leg(name), TERMS if name == "cuhk" else (Coulomb(), Viscous()))
    rng = np.random.default_rng(1)
    start = np.array(
        [dict(zip(model.leg.parameter_names, model.leg.parameters, strict=True)).get(n, 0.4) for n in model.names]
    )
    draws = start * rng.uniform(0.9, 1.1, (3, len(start)))
    q = rng.uniform(-0.5, 0.5, len(model.leg.joint_names))
    many = linear_legs(model, draws, q)
    for k, draw in enumerate(draws):
        one = linear_leg(ControlModel.of_parameters(model, draw), q)
        for found, expected in zip(many, one, strict=True):
            np.testing.assert_allclose(found[k], expected[0], rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_without_wearer_and_memory_the_radius_is_that_of_the_model_of_lqr(delay):
    law = gravity_friction_pd(PLANT, (22.0, 55.0), (2.2, 5.5), friction=None, rate=50.0)
    loop = WornLoop.of([law], np.zeros(1), None, POSE[None], delay)
    radius = loop.radius(loop.legs_of([MODEL]), np.zeros(1))
    moves = np.vstack([np.hstack(linearise(MODEL, POSE, np.zeros(2), np.zeros(2))), np.zeros((2, 6))])
    A, B = np.split(scipy.linalg.expm(moves / law.rate)[None, :4], [4], axis=2)  # a torque is held for a period
    matrix = loop_matrices(HeldLeg(A, B, np.eye(6, 4)), linear_law(law, POSE).without_last(), delay)
    assert radius[0] == pytest.approx(np.abs(np.linalg.eigvals(matrix)).max(), rel=1e-7)


@pytest.mark.parametrize("delay", [0, 2])
def test_the_loop_matrix_predicts_an_independent_nonlinear_integration(wearer, delay):
    """Thirty periods from a small velocity of the leg, with a model that is 8 % too heavy."""
    law = AMPLIFIED(heavier(1.08), 6.0)
    leg = hold(linear_leg(MODEL, POSE), linear_wearer(wearer, POSE), 1.0 / law.rate)
    matrix = loop_matrices(leg, linear_law(law, POSE).without_last(), delay)[0]
    kick = np.zeros(8)
    kick[2:4] = 1e-3, -2e-3
    begun = _begun_memory(law, POSE + kick[:2], kick[2:4]) - _begun_memory(law, POSE, np.zeros(2))
    width = (len(matrix) - len(kick) - len(begun)) // max(delay, 1)  # of a late reading
    state = np.concatenate([kick, *[(leg.C @ kick)[:width]] * delay, begun])
    simulated = WornLeg(MODEL, wearer, law, POSE, delay).run(np.concatenate([POSE, [0, 0], POSE, [0, 0]]) + kick, 30)
    for expected in simulated[1:]:
        state = matrix @ state
        offset = expected - np.concatenate([POSE, [0, 0], POSE, [0, 0]])
        np.testing.assert_allclose(state[:8], offset, rtol=0.0, atol=2e-3 * np.abs(simulated[1:] - simulated[0]).max())


class Memory(NamedTuple):
    v: np.ndarray


@dataclass(frozen=True)
class AcceleratedJoint:
    """τ = inertia (1 − 1/α) a with a = ω (v − v_f), v_f the velocity behind a low-pass of the first order."""

    inertia: float
    amplification: float
    bandwidth: float = 10.0
    rate: float = 20000.0

    def begin(self, state):
        return Memory(state.v)

    def step(self, memory, state, target):
        turn = 2.0 * np.pi * self.bandwidth
        a = turn * (state.v - memory.v)
        return self.inertia * (1.0 - 1.0 / self.amplification) * a, Memory(memory.v + a / self.rate)


@pytest.mark.parametrize("factor", [1.1, 1.3, 2.0])
def test_one_joint_has_the_boundary_of_routh_and_hurwitz(factor):
    """J/ω s³ + (J (1 − κ) + d/ω) s² + (d + k/ω) s + k with κ = factor (1 − 1/α), for a fast controller."""
    joint = exoid.Leg.from_urdf(exoid.catalog.urdf_folder() / "cuhk.urdf", ("left_knee",))
    J, d, k, turn = 0.6, 2.0, 30.0, 2.0 * np.pi * 10.0
    truth = Plant.build(joint, {"X1": 0.0, "Y1": 0.0, "J1": J, "d_knee": d, "b1_knee": k}, end_stops=False)
    kappa = 1.0 + d / (turn * J) - (k / turn) / (d + k / turn)

    def law(source, amplification):
        return AcceleratedJoint(factor * J, amplification)

    found = largest_amplification(truth, truth=truth, law=law, poses=[0.3])
    assert found.largest == pytest.approx(1.0 / (1.0 - kappa / factor), rel=0.01)
    assert not found.drawn
    assert 0.5 < found.frequency < 10.0


def test_values_agree_with_the_share_of_stable_loops(wearer):
    est = wrong_estimate()
    found = largest_amplification(est, wearer=wearer, law=AMPLIFIED, poses=POSE, draws=100)
    assert np.isfinite(found.largest)
    assert np.mean(found.values >= found.largest) >= 0.95 > np.mean(found.values >= 1.05 * np.sort(found.values)[5])
    drawn, _ = draw_truths(est.model, est.values, est.covariance, 100, 0)
    for amplification in (found.largest, 2.0 * found.largest):  # the loops of this amplification alone
        loop = WornLoop.of([AMPLIFIED(est, amplification)], np.zeros(1), wearer, POSE[None], 0)
        stable = np.mean(loop.radius(loop.legs(est.model, drawn), np.zeros(100)) <= 1.0 + ROUNDED)
        assert stable == pytest.approx(np.mean(found.values >= amplification), abs=0.011)
    low, high = found.interval
    assert low <= found.largest <= high


def test_draws_have_the_covariance_and_only_possible_legs():
    est = wrong_estimate(0.01)
    parameters, rejected = draw_truths(est.model, est.values, est.covariance, 4000, 0)
    assert rejected == 0.0
    np.testing.assert_allclose(parameters.std(axis=0)[:6], np.sqrt(np.diag(est.covariance))[:6], rtol=0.06)
    wild = est.covariance.copy()
    wild[5, 5] = est.values[5] ** 2
    assert 0.1 < draw_truths(est.model, est.values, wild, 200, 0)[1] < 0.9
    with pytest.raises(ExoidError, match="positive definite"):
        draw_truths(est.model, -est.values, est.covariance, 10, 0)
    with pytest.raises(ExoidError, match="covariance of J2"):
        draw_truths(est.model, est.values, np.diag(np.where(np.arange(10) == 5, np.inf, 1.0)), 10, 0)


def test_the_scan_finds_the_first_of_several_boundaries():
    """A controller that is unstable only between two amplifications."""

    def law(amplification):
        return pd(1e5 if 1.9 < amplification < 6.0 else 10.0, 1.0, rate=200.0)

    loop = WornLoop.of_amplifications(law, None, POSE[None], 0, 100.0)
    assert len(loop.shares) > 3  # not linear
    assert 1.0 < loop.largest(loop.legs_of([MODEL]))[0] < 6.0


def test_settings_that_make_no_sense_are_refused(wearer):
    est = wrong_estimate()
    for wrong in ({"share": 1.0}, {"draws": 0}, {"most": 1.0}, {"poses": [0.1]}, {"delay": -1}):
        with pytest.raises(ExoidError):
            largest_amplification(est, wearer=wearer, **wrong)
    with pytest.raises(ExoidError, match="only an estimate"):
        largest_amplification(MODEL)
    assert poses_of(LEG, None).shape == (8, 2)
    assert poses_of(exoid.load_leg("bleex"), None)[:, 1].max() == 0.0  # a stride straightens the knee by 1.2° more
    assert WornLoop.of([pd(1.0, 0.1)], np.zeros(1), None, POSE[None], 0).laws[0].N.shape == (1, 0, 0)


def test_a_leg_with_other_names_has_the_roles_that_are_given():
    hip, knee = LEG.joint_names
    text = LEG.description.text.replace(f'"{hip}"', '"upper"')
    leg = exoid.Leg.from_description(exoid.leg.description.describe(text), ("upper", knee))
    found = largest_amplification(leg, truth=leg, roles={"upper": "hip", knee: "knee"}, most=4.0)
    assert found.values == largest_amplification(LEG, truth=LEG, most=4.0).values


def _begun_memory(law, q, v):
    """Numbers of the memory that a controller begins with, and no last torque if nothing depends on it."""
    state = State(q, v, interaction=np.zeros(2))
    rank = linear_law(law, POSE).without_last().N.shape[0]
    numbers = np.concatenate([*map(np.ravel, law.begin(state)), np.zeros(2)])
    return numbers[:rank]
