"""Noise-free recordings give the parameters back: of every leg, planar or not, by every estimator."""

import numpy as np
import pytest
from public_robots import urdf_of
from swings import TERMS, Swing
from unchecked import identify

import exoid
from exoid import Armature, Offset, Stiffness
from exoid.identification.estimators.by_name import ESTIMATORS
from exoid.leg.catalog import urdf_folder
from exoid.regression.every_row import make_rows
from exoid.signals import FiniteDifference, ZeroPhase
from exoid.torques import TorqueModel


def load(name):
    if name == "dfki":
        return exoid.Leg.from_urdf(urdf_folder() / "dfki_double_pendulum.urdf", ("shoulder", "elbow"))
    if name == "ur5":
        return exoid.Leg.from_urdf(urdf_of("ur5"))
    built_in, side, inertias = name.split("-")
    return exoid.load_leg(built_in, side, inertias)


LEGS = ("bleex-left-cad", "bleex-left-identified", "bleex-right-identified", "cuhk-right-nominal", "dfki", "ur5")


@pytest.fixture(params=LEGS, scope="module")
def swing(request):
    return Swing(load(request.param), base=0.2)


def assert_recovered(estimate, truth, tolerance):
    """Every value within ``tolerance`` of its own size, or of a thousandth of the largest if it is near zero."""
    allowed = tolerance * np.maximum(np.abs(truth), 1e-3 * np.abs(truth).max())
    wrong = np.abs(estimate.values - truth) > allowed
    assert not wrong.any(), dict(zip(np.array(estimate.names)[wrong], estimate.values[wrong], strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("estimator", sorted(set(ESTIMATORS) - {"ml"}))
def test_exact_kinematics_give_the_parameters_back_and_the_parallel_filter_biases_nothing(swing, estimator):
    """Columns and torque pass the same filter; with the kinematics filter out of the way nothing else is left."""
    parallel = ZeroPhase(cutoff=6.0, kinematics_cutoff=0.49 * swing.rate)
    for preparation, tolerance in ((FiniteDifference(), 1e-8), (parallel, 1e-6)):
        estimate = identify(swing.leg, swing.recording(), TERMS, estimator, preparation=preparation)
        assert_recovered(estimate, swing.truth, tolerance)


def test_several_recordings_are_one_least_squares_problem(swing):
    pieces = [Swing(swing.leg, seconds=6.0, seed=seed, base=0.2) for seed in (3, 4, 5)]
    rng = np.random.default_rng(0)
    recordings = [piece.with_noise(rng, 0.2) for piece in pieces]
    estimate = identify(swing.leg, recordings, TERMS, "ols", preparation=FiniteDifference())

    model = TorqueModel(swing.leg, TERMS)
    rows = [make_rows(model, recording, FiniteDifference()) for recording in recordings]
    W = np.vstack([part.W.reshape(-1, len(model.names)) for part in rows])
    expected, *_ = np.linalg.lstsq(W, np.concatenate([part.tau.ravel() for part in rows]))
    np.testing.assert_allclose(estimate.values, expected, rtol=1e-8, atol=1e-9)
    assert [source.samples for source in estimate.inputs] == [600, 600, 600]


def test_the_order_of_recordings_and_of_their_joints_does_not_matter():
    swing = Swing(load("bleex-left-cad"))
    first, second = swing.recording(), Swing(swing.leg, seed=2).recording()
    reversed_joints = second.select(second.joint_names[::-1])
    one = identify(swing.leg, [first, second], TERMS)
    other = identify(swing.leg, [reversed_joints, first], TERMS)
    np.testing.assert_allclose(one.values, other.values, rtol=1e-9)


def test_every_term_is_recovered_beside_the_rigid_bodies():
    """Knee and ankle stiffness, rotor inertia and sensor zero, each at the joint that has it."""
    swing = Swing(load("bleex-left-cad"), base=0.2)
    q, _, a = swing.motion
    extra = {"Ia_knee": 0.11, "offset_hip": -0.7, "b2_ankle": 0.9, "b1_ankle": 1.7, "b0_ankle": 0.4}
    tau = swing.torque.copy()
    tau[:, 0] += extra["offset_hip"]
    tau[:, 1] += extra["Ia_knee"] * a[:, 1]
    tau[:, 2] += extra["b2_ankle"] * q[:, 2] ** 2 + extra["b1_ankle"] * q[:, 2] + extra["b0_ankle"]
    terms = (*TERMS, Armature(joints=("knee",)), Offset(joints=("hip",)), Stiffness(joints=("left_ankle",)))
    estimate = identify(swing.leg, swing.recording(tau=tau), terms, preparation=FiniteDifference())
    for name, value in extra.items():
        assert estimate.value(name) == pytest.approx(value, rel=1e-7)
    assert_recovered(exoid.identify(swing.leg, swing.recording(), TERMS), swing.truth, 1e-4)


def test_leaving_out_friction_that_exists_must_fail():
    swing = Swing(load("bleex-left-cad"))
    estimate = identify(swing.leg, swing.recording(), (), preparation=FiniteDifference())
    with pytest.raises(AssertionError):
        assert_recovered(estimate, swing.leg.parameters, 1e-2)
