"""Feet that rest on a point or an edge: Pinocchio's constrained dynamics obey the rows that are left of them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from free_flyers import Flight
from public_robots import urdf_of
from scipy.linalg import null_space
from swings import harmonics

import exoid
from exoid.errors import BadArgumentError, NotIdentifiableError, UnreadableInputError
from exoid.estimate import ground_forces
from exoid.experiments.excitation import MotionLimits, assess
from exoid.leg.base_kinematics import BaseKinematics
from exoid.leg.link_frames import ball_radius
from exoid.torques.contacts import level_rotation
from exoid.torques.contacts.support_model import SupportModel
from exoid.torques.model import TorqueModel

pytestmark = pytest.mark.slow

FEET = ("LF_FOOT", "RF_FOOT", "LH_FOOT", "RH_FOOT")


@cache
def quadruped(kind="point"):
    return exoid.Leg.from_urdf(urdf_of("anymal"), base="floating", contacts=dict.fromkeys(FEET, kind))


def constrained(leg, feet, rng, samples=30):
    """Random states and torques, the acceleration of Pinocchio's constrained dynamics, and the forces on the feet."""
    flight = Flight.random(leg, rng, samples)
    model, n = flight.model, len(leg.joint_names)
    data = model.createData()
    torque = rng.normal(size=(samples, n)) * 20.0
    a, forces = np.empty_like(flight.v), np.empty((samples, len(feet), 3))
    settings = pin.ProximalSettings(1e-14, 1e-14, 0.0, 200)
    for k, q in enumerate(flight.q):
        pin.framesForwardKinematics(model, data, q)
        constraints, inside = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for foot in feet:
            frame = model.getFrameId(foot)
            lowest = -ball_radius(leg, foot) * data.oMf[frame].rotation[2]  # from the middle of a ball
            place = model.frames[frame].placement * pin.SE3(np.eye(3), lowest)
            joint, axes = model.frames[frame].parentJoint, pin.ReferenceFrame.LOCAL
            constraints.append(pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, joint, place, axes))
            inside.append(constraints[-1].createData())
        pin.initConstraintDynamics(model, data, constraints, inside)
        tau = np.concatenate([np.zeros(6), torque[k]])
        a[k] = pin.constraintDynamics(model, data, q, flight.v[k], tau, constraints, inside, settings)
        forces[k] = [each.contact_force.linear for each in inside]
    return Flight(model, flight.q, flight.v, a), torque, forces


@pytest.mark.parametrize(("feet", "kind"), [(FEET[:1], "point"), (FEET[1:3], "point"), (FEET[:3], 0.05), (FEET, 0.03)])
def test_pinocchios_constrained_dynamics_obey_the_rows_without_contact_forces(feet, kind):
    leg = quadruped(kind)
    flight, torque, forces = constrained(leg, feet, np.random.default_rng(len(feet)))
    q, v, a = flight.joints
    model = SupportModel.of(TorqueModel(leg, ()), feet, q)
    motion = model.motion(q, v, a, flight.base)
    W = model.columns(motion).transpose(2, 1, 0)
    left = model.row_torque(torque, motion, {})
    assert W.shape[1] == 6 + 12 - 3 * len(feet)
    assert np.abs(W @ leg.parameters - left).max() < 1e-9 * np.abs(forces).max()


def test_an_edge_turns_about_itself_alone():
    q = np.random.default_rng(0).uniform(-1.0, 1.0, (5, 12))
    flat, edge = (quadruped(kind).contact_jacobian(q, FEET[0]) for kind in ("flat", "edge"))
    assert edge.shape == (5, 5, 18)
    # of six directions that a sole holds, an edge holds five: the sixth is a turn about the line, which lies across
    free = np.array([null_space(held @ np.linalg.pinv(whole))[:, 0] for held, whole in zip(edge, flat, strict=True)])
    turn = level_rotation(quadruped(), FEET[0])
    expected = np.concatenate([np.zeros(3), turn.T @ [0.0, 1.0, 0.0]])
    np.testing.assert_allclose(np.abs(free @ expected), 1.0, rtol=1e-9)


def trajectory(rng, time, size, slowest=0.15):
    """Sums of sines, one column for each size, with their first and second derivative."""
    rates = 2.0 * np.pi * slowest * (1.0 + np.arange(6))
    phases = rng.uniform(0.0, 2.0 * np.pi, (len(size), 6))
    return harmonics(time, np.asarray(size)[:, None] / (1.0 + np.arange(6)), rates, phases)


