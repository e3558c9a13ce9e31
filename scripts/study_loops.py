"""Are machines with closed loops identified? A four-bar knee and an ankle on two rods in MuJoCo; see docs/loops.md.

    python scripts/study_loops.py --seeds 8      # seeds from 1000, about 7 minutes on one core
    python scripts/study_loops.py --machine ankle --motions 4  # identified from two minutes
    python scripts/study_loops.py --seeds 24 --noises 4      # each machine with other noise: do intervals hold?

Each seed draws other proportions and masses. MuJoCo closes the loops by `connect`, and knows nothing of exoid's
elimination. Only the motors are logged: angle (17 bits) and torque (noise of 1 % of its root mean square). Training:
two motions of 30 s (`--motions`). Test: another one. An error as torque is that of one parameter, over the size with
which it would explain all torque of a joint. The torque is compared with that of the true parameters, so that 1 is the
noise. The standard error of coverage is that between logs.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin

import exoid

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))
from closed_machines import Machine, four_bar_knee, to_mjcf, two_rod_ankle

MACHINES = {"four-bar knee": four_bar_knee, "two-rod ankle": two_rod_ankle}
STEP, RATE, DURATION = 2.5e-4, 400.0, 30.0  # of the simulation [s], of the log [Hz], of a motion [s]
NOISE, ENCODER = 0.01, 2.0 * np.pi / 2**17
DAMPING = 0.05  # of each motor [N·m·s/rad]


def world(machine: Machine) -> mujoco.MjModel:
    """The machine with a motor at each driven joint, its loops closed by `connect`."""
    spec = to_mjcf(machine)
    spec.option.timestep, spec.option.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    for equality in spec.equalities:
        equality.solref, equality.solimp = [2.0 * STEP, 1.0], [0.9999, 0.9999, 1e-3, 0.5, 2.0]
    for name in machine.joints:
        spec.joint(name).damping = np.array([[DAMPING], [0.0], [0.0]])
    return spec.compile()


def record(machine: Machine, leg: exoid.Leg, rng: np.random.Generator, noise: float = NOISE) -> exoid.Recording:
    """Log a random motion in MuJoCo, with noise on the torques over their root mean square."""
    model = world(machine)
    data = mujoco.MjData(model)
    at = [model.joint(name).qposadr[0] for name in machine.joints]
    rates = [model.joint(name).dofadr[0] for name in machine.joints]
    frequency = rng.uniform(0.2, 2.0, (2, 8))
    amplitude = rng.uniform(0.5, 1.0, (2, 8)) / (0.5 + frequency)
    amplitude *= np.array([[0.6], [0.45]]) / amplitude.sum(axis=1, keepdims=True)
    phase = rng.uniform(0.0, 2.0 * np.pi, (2, 8))
    start = leg.tree_motion(np.sum(amplitude * np.sin(phase), axis=1)[None]).q[0]
    for name, angle in zip(leg.tree_joint_names, start, strict=True):
        data.qpos[model.joint(name).qposadr[0]] = angle
    M = leg.mass_matrix(np.zeros((1, 2)))[0]
    rows, every = [], round(1.0 / RATE / STEP)
    for k in range(int((DURATION + 1.0) / STEP)):
        arc = 2.0 * np.pi * frequency * data.time + phase
        target = np.sum(amplitude * np.sin(arc), axis=1)
        speed = np.sum(amplitude * 2.0 * np.pi * frequency * np.cos(arc), axis=1)
        data.ctrl[:] = M @ (1600.0 * (target - data.qpos[at]) + 80.0 * (speed - data.qvel[rates]))
        if k % every == 0 and data.time >= 1.0:  # the start is a jump
            rows.append(np.r_[data.qpos[at], data.ctrl])
        mujoco.mj_step(model, data)
    q, tau = np.split(np.array(rows), 2, axis=1)
    tau = noisy(tau, rng, noise)
    times = np.arange(len(q)) / RATE
    read = np.round(q / ENCODER) * ENCODER
    return exoid.Recording(time=times, q=read, tau=tau, joint_names=machine.joints)


def noisy(tau: np.ndarray, rng: np.random.Generator, noise: float = NOISE) -> np.ndarray:
    """Add noise to torques."""
    return tau + noise * np.sqrt(np.mean(tau**2, axis=0)) * rng.standard_normal(tau.shape)


def again(name: str, seed: int, folder: Path, count: int, motions: int) -> dict[str, np.ndarray]:
    """Identify one machine from the same motions with other noises, and without noise."""
    machine, rng, found = MACHINES[name](seed), np.random.default_rng(seed), []
    leg = machine.leg(folder)
    clean = [record(machine, leg, rng, 0.0) for _ in range(motions)]
    truth = np.array([*leg.parameters, *[DAMPING] * 2])
    exact = exoid.identify(leg, clean, terms=[exoid.Viscous()], check=False).values - truth
    for draw in range(count):
        rng = np.random.default_rng([seed, draw])
        logs = [replace(log, tau=noisy(log.tau, rng)) for log in clean]
        estimate = exoid.identify(leg, logs, terms=[exoid.Viscous()], check=False)
        low, high = estimate.interval(0.95).T
        sizes, axes = np.linalg.eigh(estimate.covariance / np.multiply.outer(estimate.std, estimate.std))
        along = (estimate.values - truth) / estimate.std @ axes[:, -1] / np.sqrt(sizes[-1])
        found.append([((low <= truth) & (truth <= high)).sum(), sizes[-1], along, np.abs(exact / estimate.std).max()])
    return dict(zip(("inside", "axis", "along", "exact"), np.array(found).T, strict=True)) | {
        "count": np.array(len(truth))
    }


def measure(name: str, seed: int, folder: Path, motions: int) -> dict[str, float]:
    """Identify one machine from so many motions."""
    machine = MACHINES[name](seed)
    leg = machine.leg(folder)
    rng = np.random.default_rng(seed)
    *logs, test = (record(machine, leg, rng) for _ in range(motions + 1))
    estimate = exoid.identify(leg, logs, terms=[exoid.Viscous()])
    truth = np.array([*leg.parameters, *[DAMPING] * 2])
    error = np.abs(estimate.values - truth)
    known = estimate.std < 0.01 * np.abs(truth)
    low, high = estimate.interval(0.95).T
    perfect = replace(estimate, values=truth)
    return {
        "parameters": len(truth),
        "known": known.sum(),
        "worst": (error / np.abs(truth))[known].max(initial=0.0),
        "effect": (error / estimate.parameter_scale).max(),
        "inside": ((low <= truth) & (truth <= high)).sum(),
        "torque": np.max(exoid.validate(estimate, test).rmse / exoid.validate(perfect, test).rmse),
        "named": named(leg, logs[0]),
    }


def named(leg: exoid.Leg, log: exoid.Recording) -> float:
    """Gap [mm] that the check finds where the file of loops is wrong by 5 mm and all joints are measured."""
    tree = leg.tree_motion(log.q)
    torque = np.full(tree.q.shape, np.nan)
    torque[:, leg.closure.independent] = log.tau
    every = exoid.Recording(
        time=log.time,
        q=np.round(tree.q / ENCODER) * ENCODER,
        tau=torque,
        joint_names=leg.tree_joint_names,
    )
    assert not [one for one in exoid.check(leg, every) if one.kind == "loop-gap"]
    first, *others = leg.closure.loops.loops
    x, *rest = first.second.xyz
    moved = first._replace(second=first.second._replace(xyz=(x + 0.005, *rest)))
    loops = replace(leg.closure.loops, loops=(moved, *others))
    wrong = exoid.Leg.from_description(leg.description, loops=loops)
    found = [one for one in exoid.check(wrong, every) if one.kind == "loop-gap"]
    return 1e3 * max((one.value for one in found), default=0.0)


def standard_error(shares: Sequence[float]) -> float:
    """Standard error of the mean of what logs share; parameters of one log hold or miss together."""
    return float(np.std(shares, ddof=1) / np.sqrt(len(shares)))


def speed(name: str, folder: Path, count: int = 20_000) -> list[float]:
    """Processor time per sample [µs]: exoid's regressor, the same by a loop over Pinocchio, its constrained dynamics.

    exoid solves for poses, velocities and accelerations of all joints, and forms the regressor of the driven ones. The
    loop solves for the poses and forms the regressor; velocities and accelerations of all joints are given. Pinocchio's
    constrained dynamics is other work: accelerations under a torque, at poses that are closed already.
    """
    leg = MACHINES[name](1000).leg(folder)
    t = np.arange(count)[:, None] / RATE * [1.0, 1.7]
    q, v, a = 0.3 * np.sin(t), 0.3 * np.cos(t) * [1.0, 1.7], -0.3 * np.sin(t) * [1.0, 2.89]
    spent = []
    for _ in range(3):
        began = time.process_time()
        leg.regressor(q, v, a)
        spent.append(time.process_time() - began)
    tree = leg.tree_motion(q, v, a)
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for pair in leg.closure.pairs:
        places = [pin.SE3(np.eye(3), place) for place in pair.places]
        first, second = (body + 1 for body in pair.bodies)
        kind, axes = pin.ContactType.CONTACT_3D, pin.ReferenceFrame.LOCAL
        models.append(pin.RigidConstraintModel(kind, leg.model, first, places[0], second, places[1], axes))
    datas.extend(model.createData() for model in models)
    independent, dependent = leg.closure.independent, leg.closure.dependent
    data, pose = leg.model.createData(), tree.q[0].copy()
    pin.initConstraintDynamics(leg.model, data, models, datas)
    began, G = time.process_time(), np.zeros((leg.model.nv, q.shape[1]))
    G[independent] = np.eye(q.shape[1])
    for k in range(count):
        pose[independent] = q[k]
        for _ in range(10):
            pin.computeJointJacobians(leg.model, data, pose)
            gap, J = [], []
            for pair, model, each in zip(leg.closure.pairs, models, datas, strict=True):
                first, second = (data.oMi[body + 1] for body in pair.bodies)
                gap.append(first.rotation.T @ (second * pair.places[1] - first * pair.places[0]))
                model.calc(leg.model, data, each)
                J.append(pin.getConstraintJacobian(leg.model, data, model, each))
            A = np.vstack(J)
            step = np.linalg.lstsq(A[:, dependent], np.concatenate(gap), rcond=1e-9)[0]
            pose[dependent] += step
            if np.abs(step).max() < 1e-7:
                break
        G[dependent] = -np.linalg.lstsq(A[:, dependent], A[:, independent], rcond=1e-9)[0]
        rows = G.T @ pin.computeJointTorqueRegressor(leg.model, data, pose, tree.v[k], tree.a[k])
    loop = time.process_time() - began
    assert np.abs(pose - tree.q[-1]).max() < 1e-9
    assert np.abs(rows @ leg.link_parameters - leg.inverse_dynamics(q[-1:], v[-1:], a[-1:])[0]).max() < 1e-6
    tau, settings = np.zeros(leg.model.nv), pin.ProximalSettings(1e-12, 1e-10, 20)
    began = time.process_time()
    for k in range(count):
        pin.constraintDynamics(leg.model, data, tree.q[k], tree.v[k], tau, models, datas, settings)
    return [each / count * 1e6 for each in (min(spent), loop, time.process_time() - began)]


def main() -> None:
    """Print one row for each machine."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--first", type=int, default=1000)
    parser.add_argument("--motions", type=int, default=2, help="of 30 s each, to identify a machine from")
    parser.add_argument("--noises", type=int, default=0, help="identify each machine with so many noises")
    parser.add_argument("--machine", default="", help="only machines whose name has this text")
    arguments = parser.parse_args()
    machines = [name for name in MACHINES if arguments.machine in name]
    with tempfile.TemporaryDirectory() as folder:
        seeds = range(arguments.first, arguments.first + arguments.seeds)
        for name in machines if arguments.noises else ():
            every = [again(name, seed, Path(folder), arguments.noises, arguments.motions) for seed in seeds]
            shares = np.concatenate([one["inside"] / one["count"] for one in every])
            along = np.concatenate([one["along"] for one in every])
            axis, count = (np.mean([one[key].mean() for one in every]) for key in ("axis", "count"))
            print(f"{name}, {len(seeds)} seeds from {seeds[0]}, {arguments.motions} motions, {len(shares)} logs")
            print(f"  within 95 % intervals, std. error            {shares.mean():.1%} ± {standard_error(shares):.1%}")
            print(f"  logs with under half inside                  {(shares < 0.5).sum()} of {len(shares)}")
            print(f"  widest axis of the correlations, of {count:.0f}      {axis:.1f}")
            print(f"  error along it, RMS [standard deviations]    {np.sqrt(np.mean(along**2)):.2f}")
            print(
                f"  largest error without noise [likewise]       {max(one['exact'].max() for one in every):.2f}",
                flush=True,
            )
        for name in () if arguments.noises else machines:
            found = []
            for seed in seeds:
                found.append(measure(name, seed, Path(folder), arguments.motions))
                print(seed, {key: f"{x:.4g}" for key, x in found[-1].items()}, file=sys.stderr)
            total = {key: sum(one[key] for one in found) for key in ("parameters", "known", "inside")}
            worst = {key: max(one[key] for one in found) for key in ("worst", "effect", "torque")}
            error = standard_error([one["inside"] / one["parameters"] for one in found])
            ours, loop, dynamics = speed(name, Path(folder))
            print(f"{name}, {arguments.seeds} seeds from {arguments.first}, {arguments.motions} motions each")
            print(f"  parameters known to 1 % (std)         {total['known']} of {total['parameters']}")
            print(f"  largest error of these                {worst['worst']:.1%}")
            print(f"  largest error over all, as torque     {worst['effect']:.1%}")
            print(f"  within 95 % intervals, std. error     {total['inside'] / total['parameters']:.1%} ± {error:.1%}")
            print(f"  torque of another motion, rms / truth {worst['torque']:.3f} at most")
            print(f"  gap named where 5 mm are wrong [mm]   {min(one['named'] for one in found):.1f} at least")
            print(f"  µs a sample: exoid, loop, dynamics    {ours:.1f}, {loop:.1f}, {dynamics:.1f}")


if __name__ == "__main__":
    main()
