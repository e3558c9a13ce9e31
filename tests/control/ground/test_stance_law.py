"""The whole-body law on the ground: its equations, its optimum, its limits, and what it refuses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from made_estimates import made

import exoid
from exoid.control.functions import Body, joint_angles, minimum_jerk, rise
from exoid.control.ground import GroundState, GroundTarget, stance
from exoid.control.ground.qp import Rows, minimise, require_daqp
from exoid.errors import BadArgumentError, NotIdentifiableError, NotSupportedError
from exoid.experiments import ground
from exoid.leg.description import describe
from exoid.leg.floating_base import free_flyer_model
from exoid.leg.link_frames import link_frame
from exoid.leg.torso import TorsoMotion
from exoid.rig.ground.plant import BLEEX_SOLES, SEAT
from exoid.torques import TorqueModel

BOTH = {"left_foot": "flat", "right_foot": "flat"}
BENT = np.array([0.2, -0.75, 0.55])
"""Angles of a leg that stands, with the centre of mass over its foot [rad]."""


def state_of(seed: int, contacts=BOTH, **other) -> GroundState:
    rng = np.random.default_rng(seed)
    q = np.concatenate([BENT, BENT]) + 0.05 * rng.standard_normal(6)
    return GroundState(q, 0.5 * rng.standard_normal(6), 0.1, 0.2, contacts, **other)


def target_of(state: GroundState, seed: int = 0) -> GroundTarget:
    rng = np.random.default_rng(seed)
    return GroundTarget(state.q + 0.01 * rng.standard_normal(6), state.v, 0.3 * rng.standard_normal(6), 0.1, 0.2)


def test_a_seat_that_is_left_bears_what_it_must_and_both_legs_bear_alike(exo):
    """The centre of mass is behind the heels: no forces within cones hold a seated machine on its feet alone."""
    soles = {**BLEEX_SOLES, "torso": SEAT}
    law, seated = stance(exo, soles), rise(Body.of(exo, soles))
    q = joint_angles(exo, seated.flexion[:1])[0]
    loads = []
    for share in (1.0, 0.3, 0.2, 0.06, 0.03, 0.01, 0.0):
        shares = {"left_foot": 1.0, "right_foot": 1.0, "torso": share}
        state = GroundState(q, np.zeros(6), seated.torso[0, 2], 0.0, dict.fromkeys(shares, "flat"), shares)
        command = law.command(state, GroundTarget(q, np.zeros(6), pitch=seated.torso[0, 2]))
        left, right, seat = command.forces.values()
        assert command.feasible
        np.testing.assert_allclose(left, right, rtol=0, atol=0.1)
        assert all(abs(force[0]) <= 0.6 * force[1] + 0.1 for force in (left, right, seat))
        loads.append(seat[1])
    assert (np.diff(loads) < 1e-3).all()
    assert loads[-1] == pytest.approx(0.0, abs=1e-6)


def test_errors_of_the_posture_do_not_unload_a_foot_that_bears(exo):
    """They would put all the load on one foot: the other could no longer be felt, and would leave the ground."""
    law = stance(exo)
    for seed in range(8):
        state = state_of(seed, {"left_foot": "flat", "right_foot": "toe"})
        wanted = 5.0 * (target_of(state, seed).q - state.q) + state.q
        command = law.command(state, GroundTarget(wanted, state.v, pitch=0.1, pitch_rate=0.2))
        assert command.feasible
        assert min(force[1] for force in command.forces.values()) > 0.0999 * law.weight


@pytest.mark.parametrize("contacts", [BOTH, {"left_foot": "flat"}, {"left_foot": "flat", "right_foot": "toe"}])
def test_the_command_fulfils_the_equation_of_motion(exo, contacts):
    """M dν + h = (0, τ) + Σ Jᵀ f by the leg's own inverse dynamics and Jacobians, and a flat sole does not move."""
    law = stance(exo, friction=None)
    state = state_of(1, contacts)
    command = law.command(state, target_of(state))
    dnu = command.acceleration
    turn = np.array([[np.cos(0.1), -np.sin(0.1)], [np.sin(0.1), np.cos(0.1)]])
    torso = TorsoMotion(np.array([0.1]), np.array([0.2]), dnu[2:3], (turn @ dnu[:2])[None])
    rows = exo.inverse_dynamics(state.q[None], state.v[None], dnu[None, 3:], torso)[0]
    rows[3:] -= command.torque
    for link, kind in contacts.items():
        sole = law.model.soles[link]
        if kind == "flat":
            J = exo.frame_jacobian(state.q[None], link, sole.centre)[0]
            rows -= J[[0, 2]].T @ command.forces[link][:2] - J[4] * command.forces[link][2]
        else:
            J = exo.frame_jacobian(state.q[None], link, sole.points[1])[0][[0, 2]]
            tilt = 0.1 + state.q[3:].sum()
            back = np.array([[np.cos(tilt), np.sin(tilt)], [-np.sin(tilt), np.cos(tilt)]])
            rows -= J.T @ back @ command.forces[link]
    assert np.abs(rows).max() < 1e-8


