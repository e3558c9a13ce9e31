"""What does stance tell of BLEEX with and without an IMU, on soft soles and on ice? See docs/ground.md.

    python scripts/study_no_imu.py               # 12 seeds, some ten minutes on one core
    python scripts/study_no_imu.py --lean        # the same on ground that rises by -3 to 3 degrees, without IMU
    python scripts/study_no_imu.py --soft        # on softer and softer ground, and on ice, without IMU

Each seed has squats, single support on each leg and a swing, and squats on ice (friction 0.022) with the same noise.
Swing keeps its IMU. Coverage is that of 95 % intervals of all parameters; moves are from dry ground to ice.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import replace

import numpy as np
from figures_over_seeds import print_figures

from exoid.estimate import Estimate
from exoid.experiments.ground import bleex_machine, single_support, squats_and_shifts, swing
from exoid.identification import identify
from exoid.lab.reproduce.stance import TERMS, true_values
from exoid.lab.reproduce.stance_logs import ON_ONE_FOOT, SENSORS, StanceExtent, run_stance
from exoid.leg.catalog import load_exo
from exoid.rig.ground import mujoco_model
from exoid.signals import Recording
from exoid.torques.contacts import split

SLIDES = 0.005
"""A foot that is faster than this slips [m/s]."""


def figures(seed: int) -> dict[str, float]:
    """Figures of one seed."""
    runs, machine = run_stance(seed, StanceExtent(unseen=3.0, walking=3.0)), load_exo("bleex", base="floating")
    truth, swing = true_values(runs.plant), runs.log("swing")
    imu = split(machine, runs.log("squats")).imu
    if imu is not None and swing.base is not None:
        swing = replace(swing, base=imu.corrected(swing.base))
    slip = runs.runs["slipping squats"].feet["left_foot"].slip
    found = {"samples that slip [%]": 100.0 * float(np.mean(slip > SLIDES)), "fastest slip [mm/s]": 1e3 * slip.max()}
    for name, measured in (("IMU", True), ("no IMU", False)):
        dry, ice = (
            identify(machine, [*(_log(log, measured=measured) for log in logs), swing], TERMS)
            for logs in (runs.stance(), [runs.log("slipping squats"), *runs.stance()[1:]])
        )
        true = np.array([truth[parameter] for parameter in dry.names])
        low, high = dry.interval(0.95).T
        found |= {
            f"{name}: parameters in their 95 % interval [%]": 100.0 * float(np.mean((low <= true) & (true <= high))),
            f"{name}: J0, error [%]": 100.0 * abs(dry["J0"].value / truth["J0"] - 1.0),
            f"{name}: largest move on ice [std]": float(np.max(np.abs(ice.values - dry.values) / dry.std)),
            f"{name}: reported on ice [%]": 100.0 * _reported(ice),
            f"{name}: reported on dry ground [%]": 100.0 * _reported(dry),
        }
    soles = [finding.value for finding in dry.findings if finding.kind == "sole-compliance"]
    return found | {"no IMU: compliance of the soles [1e-5 rad/(N·m)]": 1e5 * float(np.mean(soles))}


def without_imu(seed: int, *, degrees: float = 0.0, soft: float = 0.015, ice: float = 0.8) -> dict[str, float]:
    """Figures of one seed on ground that rises forward, on soft ground (time constant of contacts in s), or on ice.

    The swing before hangs on level ground. Feet slide in the squats only: on one foot a slip is no longer alike.
    """
    mujoco_model.SOLE_SOLREF = [soft, 1.0]
    plant = replace(bleex_machine(), ground_lean=np.deg2rad(degrees))
    runs = (
        squats_and_shifts(replace(plant, ground_friction=ice), 15.0, seed=10 * seed),
        *(single_support(plant, 15.0, standing=k, stance=ON_ONE_FOOT, seed=10 * seed + 1 + k) for k in range(2)),
        swing(replace(plant, ground_lean=0.0), 15.0, scale=0.85, seed=10 * seed + 3),
    )
    held = [[link for link in run.wrenches if link == "torso"] for run in runs]
    logs = [run.recording(SENSORS, np.random.default_rng([seed, k]), wrenches=held[k]) for k, run in enumerate(runs)]
    stands = [replace(log, base=None) for log in logs[:3]]
    estimate = identify(load_exo("bleex", base="floating"), [*stands, logs[3]], TERMS)
    truth = true_values(plant)
    true = np.array([truth[parameter] for parameter in estimate.names])
    low, high = estimate.interval(0.95).T
    (lean,) = (finding for finding in estimate.findings if finding.kind == "base-from-feet")
    deviations = (estimate.values - true) / estimate.std
    return {
        "parameters in their 95 % interval [%]": 100.0 * float(np.mean((low <= true) & (true <= high))),
        "errors over their std, rms": float(np.sqrt(np.mean(deviations**2))),
        "largest error over its std": float(np.max(np.abs(deviations))),
        "J0, error [%]": 100.0 * abs(estimate["J0"].value / truth["J0"] - 1.0),
        "X0, error [%]": 100.0 * abs(estimate["X0"].value / truth["X0"] - 1.0),
        "lean that was found [°]": float(lean.value),
        "left out as wrong-contact [%]": 100.0 * _reported(estimate),
        "findings of severity error": float(sum(finding.severity == "error" for finding in estimate.findings)),
    }


def _log(log: Recording, *, measured: bool) -> Recording:
    """Log with or without its IMU."""
    return log if measured else replace(log, base=None)


def _reported(estimate: Estimate) -> float:
    """Largest share of a log that findings name."""
    kinds = ("slipping-contact", "wrong-contact")
    return max((float(finding.value) for finding in estimate.findings if finding.kind in kinds), default=0.0)


def main() -> None:
    """Read the options and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=12)
    parser.add_argument("--lean", action="store_true", help="ground that leans, seeds from 1000 on")
    parser.add_argument("--soft", action="store_true", help="soft ground and ice, seeds from 1000 on")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    cases: dict[str, dict[str, float]] = {}
    if options.lean:
        cases = {f"{degrees:g}°": {"degrees": degrees} for degrees in (-3.0, -0.5, 0.0, 0.5, 3.0)}
    if options.soft:
        cases |= {f"contacts of {soft:g} s": {"soft": soft} for soft in (0.015, 0.04, 0.08)}
        cases |= {f"friction {ice:g}": {"ice": ice} for ice in (0.05, 0.022)}
    for title, case in cases.items():
        seeds = range(1000, 1000 + options.seeds)
        print_figures(f"{title}, {len(seeds)} seeds", [without_imu(seed, **case) for seed in seeds])
    if not cases:
        print_figures(f"{options.seeds} seeds", [figures(seed) for seed in range(options.seeds)])


if __name__ == "__main__":
    main()
