"""Legs of Denavit-Hartenberg tables equal kinematics that are written out here, and Pinocchio's regressor."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import exoid
from exoid import Leg
from exoid.leg.dh import DHRow

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
def test_energy_of_masses_in_dh_frames_gives_the_torque(convention):
    """M and G follow from the kinetic and potential energy of unit masses, by differences of the textbook's frames."""
    rng = np.random.default_rng(4)
    leg = Leg.from_dh(STANFORD_LIKE, convention)

    def mass_and_weight(q, step=1e-6):
        place = frames(q, convention)
        M, G = np.zeros((4, 4)), np.zeros(4)
        slopes = np.array(
            [(frames(q + e, convention) - frames(q - e, convention)) / (2 * step) for e in step * np.eye(4)]
        )
        for k in range(4):
            Jv = np.column_stack([slope[k, :3, 3] for slope in slopes])
            spin = [place[k, :3, :3].T @ slope[k, :3, :3] for slope in slopes]
            Jw = np.column_stack([(S[2, 1], S[0, 2], S[1, 0]) for S in spin])
            M += Jv.T @ Jv + 0.01 * Jw.T @ Jw
            G += 9.81 * Jv[2]
        return M, G

    for q in rng.uniform(-2.0, 2.0, (5, 4)):
        M, G = mass_and_weight(q)
        np.testing.assert_allclose(leg.mass_matrix(q)[0], M, rtol=1e-6, atol=1e-7)
        np.testing.assert_allclose(leg.gravity(q)[0], G, rtol=1e-6, atol=1e-7)


def test_a_planar_table_has_the_parameters_of_a_planar_leg():
    leg = Leg.from_dh([(0.45, 0.0, 0.0), (0.4, 0.0, 0.0)], "standard", ("hip", "knee"), base_rpy=(np.pi / 2, 0.0, 0.0))
    assert leg.parameter_names == ("X1", "Y1", "J1", "X2", "Y2", "J2")
    q, v, a = np.random.default_rng(6).standard_normal((3, 20, 2))
    np.testing.assert_allclose(leg.regressor(q, v, a) @ leg.parameters, leg.inverse_dynamics(q, v, a), atol=1e-12)
