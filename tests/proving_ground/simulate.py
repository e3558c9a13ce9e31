"""A machine moves in MuJoCo, and its log and its truth are kept."""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np
import scipy
from scipy.spatial.transform import Rotation

import exoid

from .friction import STEP, Array, Laws
from .machine import Machine
from .motion import reference

SETTLE = 1.0
"""Seconds before the log begins."""
BEARING = 0.15
"""Part of the friction that a sensor behind the gear sees."""
POSE_NOISE = 1e-4
"""Standard deviation of the pose of a floating base [m and rad]."""


@dataclass(frozen=True, eq=False)
class Truth:
    """What happened at the samples of a log: positions and velocities as MuJoCo's equations have them at one time.

    Attributes:
        time: [s], (N,).
        q: Angles of the links [rad], (N, n).
        v: Their velocities [rad/s], (N, n).
        a: Their accelerations [rad/s²], (N, n).
        rotor: Angles, velocities and accelerations of the rotors, (3, N, n).
        drive: Torques of the drives [N·m], (N, n).
        friction: Torques of friction [N·m], (N, n).
        rigid: Torques that the rigid bodies need: drive less friction and rotor, or that of the spring [N·m], (N, n).
        logged: Torques that the log would have without noise [N·m], (N, n).
        base: Position and quaternion (x, y, z, w) of the root, its velocity and acceleration in MuJoCo's coordinates,
            and the wrench on it in its axes, (N, 7 + 6 + 6 + 6).
    """

    time: Array
    q: Array
    v: Array
    a: Array
    rotor: Array
    drive: Array
    friction: Array
    rigid: Array
    logged: Array
    base: Array


@dataclass(frozen=True, eq=False)
class Log:
    """A log as a user has it, the same without errors of sensors, and the truth."""

    recording: exoid.Recording
    clean: exoid.Recording
    truth: Truth


class Plant:
    """MuJoCo's model of a machine, and where its joints and rotors are."""

    def __init__(self, machine: Machine, *, believed: bool = False) -> None:
        """Compile the model."""
        self.model = mujoco.MjModel.from_xml_string(machine.mjcf(believed=believed))
        self.data = mujoco.MjData(self.model)
        option = self.model.opt
        option.timestep, option.tolerance, option.iterations = STEP, 0.0, 100
        option.integrator, option.cone = mujoco.mjtIntegrator.mjINT_EULER, mujoco.mjtCone.mjCONE_PYRAMIDAL
        self.model.dof_solimp[:], self.model.dof_solref[:] = [0.9999, 0.9999, 0.001, 0.5, 2.0], [2.0 * STEP, 1.0]
        turned = [f"rotor_{j.name}" if j.spring else j.name for j in machine.joints]
        self.links, self.link_dofs = self._of(machine.names)
        self.rotors, self.rotor_dofs = self._of(turned)

    def _of(self, names: tuple[str, ...] | list[str]) -> tuple[Array, Array]:
        joints = [self.model.joint(name) for name in names]
        return np.array([int(j.qposadr[0]) for j in joints]), np.array([int(j.dofadr[0]) for j in joints])

    def inertias(self, q: Array) -> Array:
        """Diagonal of the inertia matrix at these angles, link and rotor, (n,)."""
        self.data.qpos[self.links] = q
        mujoco.mj_forward(self.model, self.data)
        M = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, M)
        diagonal = np.diag(M)
        # Of a floating base: inertia with all links at rest to it, and with all links free.
        self.whole = diagonal[:6].copy(), 1.0 / np.diag(np.linalg.inv(M))[:6]
        elastic = self.link_dofs != self.rotor_dofs
        return diagonal[self.link_dofs] + elastic * diagonal[self.rotor_dofs]

    def torques(self, q: Array, v: Array, a: Array) -> Array:
        """Inverse dynamics along a motion with the base at rest, (N, n); rigid joints have their rotors in it."""
        out, every = np.empty(q.shape), max(1, round(0.005 / STEP))
        for k in range(0, len(q), every):
            self.data.qpos[self.links], self.data.qvel[self.link_dofs] = q[k], v[k]
            self.data.qacc[self.link_dofs] = a[k]
            mujoco.mj_inverse(self.model, self.data)
            out[k : k + every] = self.data.qfrc_inverse[self.link_dofs]
        return out


