"""Friction beyond Coulomb and viscous: what it dissipates, what it depends on, and what it remembers."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from planar_chains import random_motion

import exoid
from exoid import Armature, Coulomb, Offset, Stiffness, Viscous
from exoid.torques import JointMotion, LoadFriction, Presliding, Stribeck, TorqueModel
from exoid.torques.catalog import TERMS
from exoid.torques.linearised import Linearised

DRY = (
    Coulomb(),
    Coulomb(smoothing=0.0),
    Stribeck(velocity=0.3),
    LoadFriction(),
    LoadFriction(split=True, smoothing=0.1),
)

seeds = st.integers(0, 2**32 - 1)


def motion_of(term, q=0.0, v=0.0, load=0.0):
    """Motion of one joint, with its hidden state."""
    q, v, load = (np.array(x, dtype=float) for x in np.broadcast_arrays(np.atleast_1d(q), v, load))
    memory = None if term.internal_state is None else term.internal_state.states(q, v)
    return JointMotion(q, v, np.zeros_like(q), load, memory)


def columns(term, **motion):
    given_motion = motion_of(term, **motion)
    out = np.zeros((len(term.symbols), len(given_motion.q)))
    term.fill(given_motion, out)
    return out


def recurrence(q, v, length):
    """Dahl's hysteresis sample by sample, as it is written."""
    z = [float(np.sign(v[0])) if abs(v[0]) > 0.05 * np.sqrt(np.mean(v**2)) else 0.0]
    for k in range(1, len(q)):
        step = 0.0 if v[k] == v[k - 1] == 0.0 else q[k] - q[k - 1]
        s = np.sign(step)
        z.append(s + (z[-1] - s) * np.exp(-abs(step) / length))
    return np.array(z)


def wander(seed, samples=400, still=0.2):
    """Angles that go to and fro in steps of all sizes, and rest at times; velocities to match."""
    rng = np.random.default_rng(seed)
    steps = rng.standard_normal(samples) * 10.0 ** rng.uniform(-6, -1, samples)
    steps = np.where(rng.random(samples) < still, 0.0, steps)
    if rng.random() < 0.5:
        steps = np.abs(steps) * np.repeat(rng.choice([-1.0, 1.0], samples), 20)[:samples]
    return np.cumsum(steps), 100.0 * steps


@pytest.mark.slow
@given(seeds, st.floats(1e-5, 0.1))
def test_the_closed_form_of_presliding_is_the_recurrence(seed, length):
    q, v = wander(seed)
    np.testing.assert_allclose(Presliding(length).states(q, v), recurrence(q, v, length), atol=1e-9)


@given(seeds, st.floats(1e-4, 0.1))
def test_presliding_depends_on_the_way_and_not_on_its_speed(seed, length):
    """Gone at another pace, with pauses and with points in between, the state at the same points is the same."""
    rng = np.random.default_rng(seed)
    q, v = wander(seed, still=0.0)
    v[0] = np.sign(v[0]) * np.abs(v).max()  # both begin as they slide
    fine = np.interp(np.arange(4 * len(q) - 3) / 4.0, np.arange(len(q)), q)
    pauses = rng.integers(1, 4, len(fine))
    slow, arrival = np.repeat(fine, pauses), (np.cumsum(pauses) - pauses)[::4]
    states = Presliding(length).states(slow, np.full(len(slow), 1e-3 * np.sign(v[0])))
    np.testing.assert_allclose(states[arrival], Presliding(length).states(q, v), atol=1e-9)


def test_after_a_reversal_friction_turns_over_a_way_of_a_few_lengths():
    """It is 1 − 2 exp(−x / δ) after x beyond a turn from sliding backwards."""
    x = np.linspace(0.0, 0.01, 200)
    q = np.concatenate([np.linspace(1.0, 0.0, 50), x[1:]])
    z = Presliding(1e-3).states(q, np.gradient(q))
    np.testing.assert_allclose(z[49:], 1.0 - 2.0 * np.exp(-x / 1e-3), atol=1e-9)


