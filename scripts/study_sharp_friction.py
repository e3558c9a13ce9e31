"""Is friction found right where it is sharp: joints that stick at every reversal, in a simulator that is not ours?

A leg in MuJoCo: Coulomb friction as ``frictionloss`` (stiff: ``solimpfriction=".9999 .9999 .001"``), damping and
armature. A PD controller with the rigid bodies' torque as feed-forward tracks five harmonics of 0.1 Hz, of random
amplitudes and phases. Only angles and torques are recorded, without noise unless asked for. The table has, for each
parameter, bias and worst error in percent of the truth (Y: of X), the coverage of 95 % intervals, and in how many of
the motions the error is within the limit: 1 % for X, Y and J, 3 % for friction and rotor. The coverage of the offset,
which is zero, is counted like the others.

    OMP_NUM_THREADS=1 python scripts/study_sharp_friction.py                              # 20 motions, some minutes
    OMP_NUM_THREADS=1 python scripts/study_sharp_friction.py --width 0.02                 # tanh(v / 0.02) throughout
    OMP_NUM_THREADS=1 python scripts/study_sharp_friction.py --motions 4 --torque-noise 0.3 --angle-noise 1e-4
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

import exoid
from exoid._typing import FloatArray
from exoid.leg.catalog import URDFS, urdf_folder

STEP, CONTROL = 2.5e-4, 1e-3
"""Of the simulator and of the controller [s]."""
COULOMB = {"bleex": (1.2, 0.9, 0.5), "cuhk": (1.445, 0.593)}
VISCOUS = {"bleex": (0.5, 0.3, 0.2), "cuhk": (0.4, 0.2)}
ARMATURE = {"bleex": (0.12, 0.08, 0.03), "cuhk": (0.2, 0.1)}
RIGID_LIMIT, JOINT_LIMIT = 0.01, 0.03
"""Errors that are allowed: of the rigid bodies, and of friction and rotor."""
REQUIRED = 0.9
"""Share of the motions within the limit that is asked for."""


class Case(NamedTuple):
    """What is simulated and recorded.

    Attributes:
        leg: Name of the leg.
        seconds: Duration of a motion [s].
        rate: Sampling rate of the log [Hz], a divisor of 1 kHz.
        stiffness: Natural frequency of the controlled joints [rad/s].
        torque_noise: White noise of the torque [N·m].
        angle_noise: White noise of the angles [rad].
    """

    leg: str = "bleex"
    seconds: float = 60.0
    rate: float = 500.0
    stiffness: float = 30.0
    torque_noise: float = 0.0
    angle_noise: float = 0.0


class Outcome(NamedTuple):
    """Relative errors of one estimate, and which of its 95 % intervals contain the truth."""

    errors: FloatArray
    inside: NDArray[np.bool_]


def simulator(leg: exoid.Leg, name: str) -> tuple[mujoco.MjModel, list[int]]:
    """Load the leg with sharp friction into MuJoCo; returns the model and the leg's degrees of freedom in it."""
    model = mujoco.MjModel.from_xml_path(str(urdf_folder() / URDFS[name, "cad" if name == "bleex" else "nominal"]))
    dofs = [int(model.joint(joint).dofadr[0]) for joint in leg.joint_names]
    model.dof_damping[:] = model.dof_frictionloss[:] = 0.0
    model.dof_frictionloss[dofs], model.dof_damping[dofs] = COULOMB[name], VISCOUS[name]
    model.dof_armature[dofs] = ARMATURE[name]
    model.dof_solimp[:] = [0.9999, 0.9999, 0.001, 0.5, 2.0]
    model.dof_solref[:] = [2.0 * STEP, 1.0]
    model.opt.timestep, model.opt.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICIT
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT | mujoco.mjtDisableBit.mjDSBL_CONTACT
    return model, dofs


