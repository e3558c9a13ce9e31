"""Columns of faults are derivatives of the torque; averaging a fast log changes no finding."""

import dataclasses

import numpy as np
import pytest
from logs import clean, of_kind
from public_robots import urdf_of
from swings import late

import exoid
from exoid.identification.findings.columns import Column, NuisanceColumns
from exoid.leg.dynamics import gravity_slopes, inverse_dynamics, inverse_dynamics_slopes
from exoid.torques import TorqueModel


@pytest.mark.parametrize("place", [0, 1, 2])
def test_slopes_are_finite_differences_of_inverse_dynamics(place):
    leg = exoid.Leg.from_urdf(urdf_of("hyq"), ("lf_haa_joint", "lf_hfe_joint", "lf_kfe_joint"))
    motion = np.random.default_rng(0).standard_normal((3, 5, 3))
    found = inverse_dynamics_slopes(leg.model, *motion)[place]
    for joint in range(3):
        step = 1e-5 * np.eye(9)[3 * place + joint].reshape(3, 1, 3)
        change = inverse_dynamics(leg.model, *(motion + step)) - inverse_dynamics(leg.model, *(motion - step))
        np.testing.assert_allclose(found[:, :, joint], change / 2e-5, atol=1e-8)
    gravity = np.tensordot(leg.model.gravity.linear, gravity_slopes(leg.model, motion[0]), axes=1)
    np.testing.assert_allclose(gravity, leg.gravity(motion[0]), atol=1e-12)


def test_torques_are_early_where_all_angles_are_late():
    """Those of rotors and friction, too: of a geared joint 1 ms of its rotor looked like 8 ms of its link."""
    leg, t = exoid.load_leg("bleex"), np.arange(0.0, 4.0, 0.01)[:, None]
    model, w = TorqueModel(leg, (exoid.Viscous(), exoid.Armature())), np.array([2.0, 3.0, 4.0])
    motion = model.motion(0.3 * np.sin(w * t), 0.3 * w * np.cos(w * t), -0.3 * w**2 * np.sin(w * t))
    values = np.append(leg.parameters, [3.0] * 3 + [2.0] * 2)
    columns, out = [*(Column("late angle", j) for j in range(3)), Column("delays", 0)], np.zeros((4, 3, len(t)))
    every = np.moveaxis(model.regressor(*motion[:3]), 0, -1).swapaxes(0, 1)
    NuisanceColumns(model, columns, values, 0.0 * leg.parameters, 100.0, *np.ones((2, 3))).fill(motion, every, out)
    late, early = (x[:, 20:-20] for x in (out[:3].sum(axis=0), -out[3]))
    np.testing.assert_allclose(late, early, atol=0.02 * early.std())


def ten_times_faster(log):
    """The same log at ten times its rate."""
    time = np.linspace(log.time[0], log.time[-1], 10 * (len(log) - 1) + 1)
    q, tau = (np.stack([np.interp(time, log.time, x) for x in every.T], axis=1) for every in (log.q, log.tau))
    return dataclasses.replace(log, time=time, q=q, tau=tau)


def test_a_delay_of_a_fast_log_is_found_to_a_millisecond():
    leg, log = clean()
    finding = of_kind(exoid.check(leg, late(ten_times_faster(log), 0.01, range(3))), "torque-delay")
    assert finding.value == pytest.approx(0.01, abs=0.001)