def test_a_single_sample_is_sliding_the_way_it_moves_and_poses_remember_nothing():
    memory = Presliding(1e-3)
    np.testing.assert_array_equal(memory.states(np.array([0.3]), np.array([-2.0])), [-1.0])
    np.testing.assert_array_equal(memory.states(np.array([0.3, 0.9, -0.4]), np.zeros(3)), np.zeros(3))
    assert memory.states(np.zeros(0), np.zeros(0)).shape == (0,)


def test_a_recording_that_begins_at_rest_begins_undeflected_whatever_its_noise():
    """Friction at rest may be of either sign; the sign of the first velocity is that of noise."""
    q = np.concatenate([np.zeros(100), np.linspace(0.0, 1.0, 400)])
    v = np.gradient(q) + 1e-6 * np.random.default_rng(0).choice([-1.0, 1.0], len(q))
    z = Presliding(1e-3).states(q, v)
    np.testing.assert_array_equal(z[:100], 0.0)
    assert z[-1] > 0.999
    v[0] = -1.0
    np.testing.assert_array_equal(Presliding(1e-3).states(q, v)[:100], -1.0)


@given(seeds)
def test_presliding_takes_energy_out_over_every_closed_way(seed):
    """∮ z dq ≥ 0 once the state comes back too; between, a bent contact gives some back."""
    turns = np.random.default_rng(seed).uniform(-0.01, 0.01, 6)
    once = np.interp(np.linspace(0.0, 6.0, 6000, endpoint=False), np.arange(7), np.append(turns, turns[0]))
    q = np.tile(once, 10)
    z = Presliding(1e-3).states(q, np.gradient(q))
    power = 0.5 * (z[-6000:] + z[-6001:-1]) * np.diff(q[-6001:])
    assert power.sum() >= 0.0


@pytest.mark.parametrize("term", [*DRY, Viscous()])
@given(seeds)
def test_friction_with_positive_parameters_takes_energy_out_at_every_moment(term, seed):
    rng = np.random.default_rng(seed)
    v, load = rng.standard_normal((2, 50)) * 10.0 ** rng.uniform(-3, 1, (2, 50))
    parameters = rng.uniform(0.0, 2.0, len(term.symbols))
    assert (parameters @ columns(term, v=v, load=load) * v >= 0.0).all()


@pytest.mark.parametrize("term", DRY)
@pytest.mark.parametrize("presliding", [0.0, 1e-3])
@given(seeds)
def test_friction_in_a_mirror_is_friction_with_the_other_sign(term, presliding, seed):
    term = TERMS.from_json({**TERMS.to_json(term), "presliding": presliding})
    q, v = wander(seed, 50)
    load = np.random.default_rng(seed).standard_normal(50)
    np.testing.assert_allclose(columns(term, q=-q, v=-v, load=-load), -columns(term, q=q, v=v, load=load), atol=1e-15)


def test_stribeck_friction_is_largest_where_motion_is_slow():
    size = columns(Stribeck(velocity=0.2, smoothing=0.0), v=[1e-9, 0.2, 2.0])[0]
    np.testing.assert_allclose(size, [1.0, np.exp(-1.0), 0.0], atol=1e-12)


def test_load_friction_is_a_share_of_the_rigid_bodies_torque_against_the_motion():
    v, load = np.array([1.0, 1.0, -1.0, -1.0]), np.array([5.0, -5.0, 5.0, -5.0])
    np.testing.assert_array_equal(columns(LoadFriction(smoothing=0.0), v=v, load=load), [[5.0, 5.0, -5.0, -5.0]])
    split = columns(LoadFriction(split=True, smoothing=0.0), v=v, load=load)
    np.testing.assert_array_equal(split, [[5.0, 0.0, 0.0, -5.0], [0.0, 5.0, -5.0, 0.0]])


def test_the_load_is_the_models_own_rigid_body_torque():
    leg = exoid.load_leg("cuhk")
    q, v, a = random_motion(np.random.default_rng(1), 2)
    model = TorqueModel(leg, (LoadFriction(smoothing=0.0),))
    expected = np.abs(leg.inverse_dynamics(q, v, a)) * np.sign(v)
    np.testing.assert_allclose(model.regressor(q, v, a)[:, [0, 1], [-2, -1]], expected, rtol=1e-9)
    half = model.loaded_by(0.5 * leg.parameters)
    np.testing.assert_allclose(half.regressor(q, v, a)[:, [0, 1], [-2, -1]], 0.5 * expected, rtol=1e-9)


