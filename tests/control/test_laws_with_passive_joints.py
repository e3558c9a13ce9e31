"""Joints without an actuator: an estimate knows them, and no law counts on a torque that nothing makes."""

from dataclasses import replace

import numpy as np
import pytest
import scipy
from made_estimates import from_file

import exoid
from exoid import Coulomb, Stiffness, Viscous, control
from exoid.control.lqr import linearise
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.rig import Plant, Sensors

LEG = exoid.load_leg("bleex")
FRICTION = {"c0_hip": 1.0, "c0_knee": 0.8, "d_hip": 0.5, "d_knee": 0.4, "d_ankle": 1.5}
PLANT = Plant.build(LEG, {**FRICTION, "b1_ankle": 20.0}, end_stops=False)  # a spring holds the foot
GAIT, PERIOD, RATE = gait_for_leg(LEG, healthy_gait(0.5, 3.0)), 3.0, 200.0
TERMS = (Coulomb(joints=("hip", "knee")), Viscous(), Stiffness(degree=1, joints=("ankle",)))
NAMES = ("feedforward_pd", "computed_torque", "lqr", "self_tuning")


class OnlyHipAndKnee:
    """Computed torque whose drive at the ankle is missing."""

    rate = RATE
    whole = control.computed_torque(PLANT, 100.0, 20.0)

    def torque(self, state, target):
        torque = self.whole.torque(state, target).copy()
        torque[2] = 0.0
        return torque


@pytest.fixture(scope="module")
def log():
    """Log of a machine whose ankle is passive."""
    run = control.simulate_law(PLANT, OnlyHipAndKnee(), GAIT, 6.0, log_rate=RATE)
    return replace(run.recording, passive=("left_ankle",))


@pytest.fixture(scope="module")
def estimate(log, tmp_path_factory):
    """Identified, and read from its file."""
    return from_file(exoid.identify(LEG, log, TERMS), tmp_path_factory.mktemp("estimate"))


@pytest.mark.filterwarnings("ignore:not determined by the recordings")
def test_laws_leave_a_passive_ankle_alone_and_the_other_joints_follow(estimate):
    """The rig has no torque there: a law that gives one tracks an ankle that nothing moves."""
    assert estimate.passive == ("left_ankle",)
    laws = control.standard_laws(
        estimate, *control.default_gains(estimate, np.zeros(3), RATE), GAIT, PERIOD, rate=RATE, names=NAMES
    )
    every = {**laws, "support": control.gravity_support(estimate, friction=control.PASSIVE, rate=RATE)}
    every["amplification"] = control.sensitivity_amplification(estimate, 2.0, rate=RATE)
    for name, law in every.items():
        run = control.simulate_law(PLANT, law, GAIT, 0.2 if name not in laws else 1.5, log_rate=RATE)
        assert not run.tau[:, 2].any(), name
        if name in laws:
            rms = np.sqrt((run.error[100:] ** 2).mean(axis=0))
            assert (rms[:2] < 0.01).all(), (name, rms)
            assert rms[2] > 0.02, "the gait is not that of a foot on a spring"


def test_a_spring_that_the_log_hardly_tells_from_the_foot_stays(log):
    """Nothing says what size it could have, where no torque was measured: it became zero, and the foot with it."""
    estimate = exoid.identify(LEG, log, (Coulomb(joints=("hip", "knee")), Viscous(), Stiffness(degree=2)))
    assert estimate["b1_ankle"].identifiability == "not"
    with pytest.warns(UserWarning, match="not determined"):
        model = control.ControlModel.of(estimate)
    assert model.spring[-2, 2] == pytest.approx(20.0, rel=0.2)
    control.computed_torque(model, 100.0, 20.0, rate=RATE)


@pytest.fixture(scope="module")
def log_by_encoders():
    """Log of the same machine by encoders, with noise of its torques."""
    sensors = Sensors(2.0**16, torque_noise=(0.3, 0.2, 0.0))
    run = control.simulate_law(PLANT, OnlyHipAndKnee(), GAIT, 12.0, log_rate=RATE, seed=1000, sensors=sensors)
    return replace(run.recording, v=None, passive=("left_ankle",))


@pytest.mark.parametrize("estimator", ["huber", "ml", "wls"])
def test_no_estimator_makes_nothing_of_a_passive_foot(estimator, log_by_encoders):
    """Its rows say zero: without a foot they fit best, and weights by their residuals led there."""
    found = exoid.identify(LEG, log_by_encoders, TERMS, estimator=estimator, check=False)
    truth = dict(zip(LEG.parameter_names, LEG.parameters, strict=True)) | {"b1_ankle": 20.0, "d_ankle": 1.5}
    for name in ("X3", "Y3", "J3", "b1_ankle", "d_ankle"):
        assert found[name].value == pytest.approx(truth[name], rel=0.3), name
        assert abs(found[name].value - truth[name]) < 4.0 * found[name].std, name


def test_the_lqr_gain_is_that_of_the_torques_there_are():
    """The discrete Riccati equation for two inputs, with a torque that is held for 5 ms."""
    whole = control.ControlModel.of(PLANT)
    pose, still = control.mean_pose(GAIT, PERIOD), np.zeros(3)
    law = control.lqr(replace(whole, passive=("left_ankle",)), pose, angle_deg=0.2, rate=RATE)
    A, B = linearise(whole, pose, still, still)
    A, B, *_ = scipy.signal.cont2discrete((A, B[:, :2], np.eye(6), np.zeros((6, 2))), 1.0 / RATE)
    Q, R = np.diag([np.deg2rad(0.2) ** -2.0] * 3 + [0.0] * 3), 0.01 * np.eye(2)
    S = scipy.linalg.solve_discrete_are(A, B, Q, R)
    K = np.linalg.solve(R + B.T @ S @ B, B.T @ S @ A)
    np.testing.assert_allclose(np.hstack([law.kp, law.kd]), np.vstack([K, np.zeros(6)]), atol=1e-6 * np.abs(K).max())