def simulate(machine: Machine, seconds: float, *, test: bool = False) -> Log:
    """Move the machine by its controller, and log it."""
    motion = machine.motions[test]
    steps = _run(machine, reference(motion, len(machine.joints), seconds + SETTLE, 2 * machine.seed + test), test=test)
    every, first = round(1.0 / (STEP * machine.sensing.rate)), round(SETTLE / STEP)
    rows = np.arange(first, len(steps.time), every)
    late = rows - round(machine.sensing.delay / STEP)
    taken = {name: getattr(steps, name)[rows] for name in steps.__dataclass_fields__ if name not in ("rotor", "logged")}
    truth = Truth(**taken, rotor=steps.rotor[:, rows], logged=steps.logged[late])
    now = replace(truth, logged=steps.logged[rows])  # a delay is an error of the sensor
    return Log(_recording(machine, truth, test=test), _recording(machine, now, None), truth)


def _run(machine: Machine, ref: tuple[Array, Array, Array], *, test: bool) -> Truth:
    """Integrate; the torque of a step acts at its beginning, so that angles and torques are of one time."""
    plant, joints, count = Plant(machine), machine.joints, len(machine.joints)
    q_ref, v_ref, a_ref = (x * np.where([j.slides for j in joints], 0.1, 1.0) for x in ref)
    model, data, links, dofs = plant.model, plant.data, plant.links, plant.link_dofs
    rotors, turns = plant.rotors, plant.rotor_dofs
    laws, rng = Laws([j.friction for j in joints]), np.random.default_rng([machine.seed, int(test), 7])
    inertia = np.array([j.rotor for j in joints])
    spring, elastic = np.array([j.spring for j in joints]), turns != dofs
    driven, limit = np.array([not j.passive for j in joints]), np.array([j.limit for j in joints])
    total = plant.inertias(q_ref[0])
    omega = rng.uniform(15.0, 30.0) * np.where(elastic.any(), 0.6, 1.0)
    kp, kd, ks = driven * total * omega**2, driven * total * 1.4 * omega, 0.1 * np.sqrt(spring * total)
    forward = np.zeros(q_ref.shape)
    if machine.controller != "pd":
        moves = 0.0 if machine.controller == "gravity" else 1.0
        forward = driven * Plant(machine, believed=True).torques(q_ref, moves * v_ref, moves * a_ref)
    base = Base(machine, rng, len(q_ref), plant.whole) if machine.floating else None
    data.qpos[links] = data.qpos[rotors] = q_ref[0]
    data.qvel[dofs] = data.qvel[turns] = v_ref[0]
    drive, load, lag = forward[0].copy(), np.zeros(count), STEP / machine.sensing.lag
    out = np.empty((10, len(q_ref), count))
    bases = np.zeros((len(q_ref), 25))
    for k in range(len(q_ref)):
        q, v, turned, speed = data.qpos[links], data.qvel[dofs], data.qpos[rotors], data.qvel[turns]
        command = forward[k] + kp * (q_ref[k] - turned) + kd * (v_ref[k] - speed)
        level = laws.level(speed, load, k * STEP)
        smooth = laws.torque(speed, level)
        twist = elastic * (spring * (turned - q) + ks * (speed - v))
        model.dof_frictionloss[turns] = laws.sharp * level
        data.qfrc_applied[dofs] = twist
        data.qfrc_applied[turns] = np.where(elastic, drive - smooth - twist, drive - smooth)
        if base is not None:
            bases[k] = base.hold(data, k)
        mujoco.mj_step(model, data)
        a, swing = data.qacc[dofs], data.qacc[turns]
        friction = smooth - data.qfrc_constraint[turns]
        load = np.where(elastic, twist, drive - friction - inertia * swing)
        out[:, k] = q, v, a, turned, speed, swing, drive, friction, load, command
        if base is not None:
            bases[k, 13:19] = data.qacc[:6]
        drive = drive + lag * (np.clip(command, -limit, limit) - drive) * driven
        laws.slide(data.qpos[rotors] - turned)
    if not np.isfinite(out).all() or np.abs(out[0, :, driven]).max() > 20.0:
        raise RuntimeError(f"machine {machine.seed} is not stable")
    if base is not None:  # quaternions of exoid end with w; the wrench is in axes of the root
        bases[:, 3:7] = bases[:, [4, 5, 6, 3]]
        bases[:, 19:22] = Rotation.from_quat(bases[:, 3:7]).inv().apply(bases[:, 19:22])
    q, v, a, *rotor, drive, friction, rigid, command = out
    seen = {"sensor": rigid + BEARING * friction * ~elastic, "current": drive, "command": command * driven}
    return Truth(
        np.arange(len(q)) * STEP, q, v, a, np.array(rotor), drive, friction, rigid, seen[machine.sensing.torque], bases
    )