def reference(count: int, stamps: FloatArray, seed: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Angles, velocities and accelerations of five harmonics, (N, n) each."""
    rng = np.random.default_rng(seed)
    omega = 2.0 * np.pi * 0.1 * np.arange(1, 6)
    amplitude = 0.42 * rng.uniform(0.4, 1.0, (count, 5)) / np.array([1.0, 1.2, 1.5, 2.0, 2.5])
    phase = rng.uniform(0.0, 2.0 * np.pi, (count, 5)) + np.multiply.outer(stamps, omega)[:, None, :]
    q = (amplitude * np.sin(phase)).sum(-1)
    v = (amplitude * omega * np.cos(phase)).sum(-1)
    return q, v, -(amplitude * omega**2 * np.sin(phase)).sum(-1)


def record(case: Case, seed: int) -> tuple[exoid.Leg, exoid.Recording]:
    """Track a motion in the simulator; a sample of torque is its mean over a control period around the sample.

    MuJoCo's angle at t + h follows from the torque at t alone (h: its step), so the torque of a step acts at its start.
    """
    leg = exoid.load_leg(case.leg)
    model, dofs = simulator(leg, case.leg)
    ticks = round(case.seconds / CONTROL)
    q_ref, v_ref, a_ref = reference(len(dofs), np.arange(ticks) * CONTROL, seed)
    forward = leg.inverse_dynamics(q_ref, v_ref, a_ref)
    data = mujoco.MjData(model)
    data.qpos[dofs], data.qvel[dofs] = q_ref[0], v_ref[0]
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, inertia)
    kp = case.stiffness**2 * np.diag(inertia)[dofs]
    kd, steps = 2.0 * kp / case.stiffness, round(CONTROL / STEP)
    q, tau = np.empty(q_ref.shape), np.empty(q_ref.shape)
    for k in range(ticks):
        q[k] = data.qpos[dofs]
        tau[k] = forward[k] + kp * (q_ref[k] - q[k]) + kd * (v_ref[k] - data.qvel[dofs])
        data.qfrc_applied[dofs] = tau[k]
        mujoco.mj_step(model, data, nstep=steps)
    rng = np.random.default_rng([seed, 1])
    every, mean = round(1.0 / (case.rate * CONTROL)), tau.copy()
    mean[1:] = ((steps + 1) * tau[1:] + (steps - 1) * tau[:-1]) / (2 * steps)
    q, tau = q[::every], mean[::every]
    q += case.angle_noise * rng.standard_normal(q.shape)
    tau += case.torque_noise * rng.standard_normal(tau.shape)
    return leg, exoid.Recording(np.arange(len(q)) * every * CONTROL, q, tau=tau, joint_names=leg.joint_names)


def truth(estimate: exoid.Estimate, case: Case) -> FloatArray:
    """True values of the parameters of an estimate, those of the rotor at the hip added to J1."""
    leg = exoid.load_leg(case.leg)
    labels, known = leg.joint_labels, dict(zip(leg.parameter_names, leg.parameters, strict=True))
    for symbol, numbers in (("c0", COULOMB), ("d", VISCOUS), ("Ia", ARMATURE)):
        known |= {f"{symbol}_{label}": x for label, x in zip(labels, numbers[case.leg], strict=True)}
    for regrouped in estimate.model.regrouped:
        for name, share in regrouped.into.items():
            known[name] += share * known[regrouped.name]
    return np.array([known.get(name, 0.0) for name in estimate.names])


def replicate(seed: int, case: Case, terms: tuple[exoid.Term, ...] | None, estimator: str = "wls") -> Outcome:
    """Simulate and identify once."""
    leg, recording = record(case, seed)
    estimate = exoid.identify(leg, recording, terms, estimator=estimator, check=False)
    true, (low, high) = truth(estimate, case), estimate.interval().T
    return Outcome((estimate.values - true) / scale(estimate.names, true), (low <= true) & (true <= high))


def scale(names: Sequence[str], true: FloatArray) -> FloatArray:
    """What errors are relative to: the truth; X of the segment for its Y, Coulomb friction for the offset."""
    values = dict(zip(names, true, strict=True))
    beside = {name: name.replace("offset", "c0").replace("Y", "X") for name in names}
    return np.array([values[beside[name]] for name in names])


def study(case: Case, seeds: range, terms: tuple[exoid.Term, ...] | None, estimator: str, workers: int) -> None:
    """Print a line for each parameter, and the whole."""
    motions = len(seeds)
    with ProcessPoolExecutor(workers) as pool:
        outcomes = list(pool.map(partial(replicate, case=case, terms=terms, estimator=estimator), seeds))
    errors, inside = (np.array(x) for x in zip(*outcomes, strict=True))
    names = exoid.torques.TorqueModel(exoid.load_leg(case.leg), terms or exoid.torques.DEFAULT_TERMS).names
    print(f"{'':14}{'bias %':>9}{'worst %':>9}{'coverage':>10}{'within':>9}")
    enough = True
    for name, error, covers in zip(names, errors.T, inside.T, strict=True):
        limit = RIGID_LIMIT if name[0] in "XYJ" else JOINT_LIMIT
        within = int((np.abs(error) <= limit).sum())
        enough &= name[0] == "Y" or within >= REQUIRED * motions
        print(
            f"{name:14}{100 * error.mean():9.2f}{100 * np.abs(error).max():9.2f}{covers.mean():10.2f}"
            f"{within:6}/{motions}"
        )
    cover = inside.mean(axis=0)
    print(f"coverage {cover.mean():.3f}, worst {cover.min():.2f} ({names[int(cover.argmin())]}); ", end="")
    print("errors within the limits" if enough else "errors beyond the limits")


def main() -> None:
    """Read options and run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--leg", choices=tuple(COULOMB), default="bleex")
    parser.add_argument("--motions", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rate", type=float, default=500.0, help="of the log [Hz], a divisor of 1000")
    parser.add_argument("--stiffness", type=float, default=30.0, help="of the controller [rad/s]")
    parser.add_argument("--torque-noise", type=float, default=0.0, help="[N·m]")
    parser.add_argument("--angle-noise", type=float, default=0.0, help="[rad]")
    parser.add_argument("--width", type=float, help="Coulomb friction tanh(v / width) [rad/s], also at reversals")
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--estimator", default="wls")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    case = Case(given.leg, given.seconds, given.rate, given.stiffness, given.torque_noise, given.angle_noise)
    terms: tuple[exoid.Term, ...] | None = None
    if given.width is not None:
        terms = (exoid.Coulomb(smoothing=given.width, reversal_speed=0.0), *exoid.torques.DEFAULT_TERMS[1:])
    seeds = range(given.first_seed, given.first_seed + given.motions)
    study(case, seeds, terms, given.estimator, given.workers)


if __name__ == "__main__":
    main()
