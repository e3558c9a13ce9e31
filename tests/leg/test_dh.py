"""Legs of Denavit-Hartenberg tables equal kinematics that are written out here, and Pinocchio's regressor."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import exoid
from exoid import Leg
from exoid.leg.dh import DHBody, DHRow

STANFORD_LIKE = [
    DHRow(0.1, np.pi / 2, 0.35, np.pi / 2),
    DHRow(0.42, 0.0, -0.05, -0.3),
    DHRow(0.0, -np.pi / 2, 0.12, np.pi / 2),
    DHRow(-0.03, 0.7, 0.4),
]
"""Four joints, among them pairs of α and offset whose product would be singular as roll, pitch and yaw."""


def matrix(row, theta, convention):
    """The textbook's matrices, element by element."""
    a, alpha, d, _ = row
    ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    if convention == "standard":  # Spong, Robot Modeling and Control, eq. (3.10)
        return np.array(
            [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, d], [0, 0, 0, 1]]
        )
    return np.array(  # Craig, Introduction to Robotics, eq. (3.6)
        [[ct, -st, 0, a], [st * ca, ct * ca, -sa, -sa * d], [st * sa, ct * sa, ca, ca * d], [0, 0, 0, 1]]
    )


def frames(q, convention, rpy=(0.0, 0.0, 0.0)):
    """Placement of each frame, (n, 4, 4)."""
    T = np.eye(4)
    T[:3, :3] = pin.rpy.rpyToMatrix(*rpy)
    found = []
    for row, angle in zip(STANFORD_LIKE, q, strict=True):
        T = T @ matrix(row, angle + row.offset, convention)
        found.append(T)
    return np.array(found)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_frames_are_where_the_textbook_puts_them(convention):
    rng = np.random.default_rng(3)
    rpy = (0.4, -0.2, 1.1)
    leg = Leg.from_dh(STANFORD_LIKE, convention, base_rpy=rpy)
    data = leg.model.createData()
    for q in rng.uniform(-3.0, 3.0, (20, 4)):
        expected = frames(q, convention, rpy)
        pin.framesForwardKinematics(leg.model, data, exoid.leg.model.configuration(leg.model, q[None])[0])
        for k, T in enumerate(expected, start=1):
            found = data.oMf[leg.model.getFrameId(f"frame{k}")].homogeneous
            np.testing.assert_allclose(found, T, atol=1e-14)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_energy_of_bodies_in_dh_frames_gives_the_torque(convention):
    """M and G follow from the kinetic and potential energy, by differences of the textbook's frames."""
    rng = np.random.default_rng(4)
    bodies = []
    for _ in STANFORD_LIKE:
        A = rng.standard_normal((3, 3))
        bodies.append(DHBody(rng.uniform(1, 3), tuple(rng.uniform(-0.2, 0.2, 3)), 0.02 * (A @ A.T + 3 * np.eye(3))))
    leg = Leg.from_dh(STANFORD_LIKE, convention, bodies=bodies)

    def mass_and_weight(q, step=1e-6):
        place = frames(q, convention)
        M, G = np.zeros((4, 4)), np.zeros(4)
        slopes = np.array(
            [(frames(q + e, convention) - frames(q - e, convention)) / (2 * step) for e in step * np.eye(4)]
        )
        for k, body in enumerate(bodies):
            Jv = np.column_stack([(slope[k] @ [*body.center, 1.0])[:3] for slope in slopes])
            spin = [place[k, :3, :3].T @ slope[k, :3, :3] for slope in slopes]
            Jw = np.column_stack([(S[2, 1], S[0, 2], S[1, 0]) for S in spin])
            M += body.mass * Jv.T @ Jv + Jw.T @ body.inertia @ Jw
            G += body.mass * 9.81 * Jv[2]
        return M, G

    for q in rng.uniform(-2.0, 2.0, (5, 4)):
        M, G = mass_and_weight(q)
        np.testing.assert_allclose(leg.mass_matrix(q)[0], M, rtol=1e-6, atol=1e-7)
        np.testing.assert_allclose(leg.gravity(q)[0], G, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_parameters_times_regressor_are_pinocchios_torque(convention):
    leg = Leg.from_dh(STANFORD_LIKE, convention)
    q, v, a = np.random.default_rng(5).standard_normal((3, 50, 4))
    expected = np.array(
        [
            pin.computeJointTorqueRegressor(
                leg.model, leg.model.createData(), exoid.leg.model.configuration(leg.model, x[None])[0], y, z
            )
            @ exoid.leg.model.dynamic_parameters(leg.model)
            for x, y, z in zip(q, v, a, strict=True)
        ]
    )
    np.testing.assert_allclose(leg.regressor(q, v, a) @ leg.parameters, expected, rtol=1e-11, atol=1e-11)


def test_a_planar_table_has_the_parameters_of_a_planar_leg():
    leg = Leg.from_dh([(0.45, 0.0, 0.0), (0.4, 0.0, 0.0)], "standard", ("hip", "knee"), base_rpy=(np.pi / 2, 0.0, 0.0))
    assert leg.parameter_names == ("X1", "Y1", "J1", "X2", "Y2", "J2")
    q, v, a = np.random.default_rng(6).standard_normal((3, 20, 2))
    np.testing.assert_allclose(leg.regressor(q, v, a) @ leg.parameters, leg.inverse_dynamics(q, v, a), atol=1e-12)


def test_a_recording_of_a_table_identifies_its_parameters():
    leg = Leg.from_dh([(0.45, 0.0, 0.0), (0.4, 0.0, 0.0)], "standard", ("hip", "knee"), base_rpy=(np.pi / 2, 0.0, 0.0))
    t = np.arange(2000) / 100.0
    amplitude, omega = np.array([[0.5, 0.2], [0.6, 0.2]]), np.array([[1.7, 4.1], [2.3, 5.0]])
    phase = t[:, None, None] * omega + np.array([[0.0, 0.0], [1.0, 0.0]])
    q = (amplitude * np.sin(phase)).sum(-1)
    v = (amplitude * omega * np.cos(phase)).sum(-1)
    a = -(amplitude * omega**2 * np.sin(phase)).sum(-1)
    heavier = leg.with_parameters(1.3 * leg.parameters)
    recording = exoid.Recording(t, q, v, a, heavier.inverse_dynamics(q, v, a), joint_names=leg.joint_names)
    found = exoid.identify(leg, recording, (), check=False)
    np.testing.assert_allclose(found.values, heavier.parameters, rtol=1e-3, atol=1e-3)
