"""Estimators that simulate the loop: exact where the model is, and without the bias of noisy angles."""

import dataclasses

import numpy as np
import pytest
from unchecked import identify

import exoid
from exoid import Coulomb, ExoidError, Viscous
from exoid.experiments.references import Harmonics
from exoid.identification.estimators import ClosedLoop, OutputError
from exoid.rig import HydraulicServo, IdealTorque, Plant, Proportional, ProportionalDerivative, Rates, simulate
from exoid.signals import Poses
from exoid.torques import Offset, Stiffness, TorqueModel

RATE, SECONDS, LEAD = 100.0, 4.0, 0.5
TERMS = (Coulomb(), Viscous())
LEG = exoid.load_leg("cuhk")
FRICTION = np.array([1.4, 0.6, 0.4, 0.2])
TRUTH = np.concatenate([LEG.parameters, FRICTION])
OMEGA = 2.0 * np.pi * np.array([0.3, 0.7, 1.1])[:, None, None]
REFERENCE = Harmonics(
    np.array([[0.3], [0.6]]),
    np.array([[[0.30], [0.25]], [[0.15], [-0.20]], [[0.10], [0.10]]]),
    OMEGA,
    np.array([[[0.1], [1.0]], [[2.0], [0.4]], [[0.7], [3.0]]]),
)
PD = ProportionalDerivative(np.array([300.0, 150.0]), np.array([30.0, 12.0]))
LOOP = ClosedLoop(PD, REFERENCE, step=2.5e-3, lead=LEAD)


def log(loop=LOOP, terms=TERMS, truth=TRUTH):
    """What is logged in the loop without noise, its stamps those of the reference."""
    time = 1.5 + np.arange(round(SECONDS * RATE)) / RATE
    zeros = np.zeros((len(time), 2))
    empty = exoid.Recording(time, zeros, joint_names=LEG.joint_names)
    ran = loop.simulate(TorqueModel(LEG, terms), truth[:, None], empty)
    return dataclasses.replace(empty, q=ran.q[..., 0], tau=ran.tau[..., 0])


@pytest.fixture(scope="module")
def exact():
    return log()


def noisy(recording, angle, torque, seed=0):
    rng = np.random.default_rng(seed)
    on_angle, on_torque = rng.standard_normal((2, *recording.q.shape))
    return dataclasses.replace(recording, q=recording.q + angle * on_angle, tau=recording.tau + torque * on_torque)


def relative(estimate, truth=TRUTH):
    return np.abs(estimate.values / truth - 1.0)


def test_the_simulated_torque_is_that_of_the_simulated_motion(exact):
    """Inverse dynamics of the motion, derived from its angles, give the logged torque back."""
    rate = exact.sample_rate
    v = np.gradient(exact.q, 1.0 / rate, axis=0)
    a = np.gradient(v, 1.0 / rate, axis=0)
    fast = (np.abs(v) > 0.3).all(axis=1)[5:-5]
    predicted = TorqueModel(LEG, TERMS).regressor(exact.q, v, a) @ TRUTH
    error = (predicted - exact.tau)[5:-5][fast]
    assert np.sqrt((error**2).mean()) < 0.02 * exact.tau.std()


def test_a_shorter_step_changes_nothing_but_the_error_of_second_order(exact):
    half, quarter = (log(dataclasses.replace(LOOP, step=LOOP.step / k)) for k in (2, 4))
    assert np.abs(exact.q - half.q).max() < 5e-5
    assert np.abs(half.q - quarter.q).max() < 0.35 * np.abs(exact.q - half.q).max()


def test_output_error_on_an_exact_model_returns_the_truth(exact):
    estimate = exoid.identify(LEG, exact, TERMS, OutputError(LOOP))
    assert relative(estimate).max() < 1e-6
    assert (estimate.estimator, estimate.warnings) == ("output-error", ())


def test_output_error_says_how_wrong_it_is(exact):
    estimate = identify(LEG, noisy(exact, 1e-3, 0.1), TERMS, OutputError(LOOP))
    z = (estimate.values - TRUTH) / estimate.std
    assert np.abs(z).max() < 4.0
    assert estimate.std.max() < 0.2


