"""How much better is a planned minute than the documents' motions, how far from the best, and do predictions hold?

Both legs with the terms that `exoid plan` and `exoid identify` assume, torque noise as in the replays (BLEEX 0.3, 0.2,
0.1 N·m, CUHK-EXO 0.3 N·m), 100 Hz, limits of the URDFs; once more with at most 2 rad/s. Worst relative
standard deviation:

* planned: 60 s;
* document: 60 s of its dynamic experiments: BLEEX fifteen swings of 4 s, each joint at 0.2 to 1 Hz; CUHK-EXO rows 3
  to 5 of Table II, 20 s each;
* richest: 60 s of its validation motion (BLEEX, all joints at once), or of the replay's random multisine (CUHK-EXO).

    OMP_NUM_THREADS=1 python scripts/study_plan.py                        # comparison
    OMP_NUM_THREADS=1 python scripts/study_plan.py --longer 20            # and a search with 20 times the starts
    OMP_NUM_THREADS=1 python scripts/study_plan.py --replicates 1000      # and rigs that carry the plan out
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import exoid
from exoid.experiments import Bench, Harmonics, bleex, cuhk
from exoid.experiments.bench import run_motion, stiff_servo
from exoid.experiments.excitation import MotionLimits, Plan, plan_excitation
from exoid.experiments.excitation.precision import Precision, information_of
from exoid.experiments.excitation.scales import TorqueNoise
from exoid.rig import IdealTorque, Plant, Rates, Sensors

NOISE = {"bleex": (0.3, 0.2, 0.1), "cuhk": (0.3, 0.3)}
RATE = 100.0
SPEEDS = {"URDF": None, "2 rad/s": 2.0}
TRUTH = {
    "bleex": {"c0_hip": 0.5, "c0_knee": 0.53, "c0_ankle": 0.26, "d_hip": 0.3, "d_knee": 0.2, "d_ankle": 0.1},
    "cuhk": {"c0_hip": 1.445, "c0_knee": 0.593, "d_hip": 0.038, "d_knee": 0.192, "Ia_hip": 0.8, "Ia_knee": 0.8},
}
"""Of the rigs, beside the URDF's inertias."""
BATCH = 50
"""Rigs side by side."""


def log(leg: exoid.Leg, motion: Harmonics, seconds: float, rig: int = 0) -> exoid.Recording:
    """Follow a motion perfectly."""
    stamps = np.arange(round(seconds * RATE) + 1) / RATE
    states = [motion.at(float(t)) for t in stamps]
    q, v, a = (np.array([state[k][:, rig] for state in states]) for k in range(3))
    return exoid.Recording(stamps, q, v, a, joint_names=leg.joint_names)


def documents(leg: exoid.Leg, name: str) -> dict[str, list[exoid.Recording]]:
    """Return what the documents did, by name."""
    if name == "bleex":
        motions = bleex.dynamic_motions()
        swings = [log(leg, motions, 4.0, rig) for rig in range(bleex.VALIDATION)]
        richest = log(leg, motions, 60.0, bleex.VALIDATION)
    else:
        swings = [log(leg, cuhk.swing(joint), 20.0) for joint in (cuhk.HIP, cuhk.KNEE, cuhk.HIP)]
        rng = np.random.default_rng(0)
        cuhk.random_poses(rng)  # the poses of the document come first
        richest = log(leg, cuhk.multisine(leg, rng), 60.0)
    return {"document": swings, "richest": [richest]}


def compare(name: str, starts: int, longer: int) -> Plan:
    """Print worst relative standard deviations of one leg; return the plan within the URDF's limits."""
    leg, plans = exoid.load_leg(name), []
    for label, speed in SPEEDS.items():
        limits = MotionLimits.of(leg, velocity=speed)
        begin = time.perf_counter()
        plan = plan_excitation(leg, limits=limits, noise=NOISE[name], rate=RATE, starts=starts)
        taken = time.perf_counter() - begin
        plans.append(plan)
        print(f"{name}, {label}: planned {line(plan.precision)}, {taken:.0f} s, {starts} starts", flush=True)
        if longer > 1 and speed is None:
            begin = time.perf_counter()
            best = plan_excitation(leg, limits=limits, noise=NOISE[name], rate=RATE, starts=longer * starts)
            ratio, taken = plan.precision.worst / best.precision.worst, time.perf_counter() - begin
            print(f"  {longer} times the starts {line(best.precision)}, {taken:.0f} s; ratio {ratio:.3f}", flush=True)
    plan = plans[0]
    for label, data in documents(leg, name).items():
        theirs = information_of(plan.model, data, TorqueNoise(NOISE[name])).precision(plan.model, plan.precision.scales)
        ratios = ", ".join(
            f"{theirs.worst / p.precision.worst:.1f} × {key}" for key, p in zip(SPEEDS, plans, strict=True)
        )
        print(f"  {label}: {line(theirs)}: {ratios}", flush=True)
    return plan


def line(precision: Precision) -> str:
    """Worst relative standard deviation, and of which parameter."""
    return f"{100.0 * precision.worst:.3g} % ({precision.names[int(np.argmax(precision.relative))]})"


def measure(name: str, plan: Plan, replicates: int) -> None:
    """Let rigs carry the plan out, identify each, and compare the scatter with the prediction."""
    leg, rng = plan.model.leg, np.random.default_rng(1)
    bench = Bench(
        stiff_servo(Plant.build(leg, TRUTH[name])),
        IdealTorque(),
        Sensors(encoder_counts=2.0**16, torque_noise=NOISE[name]),
        Rates(control=500.0, log=RATE, step=1e-3),
    )
    values = []
    for first in range(0, replicates, BATCH):
        plant = Plant.build(leg, TRUTH[name]).repeat(min(BATCH, replicates - first))
        run = run_motion(plant, plan.motions[0].reference, bench, plan.duration, rng)
        values += [exoid.identify(leg, run.recording(k)).values for k in range(plant.count)]
    std = np.std(values, axis=0, ddof=1)
    ratio = std / plan.precision.std
    worst = int(np.argmax(np.abs(np.log(ratio))))
    print(
        f"  {replicates} rigs: measured over predicted std {ratio.min():.3f} to {ratio.max():.3f}, root mean square "
        f"{np.sqrt((ratio**2).mean()):.3f}, farthest {plan.model.names[worst]}; Monte-Carlo error of each "
        f"{1.0 / np.sqrt(2.0 * replicates):.3f}",
        flush=True,
    )


def main() -> None:
    """Read options and run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--legs", default="bleex,cuhk")
    parser.add_argument("--starts", type=int, default=16)
    parser.add_argument("--longer", type=int, default=1, help="times as many starts, to see how far from the best")
    parser.add_argument("--replicates", type=int, default=0, help="rigs that carry the plan out")
    given = parser.parse_args()
    for name in given.legs.split(","):
        plan = compare(name, given.starts, given.longer)
        if given.replicates:
            measure(name, plan, given.replicates)


if __name__ == "__main__":
    main()