class Base:
    """Load cell that moves the root link slowly, and measures the wrench on it."""

    def __init__(self, machine: Machine, rng: np.random.Generator, samples: int, inertias: tuple[Array, Array]) -> None:
        """Draw a motion."""
        t, phase = np.arange(samples)[:, None] * STEP, rng.uniform(0.0, 6.0, 6)
        wave = np.sin(2.0 * np.pi * rng.uniform(0.1, 0.4, 6) * t + phase) - np.sin(phase)
        self.place, turn = 0.05 * wave[:, :3], 0.15 * wave[:, 3:]
        if machine.planar:  # the axes of such machines are y
            self.place[:, 1] = turn[:, 0] = turn[:, 2] = 0.0
        self.turn = Rotation.from_rotvec(turn).as_quat()[:, [3, 0, 1, 2]]
        self.kd = np.minimum(40.0 * inertias[0], 0.3 * inertias[1] / STEP)  # as stiff as the step resolves
        self.kp = 10.0 * self.kd
        self.weight = np.array([0.0, 0.0, 9.81 * inertias[0][0], 0.0, 0.0, 0.0])

    def hold(self, data: mujoco.MjData, k: int) -> Array:
        """Apply the force, in axes of the laboratory, and the moment, in those of the root; returns pose and twist."""
        pose, twist, error = data.qpos[:7].copy(), data.qvel[:6].copy(), np.zeros(6)
        error[:3] = self.place[k] - pose[:3]
        mujoco.mju_subQuat(error[3:], self.turn[k], pose[3:])
        data.qfrc_applied[:6] = self.kp * error - self.kd * twist + self.weight
        return np.concatenate([pose, twist, np.zeros(6), data.qfrc_applied[:6]])


def _recording(machine: Machine, truth: Truth, noisy: bool | None = True, *, test: bool = False) -> exoid.Recording:
    """Make a log, with the errors of its sensors or (None) without."""
    sensing, rng = machine.sensing, np.random.default_rng([machine.seed, int(test), 11])
    q = truth.q if sensing.torque == "sensor" else truth.rotor[0]
    tau, wrench, pose = truth.logged, truth.base[:, 19:], truth.base[:, :7]
    if noisy is not None:
        turn = 2.0 * np.pi / 2**sensing.bits
        q = turn * np.round(q / turn)
        spread = np.maximum(tau.std(axis=0), 0.05 * tau.std(axis=0).max())
        tau = tau + sensing.noise * spread * _noise(rng, sensing.colour, truth.v, sensing.rate)
        wrench = wrench + sensing.noise * wrench.std(axis=0) * rng.standard_normal(wrench.shape)
        pose = pose + POSE_NOISE * rng.standard_normal(pose.shape)
    passive = tuple(j.name for j in machine.joints if j.passive)
    tau = np.where([j.passive for j in machine.joints], 0.0, tau)
    outside, time = {}, truth.time - truth.time[0]
    if machine.floating:
        quaternion = pose[:, 3:] / np.linalg.norm(pose[:, 3:], axis=1, keepdims=True)
        outside["base"] = exoid.BaseMotion.from_pose(pose[:, :3], quaternion, time)
        outside["wrenches"] = {"root": exoid.Wrench(wrench[:, :3], wrench[:, 3:])}
    turns = np.inf if passive else 2.0 * np.pi  # a passive joint may turn round
    return exoid.Recording(time, q, tau=tau, joint_names=machine.names, passive=passive, largest_angle=turns, **outside)


def _noise(rng: np.random.Generator, colour: str, v: Array, rate: float) -> Array:
    """Noise of standard deviation one, (N, n)."""
    white = rng.standard_normal(v.shape)
    if colour == "speed-dependent":
        speed = np.abs(v) / np.sqrt(np.mean(v**2, axis=0))
        return white * (0.3 + speed) / np.sqrt(np.mean((0.3 + speed) ** 2, axis=0))
    if colour == "coloured":
        keep = np.exp(-1.0 / (rate * rng.uniform(0.005, 0.05)))
        return scipy.signal.lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], white, axis=0)
    return white