def test_the_motion_is_that_of_pinocchios_constrained_dynamics(exo):
    """Under the torque of the law both feet welded to the ground give the accelerations that the law expects."""
    law = stance(exo, friction=None)
    state = state_of(2)
    J = np.concatenate([exo.contact_jacobian(state.q[None], link)[0] for link in BOTH])
    nu = np.linalg.svd(J)[2][6:].T @ np.array([0.3, -0.2, 0.4])  # a motion in which the feet rest
    state = state._replace(v=nu[3:], pitch_rate=nu[2])
    command = law.command(state, target_of(state))
    assert command.feasible
    free, spin = free_flyer_model(exo.model), -exo.plane.lateral
    q = np.concatenate([np.zeros(3), pin.Quaternion(pin.exp3(0.1 * spin)).coeffs(), state.q])
    v = np.concatenate([[nu[0], 0.0, nu[1]], nu[2] * spin, state.v])
    contacts, kept, data = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData(), free.createData()
    pin.forwardKinematics(free, data, q)
    for link in BOTH:
        body, place = link_frame(exo.model, exo.description, link)
        kind, ground = pin.ContactType.CONTACT_6D, data.oMi[body + 2] * place
        contacts.append(pin.RigidConstraintModel(kind, free, body + 2, place, 0, ground, pin.ReferenceFrame.LOCAL))
        kept.append(contacts[-1].createData())
    pin.initConstraintDynamics(free, data, contacts, kept)
    tau = np.concatenate([np.zeros(6), command.torque])
    a = pin.constraintDynamics(free, data, q, v, tau, contacts, kept, pin.ProximalSettings(1e-14, 1e-10, 100))
    assert np.allclose(a[6:], command.acceleration[3:], atol=1e-6)
    assert np.isclose(a[3:6] @ spin, command.acceleration[2], atol=1e-6)


def test_without_active_limits_the_law_is_the_weighted_least_squares(exo):
    """With one foot flat and wide limits all tasks have a least-squares solution by the null space of the contact."""
    law = stance(exo, friction=None, ground_friction=1e3, limit=1e6)
    state = state_of(3, {"left_foot": "flat"})
    law = replace(law, margin=-10.0)
    target = target_of(state)
    command = law.command(state, target)
    M, _ = law.model.dynamics(state.q, state.v, 0.1, 0.2)
    rows = law.model.contact("left_foot", "flat", (state.q, state.v, 0.1, 0.2), (1.0, 0.0, 0.0))
    error = np.append(target.q - state.q, target.pitch - state.pitch)
    rate = np.append(target.v - state.v, target.pitch_rate - state.pitch_rate)
    asked = np.append(target.a, target.pitch_acceleration) + law.kp * error + law.kd * rate
    wanted = np.concatenate([np.zeros(2), asked[[6]], asked[:6]])
    size = np.array([1e-3, 1e-3, 1.0, *np.ones(6)])
    KKT = np.block([[np.diag(size**2), rows.J.T], [rows.J, np.zeros((3, 3))]])
    best = np.linalg.solve(KKT, np.concatenate([size**2 * wanted, -rows.drift]))[:9]
    assert np.allclose(best, command.acceleration, atol=1e-3)  # apart from the weight of the effort
    assert M.shape == (9, 9)


