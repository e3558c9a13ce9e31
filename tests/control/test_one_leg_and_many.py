"""Every law gives many legs at once what each gets alone."""

from __future__ import annotations

import numpy as np
import pytest
from controlled_legs import cuhk_plant, exact_estimate

import exoid
from exoid import Coulomb, Stiffness
from exoid.control import (
    ControlModel,
    FrictionCompensation,
    PassiveFriction,
    State,
    computed_torque,
    feedforward_pd,
    gravity_friction_pd,
    gravity_support,
    impedance,
    lqr,
    pd,
)
from exoid.experiments import Hold
from exoid.rig import Target
from exoid.torques import TorqueModel

FRICTIONS = {
    "smooth": FrictionCompensation(),
    "sharp": FrictionCompensation(width=0.0),
    "too much": FrictionCompensation(width=0.2, scale=1.5),
    "desired": FrictionCompensation(velocity="desired"),
    "desired, sharp": FrictionCompensation(velocity="desired", width=0.0, scale=0.5),
    "none": None,
}


SOURCES = {"est": exact_estimate(), "rig": cuhk_plant(), "leg": exoid.load_leg("bleex")}
LAWS = {
    "pd": lambda source: pd(20.0, 2.0),
    "feedforward": lambda source: feedforward_pd(source, 20.0, 2.0),
    "computed torque": lambda source: computed_torque(source, 25.0, 8.0),
    "lqr": lambda source: lqr(source, Hold(np.zeros((ControlModel.of(source).n, 1))), 10.0),
    "impedance": lambda source: impedance(source, 60.0, 5.0),
    "support": lambda source: gravity_support(source, 0.5, friction=PassiveFriction()),
    **{
        f"gravity, {name}": lambda source, friction=friction: gravity_friction_pd(source, 20.0, 2.0, friction=friction)
        for name, friction in FRICTIONS.items()
    },
}


@pytest.mark.parametrize("make", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("source", SOURCES.values(), ids=SOURCES)
@pytest.mark.parametrize("count", [1, 3, 9])
def test_one_leg_and_many_get_the_same_torque(source, make, count):
    """Also as many legs as joints, where (n,) and (n, B) look alike."""
    law, n = make(source), ControlModel.of(source).n
    q, v, *aim = np.random.default_rng(0).uniform(-1.0, 1.0, (5, n, count))
    v[:, 0] = aim[1][:, 0] = 0.0
    many = law.torque(State(q, v, 6.0), Target(*aim))
    ones = [law.torque(State(q[:, k], v[:, k], 6.0), Target(*(x[:, k] for x in aim))) for k in range(count)]
    np.testing.assert_allclose(np.array(ones).T, many, rtol=1e-12, atol=1e-12)


def test_the_torque_is_the_callers_own():
    """It does not change when the law is asked again."""
    law = gravity_friction_pd(exact_estimate(), 20.0, 2.0)
    still = np.zeros(2)
    first = law.torque(State(still, still), Target(still, still))
    before = first.copy()
    law.torque(State(still + 1.0, still), Target(still, still))
    np.testing.assert_array_equal(first, before)


def test_a_continuous_joint_is_no_exception(tmp_path):
    """Pinocchio stores its angle as cosine and sine."""
    text = (exoid.catalog.urdf_folder() / "cuhk.urdf").read_text(encoding="utf-8")
    (tmp_path / "leg.urdf").write_text(text.replace('type="revolute"', 'type="continuous"'), encoding="utf-8")
    turning = exoid.Leg.from_urdf(tmp_path / "leg.urdf", ("left_hip", "left_knee"), cumulative=False)
    assert turning.model.nq == 4
    q, still = np.array([0.3, 0.7]), np.zeros(2)
    found = gravity_friction_pd(turning, 20.0, 2.0).torque(State(q, still), Target(q, still))
    np.testing.assert_allclose(found, exoid.load_leg("cuhk").gravity(q)[0], rtol=1e-12)


def test_springs_of_any_degree_are_compensated():
    leg = exoid.load_leg("cuhk")
    model = TorqueModel(leg, (Stiffness(degree=3), Coulomb()))
    values = np.concatenate([leg.parameters, np.random.default_rng(1).uniform(0.0, 1.0, len(model.names) - 6)])
    q, still = np.array([0.3, 0.7]), np.zeros(2)
    estimate = exact_estimate()
    estimate = type(estimate)(
        model=model,
        values=values,
        covariance=np.eye(len(values)),
        condition_number=2.0,
        dof=9.0,
        residual_rms=np.ones(2),
        estimator="wls",
        preparation=estimate.preparation,
    )
    found = gravity_friction_pd(estimate, 20.0, 2.0).torque(State(q, still), Target(q, still))
    np.testing.assert_allclose(found, estimate.torque(q, still, still)[0], rtol=1e-12)
