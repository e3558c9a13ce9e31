"""The closed loop of a controller and the rig, and its metrics."""

import numpy as np
import pytest
from controlled_legs import LEG, cuhk_plant, frictionless
from scipy.integrate import solve_ivp

from exoid.control import ControlModel, State, gravity_friction_pd, pd, simulate_law, simulate_many
from exoid.experiments import Hold, healthy_gait
from exoid.leg.description import describe
from exoid.leg.leg import Leg
from exoid.rig import IdealTorque, Plant, ProportionalDerivative, Target, simulate

pytestmark = pytest.mark.slow

KP, KD = (22.0, 56.0), (2.2, 5.6)


class Spy:
    """Controller that records its inputs, and commands the time as torque."""

    rate = 30.0

    def __init__(self):
        self.heard = []

    def torque(self, state: State, target: Target):
        self.heard.append((state, target))
        return np.full_like(state.q, 0.01 * len(self.heard))


def test_a_controller_receives_the_time_the_target_and_its_last_torque():
    spy, gait = Spy(), healthy_gait()
    simulate_law(cuhk_plant(), spy, gait, 1.0)
    assert len(spy.heard) == 31
    for k, (state, target) in enumerate(spy.heard):
        assert state.time == pytest.approx(k / 30.0)
        assert state.last is None if k == 0 else state.last == pytest.approx(0.01 * k)
        for received, true in zip(target, gait.at(k / 30.0), strict=True):
            np.testing.assert_allclose(received, true[:, 0], atol=1e-12)


def test_the_closed_loop_without_friction_is_that_of_an_integrator_of_high_order():
    """Pinocchio's dynamics under DOP853; holding the torque between samples costs an error of first order."""
    plant, gait = frictionless(cuhk_plant(0.0)), healthy_gait()
    law = gravity_friction_pd(plant, KP, KD, friction=None)
    model = ControlModel.of(plant)

    def rate(t, y):
        q, v = y[:2], y[2:]
        tau = law.torque(State(q, v, t), Target(*(x[:, 0] for x in gait.at(t))))
        tau -= plant.viscous[:, 0] * v
        return [*v, *np.linalg.solve(model.mass_matrix(q), tau - model.inverse_dynamics(q, v, np.zeros(2)))]

    fine = np.arange(1601) / 2000.0
    begin = gait.at(0.0)
    start = [*begin.q[:, 0], *begin.v[:, 0]]
    truth = solve_ivp(rate, (0.0, 0.8), start, method="DOP853", t_eval=fine, rtol=1e-9, atol=1e-11).y[:2].T
    errors = []
    for every, hertz in ((2, 1000.0), (1, 2000.0)):
        run = simulate_law(plant, gravity_friction_pd(plant, KP, KD, friction=None, rate=hertz), gait, 0.8)
        errors.append(np.abs(run.q - truth[::every]).max())
    assert errors[1] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)
    assert np.deg2rad(run.peak_deg.max()) > 50.0 * errors[1]


def test_metrics_are_what_their_names_say():
    run = simulate_law(cuhk_plant(), pd(KP, KD), healthy_gait(period=2.0), 3.0, settle=1.0)
    late = run.time >= 1.0
    error = np.rad2deg(run.target - run.q)[late]
    np.testing.assert_allclose(run.peak_deg, np.abs(error).max(axis=0))
    np.testing.assert_allclose(run.rms_deg, np.sqrt(np.mean(error**2, axis=0)))
    np.testing.assert_allclose(run.rms_torque, np.sqrt(np.mean(run.tau[late] ** 2, axis=0)))
    np.testing.assert_allclose(run.torque_variation, np.abs(np.diff(run.tau[late], axis=0)).sum(axis=0) / 2.0)
    power = np.abs(run.tau * run.v)[late]
    np.testing.assert_allclose(run.energy, (power[1:] + power[:-1]).sum(axis=0) / 200.0)
    assert run.to_json()["peak_deg"] == run.peak_deg.tolist()


def test_positions_of_a_slide_are_in_mm():
    """Metres of a rail were printed as if they were radians."""
    rail = describe(LEG.description.text.replace("revolute", "prismatic", 1))
    plant, hold = Plant.build(Leg.from_description(rail, LEG.joint_names)), Hold(np.array([[0.3], [0.5]]))
    run = simulate_law(plant, pd(KP, KD), hold, 0.5)
    errors = np.abs(run.error[1:]).max(axis=0) / [1e-3, np.deg2rad(1.0)]
    np.testing.assert_allclose(run.peak_deg, errors)
    assert repr(run).endswith(f"left_hip {errors[0]:.3g} mm, left_knee {errors[1]:.3g}°)")
    assert f"{1e3 * plant.lower[0, 0]:.3g}" in str(plant)
    rig = str(simulate(plant, hold, ProportionalDerivative(2e3, 2e2), IdealTorque(), 0.0005))
    assert all("mm or deg" in table for table in (str(run), str(plant), rig))


def test_many_rigs_at_once_do_what_each_does_alone():
    plants = [cuhk_plant(), cuhk_plant(0.0), cuhk_plant(c0_hip=3.0)]
    assert all(plant.leg is plants[0].leg for plant in plants)
    together = simulate_many(
        Plant.concatenate(plants), pd(KP, KD), healthy_gait(period=2.0), 0.6, names=("rotor", "none", "stiff")
    )
    assert [one.law for one in together] == ["rotor", "none", "stiff"]
    for one, plant in zip(together, plants, strict=True):
        alone = simulate_law(plant, pd(KP, KD), healthy_gait(period=2.0), 0.6)
        np.testing.assert_allclose(one.q, alone.q, atol=1e-8)
