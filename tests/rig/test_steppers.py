"""The stepper: alike for one rig and many, accurate to second order, true to energy, friction and end stops."""

import mujoco
import numpy as np
import pytest
from rigs import BLEEX, EVERYTHING, FRICTION, POSE, torque, zeros

import exoid
from exoid.leg.catalog import URDFS, urdf_folder
from exoid.rig import Plant, Stepper

pytestmark = pytest.mark.slow


def final_state(plant, dt, duration):
    """State after a run under a smooth torque, and how often joints rested."""
    rig, rested = Stepper(plant, np.broadcast_to(POSE, (3, plant.count)), zeros(plant), dt), 0
    for k in range(round(duration / dt)):
        rig.step(np.broadcast_to(torque((k + 0.5) * dt), (3, plant.count)), zeros(plant))
        rested += (rig.v == 0.0).sum()
    return np.concatenate([rig.q, rig.v]), rested


def one_and_two(plant, q, v, dt):
    """A rig by Pinocchio's dynamics, and the same rig twice by the closed form."""
    twice = plant.repeat(2)
    return Stepper(plant, q, v, dt), Stepper(twice, *(np.broadcast_to(x, (plant.n, 2)) for x in (q, v)), dt)


@pytest.mark.parametrize(("end_stops", "pitch"), [(True, 0.3), (False, 0.0), (True, 0.0), (False, 0.3)])
def test_one_rig_by_pinocchio_moves_as_many_in_closed_form(end_stops, pitch):
    plant = Plant.build(BLEEX, EVERYTHING, pitch=pitch, end_stops=end_stops)
    rigs = one_and_two(plant, POSE, zeros(plant), 5e-4)
    start, seen = [rig.energy() for rig in rigs], set()
    for k in range(2500):
        one, two = (rig.step(torque(k * 5e-4), np.full(rig.q.shape, 0.05)) for rig in rigs)
        np.testing.assert_allclose(rigs[1].q, np.tile(rigs[0].q, 2), rtol=0, atol=1e-10)
        np.testing.assert_allclose(rigs[1].v, np.tile(rigs[0].v, 2), rtol=0, atol=1e-9)
        np.testing.assert_allclose(two.friction_impulse, np.tile(one.friction_impulse, 2), rtol=0, atol=1e-10)
        seen |= set(np.sign(rigs[0].v).ravel())
        if (np.abs(one.friction_impulse) > 5e-4 * plant.static + 1e-12).any():
            seen.add("stop")
    assert seen == ({-1.0, 0.0, 1.0, "stop"} if end_stops else {-1.0, 0.0, 1.0})
    gains = [rig.energy() - before for rig, before in zip(rigs, start, strict=True)]
    np.testing.assert_allclose(gains[1], gains[0][0], rtol=0, atol=1e-9)


@pytest.mark.parametrize("values", [{}, {"d_hip": 0.3, "b1_knee": 3.0, "Ia_ankle": 0.05}])
def test_without_friction_half_the_step_has_a_quarter_of_the_error(values):
    plant = Plant.build(BLEEX, values, end_stops=False)
    fine, coarse, half = (final_state(plant, dt, 1.0)[0] for dt in (1e-3 / 8, 2e-3, 1e-3))
    errors = np.abs(coarse - fine).max(), np.abs(half - fine).max()
    assert 3.5 < errors[0] / errors[1] < 4.6
    assert errors[1] < 1e-3


def test_with_stick_and_slip_half_the_step_has_half_the_error_or_less():
    """Root mean square over rigs that stop, rest and turn at other times each."""
    B = 16
    parts = [Plant.build(BLEEX, {**FRICTION, "b1_hip": x}, end_stops=False) for x in np.linspace(0.0, 6.0, B)]
    runs = [final_state(Plant.concatenate(parts), dt, 1.5) for dt in (1e-3 / 16, 1e-3, 5e-4, 2.5e-4)]
    assert runs[0][1] > 500  # joints rested
    errors = [np.sqrt(np.mean((run[0][:3] - runs[0][0][:3]) ** 2)) for run in runs[1:]]
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 0.25 * errors[0]
    assert errors[2] < 2e-4


def test_a_joint_within_its_friction_band_does_not_move_at_all():
    plant = Plant.build(BLEEX, FRICTION)
    gravity = BLEEX.gravity(POSE.T).T
    rig = Stepper(plant, POSE, zeros(plant), 2e-3)
    inside = gravity + 0.95 * plant.coulomb * np.array([[1.0], [-1.0], [1.0]])
    for k in range(30_000):
        rig.step(inside if k % 2 else gravity, zeros(plant))
    assert np.abs(rig.q - POSE).max() <= 1e-9  # exactly equal, in fact
    np.testing.assert_array_equal(rig.q, POSE)
    rig.step(gravity + 1.05 * plant.coulomb * np.array([[0.0], [0.0], [1.0]]), zeros(plant))
    assert rig.v[2, 0] > 0.0


