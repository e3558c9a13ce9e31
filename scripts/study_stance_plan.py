"""Do predictions of plans on the ground hold, and does a rig follow them? How was the protocol found?

BLEEX on both feet and on each foot, 60 s in total, as ``exoid plan bleex --stance both,left,right --noise
0.5,0.4,0.2,0.5,0.4,0.2`` plans it. The scenarios are as long, and their hand rail is logged. Needs extra ``ground``.

    OMP_NUM_THREADS=1 python scripts/study_stance_plan.py
    OMP_NUM_THREADS=1 python scripts/study_stance_plan.py --changes 150     # random changes of the protocol on one foot
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import Any

import numpy as np

import exoid
from exoid.errors import ExoidError
from exoid.experiments.excitation import StancePlan, plan_stance, run_stance
from exoid.experiments.excitation.precision import information_of
from exoid.experiments.ground import protocol, single_support, squats_and_shifts
from exoid.rig.ground import GroundPlant, GroundSensors
from exoid.rig.ground.plant import BLEEX_SOLES

STD = (0.5, 0.4, 0.2) * 2
TORSO = ("M", "X0", "Y0", "J0")
FEET = ("both", "left", "right")


def main() -> None:
    """Print all comparisons, or the course of a search for a better protocol."""
    parser = argparse.ArgumentParser(description="Plans on the ground.")
    parser.add_argument("--seeds", type=int, default=8, help="Identifications of noisy logs.")
    parser.add_argument("--changes", type=int, default=0, help="Random changes of the protocol that are tried.")
    options = parser.parse_args()
    exo = exoid.load_exo("bleex", base="floating")
    if options.changes:
        change(exo, options.changes)
        return
    plan = plan_stance(exo, feet=FEET, noise=STD)
    print(plan.precision)
    compare(plan, exo)
    scatter(plan, exo, options.seeds)
    follow(plan, exo)


def change(exo: exoid.Leg, count: int) -> None:
    """Change the protocol on one foot at random, and keep what makes the worst standard deviation smaller."""
    rng, best = np.random.default_rng(0), np.inf

    def jittered(x: Any, size: float) -> Any:  # noqa: ANN401 - numbers, and tuples of them
        """Multiply each number by about 1."""
        if isinstance(x, protocol.Wave):
            return protocol.Wave(*(jittered(each, size) for each in x))
        return tuple(jittered(each, size) for each in x) if isinstance(x, tuple) else x * rng.normal(1.0, size)

    for number in range(count + 1):
        before, size = protocol.ON_ONE_FOOT, float(rng.choice([0.05, 0.15, 0.4])) if number else 0.0
        chosen = {name: jittered(value, size) for name, value in vars(before).items() if rng.random() < 0.5}
        protocol.ON_ONE_FOOT = replace(before, **chosen)
        try:
            worst = plan_stance(exo, feet=FEET, noise=STD).precision.worst
        except ExoidError:
            worst = np.inf
        if worst < best:
            best = worst
            print(f"{number}: {100.0 * worst:.3f} % {protocol.ON_ONE_FOOT}", flush=True)
        else:
            protocol.ON_ONE_FOOT = before


def compare(plan: StancePlan, exo: exoid.Leg) -> None:
    """Precision of the scenarios of the rig, as long."""
    plant = GroundPlant.build(exo, BLEEX_SOLES)
    runs = [squats_and_shifts(plant, 20.0, seed=1)]
    runs += [single_support(plant, 20.0, seed=2 + leg, standing=leg) for leg in (0, 1)]
    logs = [run.recording(GroundSensors.exact(), wrenches={*run.wrenches} - {*BLEEX_SOLES}) for run in runs]
    before = information_of(plan.model, logs, plan.noise).precision(plan.model, plan.precision.scales)
    print(f"scenarios: {before}, {before.worst / plan.precision.worst:.2f} times the planned")
    for name, std, planned in zip(before.names, before.std, plan.precision.std, strict=True):
        if name in TORSO or name[0] in "XYJ":
            print(f"  {name}: planned {planned:.2g}, scenarios {std:.2g}, {std / planned:.2f} times")


def scatter(plan: StancePlan, exo: exoid.Leg, seeds: int) -> None:
    """Measured over predicted standard deviation of identifications of logs with torque noise."""
    truth, errors = plan.precision.scales.expected, []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        logs = [replace(log, tau=log.tau + STD * rng.standard_normal(log.tau.shape)) for log in plan.recordings]
        errors.append(exoid.identify(exo, logs, plan.model.terms).values - truth)
    relative = np.array(errors) / plan.precision.std
    kinds = np.array([name if name in TORSO else name.split("_")[0][0] for name in plan.model.names])
    print(f"measured over predicted standard deviation, {seeds} seeds: {np.sqrt(np.mean(relative**2)):.2f}")
    for kind in dict.fromkeys(kinds):
        print(f"  {kind}: {np.sqrt(np.mean(relative[:, kinds == kind] ** 2)):.2f}")


def follow(plan: StancePlan, exo: exoid.Leg) -> None:
    """Identification of a simulated machine that follows the plan without a hand rail, with an IMU."""
    runs = run_stance(plan)
    flat = [run.fixed(foot).mean() for run, one in zip(runs, plan.motions, strict=True) for foot in one.feet]
    logs = [run.recording(GroundSensors(), seed=k, wrenches=()) for k, run in enumerate(runs)]
    found = exoid.identify(exo, logs, plan.model.terms)
    off = [f"{name} {found[name].value / value - 1.0:+.2%}" for name, value in zip(TORSO, exo.parameters, strict=False)]
    print(f"on the rig: feet flat in {min(flat):.1%} of the samples; {', '.join(off)}")


if __name__ == "__main__":
    main()
