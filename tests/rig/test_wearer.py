"""The wearer on the rig: coupled equations, limits, balances, muscles and refusals."""

import re

import numpy as np
import pinocchio as pin
import pytest
from planar_chains import random_chain
from rigs import BLEEX, EVERYTHING, POSE
from scipy.integrate import solve_ivp

import exoid
from exoid.errors import ExoidError
from exoid.experiments import Hold, healthy_gait
from exoid.leg.description import describe
from exoid.leg.torso import tilted_gravity
from exoid.rig import (
    HydraulicServo,
    IdealTorque,
    Plant,
    ProportionalDerivative,
    Rates,
    Sensors,
    Stepper,
    Target,
    Wearer,
    limb_of,
    simulate,
)
from exoid.rig.worn_stepper import WornStepper
from exoid.torques.payloads import payload_parameters

pytestmark = pytest.mark.slow

CUHK = exoid.load_leg("cuhk")
FREE = Plant.build(CUHK, {"d_hip": 0.3, "d_knee": 0.2, "b1_knee": 2.0, "Ia_hip": 0.4}, end_stops=False)
STICKING = Plant.build(CUHK, {"c0_hip": 1.4, "c0_knee": 0.6, "cs_knee": 0.9, "d_knee": 0.2})
GAIT = healthy_gait(1.0, 1.2)
PD = ProportionalDerivative((200.0, 80.0), (20.0, 8.0))
FINE = Rates(500.0, 100.0, 2.5e-4)


class OpenLoop:
    """Torques that do not depend on the motion, held between samples."""

    def command(self, target, q, v, interaction=None):
        return np.zeros_like(q)


class Feel(OpenLoop):
    """Notes the torque of the wearer that it receives."""

    def __init__(self):
        self.felt = []

    def command(self, target, q, v, interaction=None):
        self.felt.append(interaction)
        return np.zeros_like(q)


def worn(plant=FREE, wearer=None, duration=1.0, controller=None, reference=GAIT, **options):
    options = {"rates": FINE, "wearer": wearer or Wearer.build(plant.leg), **options}
    return simulate(
        plant, reference, controller or OpenLoop(), options.pop("actuator", IdealTorque()), duration, **options
    )


def coupled_by_pinocchio(plant, wearer, start, times):
    """Pinocchio's forward dynamics of leg and limb, no actuator torque, under DOP853: angles of both, (K, 2n)."""
    leg = plant.leg.with_parameters(plant.parameters[:, 0])
    models = [body.model.copy() for body in (leg, wearer.limb)]
    for model in models:
        model.gravity.linear = tilted_gravity(leg.plane, float(plant.pitch[0]))
    datas, n = [model.createData() for model in models], plant.n
    k, d, km, dm = (
        np.broadcast_to(x, (n, 1))[:, 0]
        for x in (wearer.cuff_stiffness, wearer.cuff_damping, wearer.muscle_stiffness, wearer.muscle_damping)
    )
    b2, b1, b0 = plant.stiffness[..., 0]

    def rate(t, y):
        q, p, v, w = y.reshape(4, n)
        cuff = k * (p - q) + d * (w - v)
        muscles = -km * p - dm * w
        if wearer.intention is not None:
            aim = [x[:, 0] for x in wearer.intention.at(t)]
            muscles = muscles + km * aim[0] + dm * aim[1] + pin.rnea(models[1], datas[1], *aim)
        M = pin.crba(models[0], datas[0], q)
        M = np.triu(M) + np.triu(M, 1).T + np.diag(plant.armature[:, 0])
        resistance = b2 * q**2 + b1 * q + b0 + plant.viscous[:, 0] * v
        a = np.linalg.solve(M, cuff - resistance - pin.nle(models[0], datas[0], q, v))
        return np.concatenate([v, w, a, pin.aba(models[1], datas[1], p, w, muscles - cuff)])

    begin = np.concatenate([start.q[:, 0], start.q[:, 0], start.v[:, 0], start.v[:, 0]])
    found = solve_ivp(rate, (0.0, times[-1]), begin, method="DOP853", t_eval=times, rtol=1e-10, atol=1e-12)
    return found.y.T