def test_rows_that_contradict_each_other_yield_as_in_the_solver_itself():
    rng, sense = np.random.default_rng(0), np.repeat(np.array([0, 8], dtype=np.intc), 4)  # DAQP's hard and soft
    for _ in range(20):
        A, b, rows = rng.normal(size=(9, 4)), rng.normal(size=9), rng.normal(size=(3, 4))
        hard = Rows(np.eye(4), -np.ones(4), np.ones(4))
        soft = Rows(
            np.vstack([rows, rows[:1]]), np.append(np.full(3, -np.inf), 0.5), np.append(np.full(3, 0.2), np.inf)
        )
        all_rows, lower, upper = (np.concatenate(each) for each in zip(hard, soft, strict=True))
        expected = require_daqp().solve(A.T @ A, -A.T @ b, all_rows, upper, lower, sense)[0]
        np.testing.assert_allclose(minimise(A, b, [hard, soft])[0], expected, atol=1e-9)


def test_forces_stay_in_cone_and_sole_and_torque_within_limits(exo):
    """Whatever is asked for; where nothing is feasible the limits of torque hold and the law says so."""
    law = stance(exo, limit=60.0, power=100.0, ground_friction=0.3)
    seen = []
    for seed in range(40):
        state = state_of(seed, BOTH if seed % 2 else {"left_foot": "flat"})
        target = target_of(state, seed)._replace(a=8.0 * np.random.default_rng(seed).standard_normal(6))
        command = law.command(state, target)
        seen.append(command.feasible)
        assert (np.abs(command.torque) <= 60.0 + 1e-9).all()
        assert (np.abs(command.torque * state.v) <= 100.0 + 1e-9).all()
        if command.feasible:
            for force in command.forces.values():
                reach = 0.1025 - law.margin
                assert abs(force[0]) <= 0.3 * force[1] + 1e-2
                assert abs(force[2]) <= reach * force[1] + 1e-2
    assert sum(seen) > 10


def test_weight_is_borne_by_the_shares_and_torque_is_continuous_in_them(exo):
    law, q, torques, loads = stance(exo, friction=None), np.concatenate([BENT, BENT]), [], []
    for s in np.linspace(0.0, 1.0, 101):
        shares = {"left_foot": 1.0, "right_foot": 1.0 - float(minimum_jerk(s))}
        command = law.command(GroundState(q, 0.0 * q, 0.0, 0.0, BOTH, shares), GroundTarget(q, 0.0 * q))
        torques.append(command.torque)
        loads.append(command.forces["right_foot"][1])
    assert loads[0] == pytest.approx(49.1 * 9.81 / 2, rel=0.01)
    assert abs(loads[-1]) < 1e-3
    assert np.abs(np.diff(torques, axis=0)).max() < 0.02 * np.ptp(torques, axis=0).max() + 1.0


def test_known_forces_are_taken_into_account(exo):
    """A crutch that carries 100 N takes them from the feet; the wearer's torque takes its part from the actuators."""
    law = stance(exo, kp=0.0, kd=0.0, friction=None)
    q = np.concatenate([BENT, BENT])
    state, target = GroundState(q, np.zeros(6), 0.0, 0.0, BOTH), GroundTarget(q, np.zeros(6))
    alone = law.command(state, target)
    helped = law.command(state._replace(push=np.array([0.0, 100.0, 0.0])), target)
    assert sum(f[1] for f in alone.forces.values()) - sum(f[1] for f in helped.forces.values()) == pytest.approx(
        100.0, abs=2.0
    )
    wearer = np.array([3.0, 2.0, 1.0, 3.0, 2.0, 1.0])
    assert np.allclose(law.command(state._replace(interaction=wearer), target).torque, alone.torque - wearer, atol=1e-6)


def test_a_contact_without_a_share_leaves_without_a_step(exo):
    """Also where the leg is off its reference and moves, so that its constraint changes the accelerations."""
    law, state = stance(exo), state_of(4)
    target = target_of(state)._replace(q=state.q + 0.05)
    last = None
    for share in (0.06, 0.05, 0.045, 0.04, 0.03, 0.02, 0.01, 0.003, 1e-6, 0.0, None):
        shares = {} if share is None else {"right_foot": share}
        contacts = {"left_foot": "flat"} if share is None else BOTH
        torque = law.command(state._replace(contacts=contacts, shares=shares), target).torque
        if last is not None:
            assert np.abs(torque - last).max() < (1e-6 if share is None else 16.0)
        last = torque


