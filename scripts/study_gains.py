"""What compensation is worth with default gains: PD beside PD with gravity and friction, on legs drawn by seed.

Each leg has two or three joints, 3 to 20 kg, Coulomb friction of 3 to 30 % of its weight's torque, and rotors from a
hundredth to the whole inertia of the segments. Its gait is that of ``exoid track``, in which an ankle is held at zero.
Friction is compensated at the desired velocity (the default) and at the measured one, as document 2 does.

    OMP_NUM_THREADS=1 python scripts/study_gains.py --seeds 1000 1001 1002 1003 1004 1005
"""

from __future__ import annotations

import argparse

import numpy as np

import exoid
from exoid.control import SMOOTH, Tracking, compare_laws, default_gains, gravity_friction_pd, mean_pose, pd
from exoid.control.standard_laws import SENSORS
from exoid.experiments import gait_for_leg, healthy_gait
from exoid.experiments.gait import fit_to_limits
from exoid.leg.description import describe
from exoid.rig import Plant
from exoid.tools.tables import make_table, to_text

LIMITS = {"hip": (-0.7, 1.9), "knee": (-2.1, 0.05), "ankle": (-0.8, 0.8)}


def drawn_leg(seed: int) -> Plant:
    """Draw a leg with friction and rotors."""
    rng = np.random.default_rng(seed)
    names = tuple(LIMITS)[: int(rng.integers(2, 4))]
    n = len(names)
    length = np.array([0.40, 0.40, 0.12])[:n] * rng.uniform(0.85, 1.15)
    size = np.exp(rng.uniform(np.log(0.4), np.log(2.5)))
    mass = np.array([4.0, 2.5, 1.0])[:n] * size * rng.uniform(0.6, 1.5, n)
    text, parent, height = '<link name="torso"/>', "torso", 0.0
    for name, m, along in zip(names, mass, length, strict=True):
        x, z = (rng.uniform(0.02, 0.08), -0.05) if name == "ankle" else (0.0, -along * rng.uniform(0.3, 0.7))
        gyration = m * (along * rng.uniform(0.25, 0.35)) ** 2
        low, high = LIMITS[name]
        text += (
            f'<link name="{name}_link"><inertial><origin xyz="{x} 0 {z}"/><mass value="{m}"/><inertia ixx="{gyration}" '
            f'ixy="0" ixz="0" iyy="{gyration}" iyz="0" izz="{gyration / 5}"/></inertial></link>'
            f'<joint name="{name}" type="revolute"><origin xyz="0 0 {height}"/><parent link="{parent}"/>'
            f'<child link="{name}_link"/><axis xyz="0 -1 0"/>'
            f'<limit lower="{low}" upper="{high}" effort="200" velocity="12"/></joint>'
        )
        parent, height = f"{name}_link", -along
    leg = exoid.Leg.from_description(describe(f'<robot name="leg {seed}">{text}</robot>'), names)
    weight = np.abs(leg.gravity(rng.uniform(-0.6, 0.6, (50, n)))).max(axis=0)
    values = {}
    for joint, name in enumerate(names):
        friction = weight[joint] * rng.uniform(0.03, 0.3)
        inertia = leg.parameters[leg.parameter_names.index(f"J{joint + 1}")]
        values |= {f"c0_{name}": friction, f"d_{name}": friction * rng.uniform(0.2, 1.0)}
        values[f"Ia_{name}"] = inertia * float(np.exp(rng.uniform(np.log(0.01), 0.0)))
    return Plant.build(leg, values)


def track(plant: Plant, period: float) -> dict[str, Tracking]:
    """Follow the gait with each controller."""
    gait = fit_to_limits(plant.leg, gait_for_leg(plant.leg, healthy_gait(0.8, period)))
    kp, kd = default_gains(plant, mean_pose(gait, period))
    laws = {
        "pd": pd(kp, kd),
        "desired": gravity_friction_pd(plant, kp, kd),
        "measured": gravity_friction_pd(plant, kp, kd, friction=SMOOTH),
    }
    return compare_laws(plant, laws, gait, 2.0 * period, sensors=SENSORS, settle=period)


def main() -> None:
    """Print errors of each leg and joint, and how many joints are worse with compensation."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[*range(1000, 1006)])
    parser.add_argument("--periods", type=float, nargs="+", default=[10.0, 4.0, 2.0])
    given = parser.parse_args()
    for period in given.periods:
        rows, worse = [], {"desired": 0, "measured": 0}
        for seed in given.seeds:
            runs = track(drawn_leg(seed), period)
            for joint, name in enumerate(runs["pd"].joint_names):
                errors = {law: (run.peak_deg[joint], run.rms_deg[joint]) for law, run in runs.items()}
                for law in worse:
                    worse[law] += any(own > plain for own, plain in zip(errors[law], errors["pd"], strict=True))
                rows.append((f"{seed} {name}", *(f"{peak:.1f} / {rms:.1f}" for peak, rms in errors.values())))
        headers = ("leg", "PD", "+ G + F, desired", "+ G + F, measured")
        print(to_text(f"gait of {period:g} s: peak / rms error [deg]", make_table(headers, rows)))
        print(f"\nworse than PD, of {len(rows)} joints: {worse['desired']} desired, {worse['measured']} measured\n")


if __name__ == "__main__":
    main()