def walk(leg, seconds, rng, noise=0.0, rate=200.0):
    """A log on four feet, then on three with each foot up in turn, whose forces balance the base, and these forces."""
    time = np.arange(0.0, seconds, 1.0 / rate)
    q, v, a = trajectory(rng, time, [0.4] * 12)
    q += [0.0, 0.6, -1.2, 0.0, -0.6, 1.2] * 2  # knees bent, forwards in front
    _, omega, alpha = trajectory(rng, time, [0.2] * 3)
    push = trajectory(rng, time, [1.5, 1.5, 2.0])[0] + [0.0, 0.0, 9.81]
    rows = leg.inverse_dynamics(q, v, a, BaseKinematics(omega, alpha, push))
    turn = np.floor(time / seconds * 5.0).astype(int)
    contacts = {foot: turn != k + 1 for k, foot in enumerate(FEET)}
    J = np.concatenate([leg.contact_jacobian(q, foot) * contacts[foot][:, None, None] for foot in FEET], axis=1)
    balance = np.linalg.pinv(np.swapaxes(J[..., :6], 1, 2), rcond=1e-9)
    shared = trajectory(rng, time, [20.0] * 12)[0]
    loose = shared - np.einsum("nij,njk,nk->ni", balance, np.swapaxes(J[..., :6], 1, 2), shared)
    forces = (np.einsum("nij,nj->ni", balance, rows[:, :6]) + loose) * np.repeat(
        np.column_stack([*contacts.values()]), 3, 1
    )
    tau = rows[:, 6:] - np.einsum("nij,ni->nj", J[..., 6:], forces)
    tau += noise * tau.std(axis=0) * rng.standard_normal(tau.shape)
    base = exoid.BaseMotion.from_imu(omega, push)
    log = exoid.Recording(time, q, tau=tau, joint_names=leg.joint_names, base=base, contacts=contacts)
    return log, forces.reshape(-1, 4, 3)


@pytest.fixture(scope="module")
def walked():
    leg, rng = quadruped(), np.random.default_rng(1000)
    logs = [walk(leg, 12.0, rng, noise=0.01, rate=100.0)[0] for _ in range(2)]
    return exoid.identify(leg, logs, terms=(), check=False)


@pytest.mark.nightly
def test_a_quadruped_is_identified_from_point_feet_without_their_forces(walked):
    truth = quadruped().parameters
    error = np.abs(walked.values - truth)
    assert abs(walked.values[0] / truth[0] - 1.0) < 0.01
    assert np.mean(error < 1.96 * walked.std) > 0.9
    log, forces = walk(quadruped(), 10.0, np.random.default_rng(1001), rate=100.0)
    found = ground_forces(walked, log)
    for k, foot in enumerate(FEET):
        one = found[foot]
        at = np.searchsorted(log.time, one.time)
        assert len(at) > 500
        assert np.mean(np.abs(one.force - forces[at, k]) < one.force_half) > 0.9
        np.testing.assert_allclose(one.moment, 0.0, atol=1e-9)


def beside(estimate):
    """Distances by which forces pass before feet [m]."""
    return [each.value for each in estimate.findings if each.kind == "contact-kind"]


@pytest.mark.nightly
def test_feet_that_rest_behind_their_points_are_named():
    model = quadruped().model.copy()
    for foot in FEET:
        frame = model.frames[model.getFrameId(foot)]
        frame.placement = frame.placement * pin.SE3(np.eye(3), np.array([0.005, 0.0, 0.0]))
    log, _ = walk(quadruped(), 10.0, np.random.default_rng(0), noise=0.01)
    found = beside(exoid.identify(replace(quadruped(), model=model), log, terms=()))
    assert len(found) == 4
    assert max(found) < -0.002  # other parameters take a part
    assert not beside(exoid.identify(quadruped(), log, terms=()))


@pytest.mark.nightly
def test_what_a_log_on_point_feet_determines_is_predicted():
    """Without noise but that of the torques, as the prediction assumes; four feet at rest leave parameters open."""
    leg = quadruped()
    log, _ = walk(leg, 20.0, np.random.default_rng(1002), noise=0.01)
    std = 0.01 * log.tau.std(axis=0)
    limits = MotionLimits.of(leg, angles_deg=dict.fromkeys(leg.joint_names, (-90.0, 90.0)))  # the URDF has none
    said = assess(leg, log, (), noise=std, limits=limits).precision
    assert said.duration == pytest.approx(20.0, rel=0.2)  # less what is left out beside changes
    estimate = exoid.identify(leg, log, terms=(), check=False)
    assert np.median(said.std / estimate.std) == pytest.approx(1.0, abs=0.25)
    down = dict.fromkeys(FEET, np.ones(len(log), dtype=bool))
    always = assess(leg, replace(log, contacts=down), (), noise=std, limits=limits)
    with pytest.raises(NotIdentifiableError) as refused:
        exoid.identify(leg, replace(log, contacts=down), terms=(), check=False)
    grades = zip(leg.parameter_names, always.precision.identifiability, strict=True)
    loose = {name for name, grade in grades if grade == "not"}
    print(f"four feet at rest leave {len(loose)} of {len(leg.parameter_names)} parameters open")
    assert len(loose) > 15
    assert len(loose ^ {*refused.value.parameters}) <= 3  # some are hardly part of what is open
    assert always.advice == ()


def test_feet_on_points_do_not_say_how_the_base_moves():
    log, _ = walk(quadruped(), 10.0, np.random.default_rng(0))
    one = {FEET[0]: np.ones(len(log), dtype=bool)}
    with pytest.raises(UnreadableInputError, match="base_gyro"):
        exoid.identify(quadruped(), replace(log, base=None, contacts=one), terms=())


@pytest.mark.parametrize("contacts", [{"LF_PAW": "point"}, {"LF_FOOT": "ball"}, {"LF_FOOT": 20.0}])
def test_contacts_of_no_link_or_no_kind_are_refused(contacts):
    with pytest.raises(BadArgumentError) as refused:
        exoid.Leg.from_urdf(urdf_of("anymal"), base="floating", contacts=contacts)
    assert next(iter(contacts)) in str(refused.value)