def sticking(control_rate=1000.0):
    """A log of joints that truly stick, in a sampled loop, without noise."""
    names = [f"{symbol}_{label}" for symbol in ("c0", "d") for label in LEG.joint_labels]
    plant = Plant.build(LEG, dict(zip(names, FRICTION, strict=True)), end_stops=False)
    rates = Rates(control_rate, RATE, 1e-3)
    run = simulate(plant, REFERENCE, PD, IdealTorque(), 3.0, rates=rates)
    return run.recording().slice(round(LEAD * RATE))


@pytest.mark.slow
def test_output_error_of_joints_that_stick_in_a_sampled_loop():
    loop = ClosedLoop(PD, REFERENCE, control_rate=1000.0, step=1e-3, lead=LEAD)
    estimate = identify(LEG, sticking(), (Coulomb(smoothing=0.0), Viscous()), OutputError(loop))
    assert relative(estimate).max() < 2e-3


@pytest.mark.slow
def test_a_hydraulic_servo_is_part_of_the_loop():
    servo = HydraulicServo()
    loop = ClosedLoop(Proportional(10.0), REFERENCE, servo, step=2.5e-3, lead=LEAD)
    estimate = identify(LEG, noisy(log(loop), 0.0, 0.01), TERMS, OutputError(loop))
    assert relative(estimate).max() < 0.1


@pytest.mark.slow
def test_springs_offsets_and_poses_join_in():
    terms = (*TERMS, Stiffness(degree=1, joints=("knee",)), Offset(joints=("hip",)))
    model = TorqueModel(LEG, terms)
    truth = np.concatenate([TRUTH, [2.0, -0.5, 0.3]])
    q = np.random.default_rng(1).uniform(-0.5, 0.5, (8, 2))
    at_rest = Poses(q, model.regressor(q, 0 * q, 0 * q) @ truth, LEG.joint_names)
    estimate = identify(LEG, [log(terms=terms, truth=truth), at_rest], terms, OutputError(LOOP))
    assert relative(estimate, truth).max() < 1e-5


def test_friction_that_would_feed_energy_in_is_kept_at_zero(exact):
    terms = (Viscous(),)
    truth = np.concatenate([LEG.parameters, [0.0, 0.2]])
    data = noisy(log(terms=terms, truth=truth), 1e-3, 0.5, 3)
    estimate = identify(LEG, data, terms, OutputError(LOOP))
    friction = estimate.values[-2:]
    assert (friction >= 0.0).all()
    assert friction[1] > 0.0


@pytest.mark.slow
def test_output_error_takes_what_is_known_and_believed(exact):
    data = noisy(exact, 1e-3, 0.1)
    free = identify(LEG, data, TERMS, OutputError(LOOP))
    told = identify(
        LEG, data, TERMS, OutputError(LOOP), known={"X1": TRUTH[0]}, prior={"J2": (LEG.parameters[5], 1e-5)}
    )
    assert told.value("X1") == TRUTH[0]
    assert told.std[told.names.index("J2")] < 0.1 * free.std[free.names.index("J2")]
    assert abs(told.value("J2") - LEG.parameters[5]) < 3e-5


MIXED = (Coulomb(joints=("hip",)), Coulomb(smoothing=0.0, joints=("knee",)), Viscous())
REFUSED = {
    "no loop, by name": (
        lambda data: identify(LEG, data, TERMS, "output-error"),
        r"ClosedLoop\(controller, reference\)",
    ),
    "no loop": (lambda data: identify(LEG, data, TERMS, OutputError()), r"ClosedLoop\(controller, reference\)"),
    "friction of two kinds": (lambda data: identify(LEG, data, MIXED, OutputError(LOOP)), "different smoothing"),
    "segments": (
        lambda data: identify(LEG, data.segments([(2.0, 3.0)]), TERMS, OutputError(LOOP)),
        r"simulates whole recordings.*Recording\.between",
    ),
    **{
        f"{name} {value}": (lambda _, wrong={name: value}: ClosedLoop(PD, REFERENCE, **wrong), "give step and lead")
        for name, value in (("step", 0.0), ("lead", -1.0), ("control_rate", np.inf), ("step", np.nan))
    },
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_simulated_is_refused_with_what_to_give(exact, case):
    call, words = REFUSED[case]
    with pytest.raises(ExoidError, match=words):
        call(exact)
