"""Properties of terms and estimators on any leg, motion and parameters."""

import dataclasses

import numpy as np
import pytest
from cases import cases
from hypothesis import given
from hypothesis import strategies as st
from outcomes import outcome
from planar_chains import random_chain
from swings import harmonics, log_of

import exoid
from exoid import Armature, Coulomb, Estimate, Offset, Recording, Stiffness, Viscous
from exoid.identification.estimators.by_name import ESTIMATORS
from exoid.signals import FiniteDifference
from exoid.torques import JointMotion, TorqueModel

SPEEDS = st.floats(0.0, 10.0)
TERMS = st.one_of(
    st.builds(Coulomb, smoothing=SPEEDS, dead_band=SPEEDS),
    st.just(Viscous()),
    st.just(Armature()),
    st.just(Offset()),
    st.just(Stiffness()),
)
STATES = st.floats(-1e6, 1e6)


@cases(0.1)
@given(term=TERMS, state=st.tuples(STATES, STATES, STATES), scale=st.floats(-1e3, 1e3))
def test_every_term_is_finite_and_friction_is_odd_and_dissipates(term, state, scale):
    q, v, a = (np.array([x, -x, 0.0, scale * x]) for x in state)
    columns = np.full((len(term.symbols), 4), np.nan)
    term.fill(JointMotion(q, v, a, load=q), columns)
    assert np.isfinite(columns).all()
    assert len(term.units) == len(term.symbols)
    assert term.usable(v).shape == (4,)
    if isinstance(term, (Coulomb, Viscous)):
        assert (columns * v >= 0.0).all()
        assert columns[0, 1] == -columns[0, 0]
        assert columns[0, 2] == 0.0
    if isinstance(term, Coulomb):
        assert (np.abs(columns) <= 1.0).all()


def _leg(seed):
    """A planar chain of one to three links with random inertias."""
    rng = np.random.default_rng(seed)
    return random_chain(rng, int(rng.integers(1, 4))).leg()


def _motion(leg, seed, samples=160, rate=50.0):
    rng = np.random.default_rng(seed)
    n = len(leg.joint_names)
    time = np.arange(samples) / rate
    omega = 2.0 * np.pi * rng.uniform(0.2, 2.0, (n, 4))
    size, phase = rng.uniform(0.1, 0.4, (n, 4)), rng.uniform(0.0, 6.0, (n, 4))
    return time, *harmonics(time, size, omega, phase)


@pytest.mark.slow
@cases(0.03)
@given(
    seed=st.integers(0, 2**31),
    terms=st.lists(st.sampled_from([Coulomb(), Viscous(), Armature(), Offset()]), unique=True, max_size=4).map(tuple),
    estimator=st.sampled_from(list(ESTIMATORS)),
)
def test_exact_data_give_the_truth_or_a_refusal_never_a_confident_wrong_number(seed, terms, estimator):
    leg = _leg(seed)
    time, q, v, a = _motion(leg, seed)
    model = TorqueModel(leg, terms)
    rng = np.random.default_rng(seed + 1)
    truth = np.concatenate([leg.parameters, rng.uniform(0.1, 1.0, len(model.names) - len(leg.parameters))])
    tau = model.regressor(q, v, a) @ truth
    recording = Recording(time=time, q=q, v=v, a=a, tau=tau, joint_names=leg.joint_names)
    result = outcome(exoid.identify, leg, recording, terms, estimator, preparation=FiniteDifference())
    if isinstance(result, Estimate):
        error = np.abs(result.values - truth)
        assert (error <= 1e-6 * result.parameter_scale + 10.0 * result.std).all()
        exact = 1e-4 if estimator == "ml" else 1e-6  # a spline is not quite the motion
        np.testing.assert_allclose(result.torque(q, v, a), tau, rtol=0.0, atol=exact * np.abs(tau).max())


@pytest.mark.slow
@cases(0.03)
@given(seed=st.integers(0, 2**31), unit=st.floats(0.01, 100.0), estimator=st.sampled_from(["ols", "wls", "huber"]))
def test_an_estimate_scales_with_the_torque_and_does_not_depend_on_the_order_of_recordings(seed, unit, estimator):
    leg = _leg(seed)
    rng = np.random.default_rng(seed)
    recordings = []
    for k in range(2):
        time, *motion = _motion(leg, seed + k)
        recordings.append(log_of(leg, time, motion, noise=0.05, seed=rng, exact=True))
    options = {"terms": (Viscous(),), "estimator": estimator, "preparation": FiniteDifference()}
    result = outcome(exoid.identify, leg, recordings, **options)
    if not isinstance(result, Estimate):
        return
    swapped = exoid.identify(leg, recordings[::-1], **options)
    scaled = exoid.identify(leg, [dataclasses.replace(r, tau=unit * r.tau) for r in recordings], **options)
    size = np.maximum(result.std, np.abs(result.values))
    np.testing.assert_allclose(swapped.values / size, result.values / size, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(scaled.values / size, unit * result.values / size, rtol=0.0, atol=1e-6 * unit)
    np.testing.assert_allclose(scaled.std, unit * result.std, rtol=1e-4)