WEARERS = {
    "passive": Wearer.build(CUHK),
    "soft": Wearer.build(CUHK, 1.9, 95.0, cuff_stiffness=(300.0, 500.0), cuff_damping=5.0, muscle_damping=(2.0, 0.5)),
    "active": Wearer.build(CUHK, intention=GAIT),
    "weak": Wearer.build(CUHK, intention=GAIT, muscle_stiffness=(40.0, 20.0), muscle_damping=0.0),
}


KINDS = ["active", *(pytest.param(kind, marks=pytest.mark.nightly) for kind in WEARERS if kind != "active")]


@pytest.mark.parametrize("kind", KINDS)
def test_leg_and_limb_move_as_pinocchio_says(kind):
    """Another integrator, other dynamics code, leg and limb as two trees: 1e-5 rad, and the torque between them."""
    wearer = WEARERS[kind]
    tilted = Plant.build(CUHK, {"d_hip": 0.3, "d_knee": 0.2, "b1_knee": 2.0, "Ia_hip": 0.4}, pitch=0.2, end_stops=False)
    plant = FREE if wearer.intention is not None else tilted
    run = worn(plant, wearer)
    truth = coupled_by_pinocchio(plant, wearer, GAIT.at(0.0), run.time)
    np.testing.assert_allclose(run.q[..., 0], truth[:, :2], atol=1e-5)
    np.testing.assert_allclose(run.limb_q[..., 0], truth[:, 2:4], atol=1e-5)
    k, d = (np.broadcast_to(x, (2, 1))[:, 0] for x in (wearer.cuff_stiffness, wearer.cuff_damping))
    torque = k * (truth[:, 2:4] - truth[:, :2]) + d * (truth[:, 6:] - truth[:, 4:6])
    assert np.abs(torque).max() > 1.5
    np.testing.assert_allclose(run.interaction[..., 0], torque, atol=0.01)


def test_a_planar_chain_of_any_form_may_be_worn():
    leg = random_chain(np.random.default_rng(3), 4).leg()
    wearer = Wearer(leg.with_parameters(0.4 * leg.parameters), cuff_stiffness=500.0, cuff_damping=10.0)
    plant, start = Plant.build(leg, end_stops=False), Hold(np.full((4, 1), 0.3))
    runs = [worn(plant.repeat(count), wearer, 0.5, reference=start) for count in (1, 2)]
    np.testing.assert_allclose(runs[1].interaction, np.tile(runs[0].interaction, 2), atol=1e-7)
    truth = coupled_by_pinocchio(plant, wearer, start.at(0.0), runs[0].time)
    np.testing.assert_allclose(runs[0].q[..., 0], truth[:, :4], atol=2e-4)


def test_a_spatial_leg_may_be_worn():
    """Its second axis is out of the plane of the first."""
    first, rest = random_chain(np.random.default_rng(2), 2).text.split("<axis", 1)
    tilted = re.sub(r'xyz="[^"]*"', 'xyz="0.36 0.48 0.8"', rest, count=1)
    leg = exoid.Leg.from_description(describe(f"{first}<axis{tilted}", "tilted"), joints=("hip", "knee"))
    assert leg.chain is None
    plant, start = Plant.build(leg, end_stops=False), Hold(np.full((2, 1), 0.3))
    wearer = Wearer(leg.with_parameters(0.5 * leg.parameters), 500.0, 10.0, intention=start)
    run = worn(plant, wearer, 0.5, reference=start)
    truth = coupled_by_pinocchio(plant, wearer, start.at(0.0), run.time)
    np.testing.assert_allclose(run.q[..., 0], truth[:, :2], atol=1e-4)


