"""Nothing is found in a log without faults."""

import dataclasses

import mujoco
import numpy as np
import pytest
from logs import clean, kinds
from swings import late

import exoid
from exoid.torques import Presliding


@pytest.mark.parametrize("name", ["bleex", "cuhk"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_log_without_faults_has_no_findings(name, seed):
    assert exoid.check(*clean(name, seed)) == ()


@pytest.mark.parametrize("known", [("J3",), ("X1", "X2", "X3", "J1", "J2", "J3")])
def test_nor_has_one_of_a_leg_with_known_parameters(known, data, estimate):
    values = {name: estimate[name].value for name in known}
    assert exoid.identify(data.leg, data.train, known=values).findings == ()


def test_nor_has_the_example_of_a_leg_that_sticks(data, estimate):
    assert exoid.check(data.leg, data.train) == ()
    assert estimate.findings == ()
    assert set(estimate.identifiability) == {"well"}


@pytest.mark.parametrize("part", [0.02, 0.1])
def test_coarse_torques_are_no_rails(part):
    leg, log = clean()
    step = part * log.tau.std(axis=0)
    coarse = dataclasses.replace(log, tau=step * np.round(log.tau / step))
    assert "saturation" not in kinds(exoid.check(leg, coarse))


def test_noise_that_grows_with_speed_is_no_fault_of_the_model():
    leg, log = clean()
    v = np.gradient(log.q, axis=0)
    size = 0.02 * log.tau.std(axis=0) * (v / v.std(axis=0)) ** 2
    noisy = dataclasses.replace(log, tau=log.tau + size * np.random.default_rng(3).standard_normal(v.shape))
    assert kinds(exoid.check(leg, noisy)) == set()


@pytest.mark.parametrize(("noise", "seed"), [(1e-4, 4), (1e-3, 4), (1e-3, 7)])
def test_noisy_angles_are_no_fault(noise, seed):
    leg, log = clean()
    q = log.q + noise * np.random.default_rng(seed).standard_normal(log.q.shape)
    assert kinds(exoid.check(leg, dataclasses.replace(log, q=q))) == set()


@pytest.mark.parametrize(("early", "length"), [(0.004, 0.0), (0.0, 5e-4), (0.0, 3e-3)])
@pytest.mark.parametrize("delay", [0.0, 0.01])
def test_friction_that_turns_before_the_velocity_or_after_it_is_no_delay(early, length, delay):
    leg, log = clean("cuhk")
    v = np.gradient(log.q, log.time, axis=0)
    friction = np.column_stack([np.tanh(np.interp(log.time + early, log.time, x) / 0.015) for x in v.T])
    if length:
        friction = np.column_stack([Presliding(length).states(*x) for x in zip(log.q.T, v.T, strict=True)])
    log = dataclasses.replace(log, tau=log.tau + 0.4 * log.tau.std(axis=0) * friction)
    found = exoid.check(leg, late(log, delay, range(log.q.shape[1])))
    assert kinds(found) - {"torque-delay"} <= {"unmodelled-friction"}
    values = [one.value for one in found if one.kind == "torque-delay"]
    # friction that is unlike the model's may hide a delay, and is named
    assert values == ([] if delay == 0.0 or length > 1e-3 else [pytest.approx(delay, abs=2e-3)])


def test_a_robot_that_replays_one_stride_has_no_late_torque():
    """MuJoCo softens friction: an ankle on which little else acts seemed to be late, an error."""
    leg, rng, rows, t = exoid.load_leg("bleex"), np.random.default_rng(12), [], 0.001 * np.arange(16000)
    model = mujoco.MjModel.from_xml_path(str(exoid.catalog.urdf_folder() / "bleex.urdf"))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT | mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.timestep, model.opt.integrator = 0.001, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.dof_frictionloss[:3], model.dof_damping[:3] = (2.2, 1.5, 0.7), (0.6, 0.4, 0.15)
    model.dof_armature[:3], model.body_mass[3], model.body_inertia[3] = (0.35, 0.22, 0.06), 1.25, 0.0072
    model.body_ipos[3] = -0.06, 0.0, -0.045
    x = 2.0 * np.pi * rng.uniform(0.6, 0.8) * t[:, None] + rng.uniform(0.0, 6.0)
    goal = np.array([0.42, 0.4, 0.2]) * np.sin(x + np.array([0.0, 1.2, 2.5])) + [0.25, -0.5, 0.05]
    goal += np.array([0.0, 0.12, 0.12]) * np.sin(2.0 * x + np.array([0.0, 0.3, 1.0]))
    data = mujoco.MjData(model)
    for q, v in zip(goal, np.gradient(goal, t, axis=0), strict=True):
        tau = np.array([900, 600, 150]) * (q - data.qpos[:3]) + np.array([40, 25, 5]) * (v - data.qvel[:3])
        rows.append((data.qpos[:3].copy(), tau))
        data.qfrc_applied[:3] = tau
        mujoco.mj_step(model, data)
    q, tau = np.array(rows[2000::2]).transpose(1, 0, 2)
    tau = tau + [0.35, 0.25, 0.1] * rng.standard_normal(tau.shape)
    log = exoid.Recording(t[2000::2], np.round(q, 4), tau=tau, joint_names=leg.joint_names)
    assert "torque-delay" not in kinds(exoid.check(leg, log))


@pytest.mark.real_data("dfki_double_pendulum")
def test_the_real_recording_has_the_findings_that_the_page_argues_for():
    data = exoid.datasets.dfki_double_pendulum()
    found = {(finding.kind, finding.joint) for finding in exoid.check(data.leg, data.train)}
    assert found == {("unmodelled-friction", "shoulder"), ("unmodelled-friction", "elbow"), ("torque-scale", "elbow")}