def test_static_friction_breaks_away_later_and_slips_with_the_kinetic_one():
    """One joint: breakaway where the torque exceeds cs; then it accelerates with τ − c0."""
    leg = exoid.Leg.from_description(BLEEX.description, ("left_ankle",))
    for static in (0.5, 0.8):
        plant = Plant.build(leg, {"c0_ankle": 0.5, "cs_ankle": static})
        dt, pose = 1e-3, np.zeros((1, 1))
        gravity = leg.gravity(pose)[0, 0]
        rig = Stepper(plant, pose, pose, dt)
        for k in range(1000):
            drive = 1e-3 * (k + 0.5)
            rig.step(np.full((1, 1), gravity + drive), pose)
            if rig.v[0, 0] != 0.0:
                break
        assert drive == pytest.approx(static, abs=1.01e-3)
        inertia = leg.mass_matrix(pose)[0, 0, 0]
        assert rig.v[0, 0] == pytest.approx(dt * (drive - 0.5) / inertia, rel=1e-6, abs=1e-12)


def test_end_stops_hold_and_do_not_bounce():
    plant = Plant.build(BLEEX, {"c0_hip": 0.5})
    rig = Stepper(plant, POSE, zeros(plant), 5e-4)
    hit = False
    for k in range(4000):
        before = rig.v
        rig.step(np.array([[20.0], [10.0], [2.0]]) * (1.0 if k < 2500 else -1.0), zeros(plant))
        assert (rig.q <= plant.upper + 5e-4 * 12.0).all()  # beyond a stop by less than a step at full speed
        if before[1, 0] > 0.5 and rig.v[1, 0] == 0.0:
            hit = True
            knee = rig.q[1, 0]
        elif hit and k < 2500:
            assert rig.q[1, 0] <= knee + 1e-12
    assert hit
    assert rig.q[1, 0] < knee - 0.1  # it lets go when pulled away


def mujoco_angles(plant: Plant, dt: float, duration: float, solref: float) -> np.ndarray:
    model = mujoco.MjModel.from_xml_path(str(urdf_folder() / URDFS["bleex", "cad"]))
    dofs = [int(model.joint(name).dofadr[0]) for name in plant.leg.joint_names]
    model.dof_damping[:] = model.dof_frictionloss[:] = 0.0
    model.dof_damping[dofs], model.dof_armature[dofs] = plant.viscous[:, 0], plant.armature[:, 0]
    model.dof_frictionloss[dofs] = plant.coulomb[:, 0]
    model.dof_solimp[:] = [0.9999, 0.9999, 0.001, 0.5, 2.0]
    model.dof_solref[:] = [solref, 1.0]
    model.opt.timestep, model.opt.iterations, model.opt.tolerance = dt, 200, 0.0
    rubs = bool(plant.coulomb.any())
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICIT if rubs else mujoco.mjtIntegrator.mjINT_RK4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT | mujoco.mjtDisableBit.mjDSBL_CONTACT
    data = mujoco.MjData(model)
    data.qpos[dofs] = POSE[:, 0]
    every, path = round(1e-3 / dt), []
    for k in range(round(duration / dt)):
        if k % every == 0:
            data.qfrc_applied[dofs] = torque(k * dt)[:, 0]
        mujoco.mj_step(model, data)
        if (k + 1) % every == 0:
            path.append(data.qpos[dofs].copy())
    return np.array(path)


def our_angles(plant: Plant, dt: float, duration: float) -> np.ndarray:
    rig, every, path = Stepper(plant, POSE, zeros(plant), dt), round(1e-3 / dt), []
    for k in range(round(duration / dt)):
        if k % every == 0:
            drive = torque(k * dt)
        rig.step(drive, zeros(plant))
        if (k + 1) % every == 0:
            path.append(rig.q[:, 0])
    return np.array(path)


SMOOTH = {"d_hip": 0.1, "d_knee": 0.2, "d_ankle": 0.05, "Ia_hip": 0.1, "Ia_knee": 0.05, "Ia_ankle": 0.02}


def test_mujoco_swings_alike_without_friction():
    plant = Plant.build(BLEEX, SMOOTH, end_stops=False)
    ours, theirs = our_angles(plant, 2.5e-4, 2.0), mujoco_angles(plant, 1e-4, 2.0, 0.02)
    assert np.abs(ours - theirs).max() < 1e-5
    assert np.ptp(ours, axis=0).min() > 0.5


def test_mujoco_agrees_on_stick_slip_better_the_stiffer_its_friction():
    """MuJoCo's friction is viscous below a speed of about c · solref / 2M, ours is not: they differ in proportion."""
    plant = Plant.build(BLEEX, {**SMOOTH, **FRICTION}, end_stops=False)
    ours = our_angles(plant, 2.5e-4, 2.0)
    assert (np.diff(ours[:, 1:], axis=0) == 0.0).mean(axis=0).min() > 0.01  # joints stuck now and then
    soft, stiff = (np.abs(ours - mujoco_angles(plant, 5e-5, 2.0, x)).max(axis=0) for x in (2e-3, 2e-4))
    assert stiff.max() < 3e-4
    assert soft.max() < 4e-3
    assert (stiff < 0.3 * soft).all()
