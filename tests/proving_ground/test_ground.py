"""The proving ground itself: MuJoCo, Pinocchio, energy and repetition agree on what a machine did."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from .friction import OF_C0, STEP, Friction, Laws
from .machine import COLOURS, TORQUES, draw
from .simulate import simulate

pytestmark = pytest.mark.slow

SEEDS = (0, 3, 6, 8, 12, 13)
"""Machines that are fixed and floating, planar and not, with passive and with elastic joints."""


@cache
def logged(seed, seconds=1.5):
    machine = draw(seed)
    return machine, simulate(machine.with_sensing(rate=4000, delay=0.0), seconds)


def pinocchio(machine):
    free = (pin.JointModelFreeFlyer(),) if machine.floating else ()
    model = pin.buildModelFromXML(machine.urdf(), *free)
    order = [model.joints[model.getJointId(name)] for name in machine.names]
    return model, np.array([j.idx_q for j in order]), np.array([j.idx_v for j in order])


def states(machine, truth):
    """Angles, velocities and accelerations in Pinocchio's coordinates."""
    model, at, dofs = pinocchio(machine)
    q = np.tile(pin.neutral(model), (len(truth.time), 1))
    v, a = np.zeros((2, len(q), model.nv))
    q[:, at], v[:, dofs], a[:, dofs] = truth.q, truth.v, truth.a
    if machine.floating:
        q[:, :7] = truth.base[:, :7]
        R = np.array([pin.Quaternion(x).matrix() for x in q[:, 3:7]])
        v[:, :3] = np.einsum("nji,nj->ni", R, truth.base[:, 7:10])
        v[:, 3:6], a[:, 3:6] = truth.base[:, 10:13], truth.base[:, 16:19]
        a[:, :3] = np.einsum("nji,nj->ni", R, truth.base[:, 13:16]) - np.cross(v[:, 3:6], v[:, :3])
    return model, dofs, q, v, a


@pytest.mark.parametrize("seed", SEEDS)
def test_pinocchio_on_the_true_urdf_needs_the_torques_that_mujoco_applied(seed):
    machine, log = logged(seed)
    model, dofs, q, v, a = states(machine, log.truth)
    data, rows = model.createData(), range(0, len(q), 37)
    needed = np.array([pin.rnea(model, data, q[k], v[k], a[k]) for k in rows])
    scale = np.abs(log.truth.rigid).max()
    np.testing.assert_allclose(needed[:, dofs], log.truth.rigid[rows], rtol=0.0, atol=1e-9 * scale)
    if machine.floating:
        np.testing.assert_allclose(needed[:, :6], log.truth.base[rows, 19:], rtol=0.0, atol=1e-9 * scale)


@pytest.mark.parametrize("seed", SEEDS)
def test_drives_do_the_work_that_energy_and_friction_take(seed):
    machine, log = logged(seed)
    model, _, q, v, _ = states(machine, log.truth)
    data, truth = model.createData(), log.truth
    turned, speed, _ = truth.rotor
    joints = np.array([(j.rotor, j.spring) for j in machine.joints]).T
    energy = np.array(
        [
            pin.computeKineticEnergy(model, data, *state) + pin.computePotentialEnergy(model, data, state[0])
            for state in zip(q, v, strict=True)
        ]
    )
    stored = energy + (0.5 * joints[0] * speed**2 + 0.5 * joints[1] * (turned - truth.q) ** 2).sum(axis=1)
    power = ((truth.drive - truth.friction) * speed).sum(axis=1)
    spring = np.where(joints[1] > 0.0, truth.rigid - joints[1] * (turned - truth.q), 0.0)
    power -= (spring * (speed - truth.v)).sum(axis=1)  # damping of springs
    if machine.floating:
        power += (truth.base[:, 19:] * v[:, :6]).sum(axis=1)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]))]) * STEP
    turnover = np.sum(np.abs(power)) * STEP
    np.testing.assert_allclose(stored - stored[0], work, rtol=0.0, atol=5e-3 * turnover)


def test_friction_takes_energy_whatever_its_law():
    kinds = set()
    for seed in SEEDS:
        machine, log = logged(seed)
        power = (log.truth.friction * log.truth.rotor[1]).sum(axis=0)
        assert (power > 0.0).all()
        kinds |= {joint.friction.kind for joint in machine.joints}
    assert kinds == set(OF_C0)


def test_presliding_is_a_spring_that_yields():
    length = 1e-4
    laws = Laws([Friction("presliding", "presliding", 1.0, 0.0, length=length)])
    laws.slide(np.array([1e-3 * length]))
    np.testing.assert_allclose(laws.z, 1e-3, rtol=1e-3)
    laws.slide(np.array([50.0 * length]))
    np.testing.assert_allclose(laws.z, 1.0)


def test_the_same_seed_gives_the_same_log_and_another_motion_another():
    machine = draw(5)
    one, same, other = (simulate(machine, 0.3, test=test).recording for test in (False, False, True))
    assert np.array_equal(one.q, same.q)
    assert np.array_equal(one.tau, same.tau)
    assert not np.array_equal(one.tau, other.tau)


def test_logs_differ_from_the_truth_by_what_was_drawn():
    machine, log = logged(8)
    turn = 2.0 * np.pi / 2**machine.sensing.bits
    assert np.abs(log.recording.q - log.truth.q).max() <= 0.5000001 * turn
    noise = log.recording.tau - log.clean.tau
    spread = np.maximum(log.clean.tau.std(axis=0), 0.05 * log.clean.tau.std(axis=0).max())
    np.testing.assert_allclose(noise.std(axis=0) / spread, machine.sensing.noise, rtol=0.1)
    late = simulate(machine.with_sensing(rate=4000, delay=0.01), 1.5)
    np.testing.assert_array_equal(late.truth.logged[40:], log.clean.tau[:-40])
    np.testing.assert_array_equal(late.clean.tau, log.clean.tau)


def test_machines_are_of_every_kind_that_was_asked_for():
    machines = [draw(seed) for seed in range(1000, 1100)]
    assert {len(m.joints) for m in machines} == set(range(2, 8))
    assert 0.5 <= min(m.mass for m in machines) < 0.7
    assert 60.0 < max(m.mass for m in machines) <= 80.0
    assert {m.planar for m in machines} == {m.floating for m in machines} == {True, False}
    assert {j.friction.kind for m in machines for j in m.joints} == set(OF_C0)
    assert {m.sensing.colour for m in machines} == set(COLOURS)
    assert {m.sensing.torque for m in machines} == set(TORQUES)
    assert {m.sensing.bits for m in machines} == set(range(12, 21))
    assert {m.sensing.rate for m in machines} >= {50, 2000}
    assert any(j.passive for m in machines for j in m.joints)
    assert any(j.spring for m in machines for j in m.joints)
    assert any(m.tool for m in machines)
    assert any(m.sensing.delay for m in machines)
    heavy = [max(b.mass / a.mass for a, b in zip(m.bodies, m.believed[1:], strict=True)) for m in machines]
    assert max(heavy) > 4.0