def test_no_cuff_no_interaction():
    """Not a bit of the leg's motion changes."""
    loose = Wearer.build(CUHK, cuff_stiffness=0.0, cuff_damping=0.0)
    run = worn(STICKING, loose, controller=PD)
    alone = simulate(STICKING, GAIT, PD, IdealTorque(), 1.0, rates=FINE)
    assert not run.interaction.any()
    np.testing.assert_array_equal(run.q, alone.q)
    np.testing.assert_array_equal(run.tau_measured, alone.tau_measured)
    assert alone.interaction is None
    assert alone.limb_q is None


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("actuator", [IdealTorque(), HydraulicServo(5000.0, 0.01, 10.0)])
def test_no_energy_comes_from_nowhere(kind, actuator):
    """Leg, limb, cuffs and muscles, with sticking joints: as good as the rig alone."""
    drive = PD if isinstance(actuator, IdealTorque) else ProportionalDerivative(1.0)
    run = worn(STICKING, WEARERS[kind], 3.0, controller=drive, actuator=actuator, rates=Rates(500.0, 50.0, 5e-4))
    assert run.energy.relative_error[0] < 1e-5
    assert run.energy.dissipated[0] > 1.0


def test_joints_stick_stop_and_reverse_under_a_wearer():
    """One rig and two agree where the leg sticks and meets its end stops."""
    plant = Plant.build(BLEEX, EVERYTHING)
    wearer, push = Wearer.build(BLEEX), np.array([[40.0], [20.0], [3.0]])
    rigs = [
        WornStepper(Stepper(plant.repeat(b), np.tile(POSE, b), np.zeros((3, b)), 5e-4), wearer, 3000) for b in (1, 2)
    ]
    rested = stopped = 0
    for k in range(3000):
        for rig in rigs:
            rig.step(push * np.sin(5e-3 * k), np.full(rig.q.shape, 0.05))
        np.testing.assert_allclose(rigs[1].q, np.tile(rigs[0].q, 2), rtol=0, atol=1e-9)
        np.testing.assert_allclose(rigs[1].limb.q, np.tile(rigs[0].limb.q, 2), rtol=0, atol=1e-9)
        rested += (rigs[0].v == 0.0).sum()
        stopped += (rigs[0].q >= plant.upper).sum() + (rigs[0].q <= plant.lower).sum()
    assert rested > 20
    assert stopped > 20


def test_the_torque_of_the_wearer_arrives_as_late_as_all_readings():
    late, rates = Feel(), Rates(100.0, 100.0, 5e-4)
    run = worn(controller=late, rates=rates, sensors=Sensors(np.inf, delay=3))
    np.testing.assert_array_equal(np.array(late.felt)[3:], run.interaction[:-3])


def test_the_limb_is_that_of_winters_table():
    """Without an ankle the foot is at the end of the shank; with one, it lies ahead of the ankle and below."""
    thigh, shank = 0.245 * 1.70, 0.246 * 1.70
    bodies = [
        exoid.Payload("hip", 6.5, (0.0, 0.0, -0.433 * thigh), 0.323 * thigh),
        exoid.Payload("knee", 3.0225, (0.0, 0.0, -0.433 * shank), 0.302 * shank),
        exoid.Payload("knee", 0.9425, (0.0, 0.0, -shank)),
    ]
    np.testing.assert_allclose(limb_of(CUHK, 1.70, 65.0).parameters, payload_parameters(CUHK, bodies), atol=1e-12)
    X, Y, J = limb_of(BLEEX, 1.80, 80.0).parameters.reshape(3, 3).T
    foot = 0.0145 * 80.0
    assert foot * 0.055 * 1.80 == pytest.approx(np.hypot(X[2], Y[2]), rel=0.1)
    assert Y[2] == pytest.approx(foot * 0.055 * 1.80) or -Y[2] == pytest.approx(foot * 0.055 * 1.80)
    assert J[2] == pytest.approx(foot * ((0.475 * 0.11 * 1.8) ** 2 + (0.055 * 1.8) ** 2 + (0.0195 * 1.8) ** 2))
    assert J[0] > J[1] > J[2]


def test_an_intention_without_acceleration_needs_muscles_without_feedforward():
    class Line:
        def at(self, time):
            return Target(np.full((2, 1), 0.2 + 0.1 * time), np.full((2, 1), 0.1))

    with pytest.raises(ExoidError, match="acceleration"):
        worn(FREE, Wearer.build(CUHK, intention=Line()))
    run = worn(FREE, Wearer.build(CUHK, intention=Line(), feedforward=False), reference=Line())
    assert np.abs(run.limb_q[-1] - run.limb_q[0]).max() > 0.02