def test_friction_compensation_never_drives():
    """It has the sign of the velocity and is at most the model's friction."""
    truth = ground.bleex_machine()
    state = state_of(5)
    target = target_of(state)
    added = stance(truth).command(state, target).torque - stance(truth, friction=None).command(state, target).torque
    friction = truth.friction(state.v[None])[0]
    assert (added * state.v >= 0.0).all()
    assert (np.abs(added) <= np.abs(friction)).all()
    assert np.abs(added).max() > 0.1


def estimate_of(machine, relative: float, mass: float = 0.0):
    """An estimate with the true values, and parameters that are independent."""
    model = TorqueModel(machine, (exoid.Viscous(),))
    values = np.append(machine.parameters, 0.3 * np.ones(len(model.names) - len(machine.parameters)))
    std = relative * np.abs(values)
    std[0] += mass
    return made(model, values, np.diag(std**2))


def test_the_band_is_the_spread_of_the_torques_of_drawn_estimates(exo):
    """The torque is linear in the parameters while no limit is active."""
    estimate = estimate_of(exo, 0.02)
    state = state_of(6)
    target = target_of(state)

    def law(values):
        made_of = stance(replace(estimate, values=values), ground_friction=5.0, friction=None)
        return replace(made_of, margin=-10.0)

    band = law(estimate.values).band(state, target)
    draws = np.random.default_rng(0).multivariate_normal(estimate.values, estimate.covariance, 80)
    torques = np.array([law(values).command(state, target).torque for values in draws])
    np.testing.assert_allclose(torques.std(axis=0), band, rtol=0.25)
    assert stance(exo).band(state, target).max() == 0.0


def test_an_uncertain_weight_is_refused_and_a_less_certain_model_keeps_further_from_the_edges(exo):
    """Without the total mass there is no support; the margin of the pressure has two standard deviations."""
    known = estimate_of(exo, 0.01)
    for unknown in (estimate_of(exo, 0.01, mass=20.0), replace(known, values=-known.values)):
        with pytest.raises(NotIdentifiableError) as refused:
            stance(unknown)
        assert refused.value.parameters == ("M",)
    margins = [stance(estimate_of(exo, size)).margin for size in (0.0, 0.01, 0.03)]
    assert margins[0] == pytest.approx(0.01)
    assert margins[0] < margins[1] < margins[2]


def test_what_the_law_refuses(exo):
    """A held base, no contact, unknown links, missing numbers."""
    with pytest.raises(NotSupportedError, match="floats"):
        stance(exoid.load_exo("bleex"))
    law, state = stance(exo), state_of(0)
    target, missing = target_of(state), np.full(6, np.nan)
    wrong = [{"contacts": contacts} for contacts in ({}, {"torso": "flat"}, {"left_foot": "ball"})]
    wrong += [{"shares": shares} for shares in ({"left_foot": -1.0}, dict.fromkeys(BOTH, 0.0), {"left": 1.0})]
    wrong += [{"pitch": x} for x in (np.nan, 9.0)] + [{"interaction": missing}, {"push": missing[:3]}, {"lean": np.nan}]
    wrong += [{"q": q} for q in (state.q[:3], np.rad2deg(state.q))]
    cases = [(state._replace(**each), target) for each in wrong]
    cases += [(state, target._replace(**{name: missing})) for name in "qva"] + [(state, target._replace(q=state.q[:1]))]
    for case in cases:
        with pytest.raises(BadArgumentError):
            law.command(*case)
    with pytest.raises(BadArgumentError):
        stance(exo, kp=(1.0, 2.0))
    with pytest.raises(BadArgumentError, match="soles"):
        stance(exo, soles={})
    shorter = describe(exo.description.text.replace("-0.43", "-0.4"), "bleex_of_mine.urdf")
    with pytest.raises(BadArgumentError, match="soles"):
        stance(exoid.Leg.from_description(shorter, base="floating"))