@pytest.mark.parametrize("presliding", [0.0, 2e-3])
def test_columns_of_a_stretch_are_those_of_the_whole(presliding):
    """Hidden states are of the whole motion, however it is cut."""
    leg = exoid.load_leg("cuhk")
    model = TorqueModel(leg, (Coulomb(presliding=presliding), LoadFriction(presliding=presliding), Stribeck()))
    time = np.arange(20_000) / 500.0
    q = np.column_stack([np.sin(time), 0.4 * np.cos(3.0 * time)])
    v, a = np.gradient(q, time, axis=0), -q
    motion = model.motion(q, v, a)
    whole = model.columns(motion)
    for rows in (slice(0, 3), slice(8000, 9001), slice(19_000, None)):
        np.testing.assert_allclose(model.columns(motion.rows(rows)), whole[:, :, rows], atol=1e-12)


settings = st.floats(0.0, 10.0)


@given(settings, settings, st.floats(0.0, 1.0), st.booleans())
def test_a_term_survives_a_round_trip_through_json(first, second, band, yes):
    lean = {"joints": ("knee",), "dead_band": band}
    terms = [
        Coulomb(presliding=first, smoothing=second, **lean),
        LoadFriction(presliding=second, split=yes, **lean),
        Stribeck(velocity=first if first != 0.0 else 1.0, **lean),
        *(Viscous(), Armature(), Offset(joints=("hip",)), Stiffness(degree=4, joints=("knee",))),
    ]
    for term in terms:
        assert TERMS.from_json(json.loads(json.dumps(TERMS.to_json(term), allow_nan=False))) == term


def test_a_linearised_model_has_the_derivatives_of_the_torque():
    """∂τ/∂β by differences of the whole nonlinear torque; and at the point it gives that torque."""
    leg = exoid.load_leg("cuhk")
    terms = (
        *(Coulomb(presliding=0.02, joints=("hip",)), Coulomb(presliding=0.01, joints=("knee",))),
        *(LoadFriction(split=True, presliding=0.02), Stribeck(presliding=0.01, velocity=0.3, joints=("knee",))),
        *(Viscous(), Armature()),
    )
    time = np.arange(600) / 200.0
    q = np.column_stack([np.sin(3.0 * time), 0.4 * np.cos(5.0 * time)])
    v = np.column_stack([3.0 * np.cos(3.0 * time), -2.0 * np.sin(5.0 * time)])
    a = np.column_stack([-9.0 * np.sin(3.0 * time), -10.0 * np.cos(5.0 * time)])
    point = np.concatenate([leg.parameters, [0.8, 0.5, 0.1, 0.05, 0.08, 0.03, 0.4, 0.2, 0.1, 0.02]])
    model = TorqueModel(leg, terms)

    def torque(x):
        return model.loaded_by(x).regressor(q, v, a) @ x

    linear = Linearised.of(model, point)
    W = linear.regressor(q, v, a)
    np.testing.assert_allclose(W @ np.append(point, 1.0), torque(point), atol=1e-7)
    for k, x in enumerate(point):
        change = np.zeros(len(point))
        change[k] = 1e-5 * max(abs(x), 0.1)
        slope = (torque(point + change) - torque(point - change)) / (2.0 * change[k])
        np.testing.assert_allclose(W[:, :, k], slope, atol=2e-3 * max(1.0, np.abs(slope).max()))
    for joint in range(2):
        assert not W[:, joint, :-1][:, ~linear.acting[joint]].any()


@pytest.mark.parametrize("kind", [Coulomb, Stribeck, LoadFriction])
def test_friction_with_presliding_is_known_at_reversals_and_other_friction_is_not(kind):
    v = np.sin(np.linspace(0.0, 20.0, 1000))
    assert kind(presliding=1e-3).reversing(v) is None
    assert 0.0 < kind().reversing(v).mean() < 0.1
