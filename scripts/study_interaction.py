"""How well is the torque of a wearer found, does its band hold the truth, and is an unworn leg called worn?

    python scripts/study_interaction.py --seeds 16            # torque of active and passive wearers, some minutes
    python scripts/study_interaction.py --parts --seeds 4     # what the error comes of
    python scripts/study_interaction.py --unworn --seeds 40   # false alarms; friction of other forms, fast motion

BLEEX and CUHK-EXO on the rig, with friction that sticks. Each seed is one training of 60 s without a wearer (five
harmonics of 0.3 Hz under a servo) and one worn log: "active", a wearer who walks at 2.4 s a stride while the
exoskeleton carries its own weight; "passive", a limb that the servo moves. Cuffs have 1000 N·m/rad and
30 N·m·s/rad. Sensors: angles 2e-5 rad and 16 bits; torques 0.5, 0.4 and 0.2 N·m; controller and log at 500 Hz. The
rig logs the torque of the interval before a sample: half an interval is taken out. NRMSE is the RMS error over the
standard deviation of the true torque.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from study_bands import FORMS
from study_bands import log as log_of_form

import exoid
from exoid.rig import Run, Wearer
from exoid.tools.tables import make_table, to_text

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from worn_rig import (
    Machine,
    active,
    alone,
    at,
    at_samples,
    cad_torque,
    gait,
    log,
    machine,
    nrmse,
    passive,
    true_values,
)

LEGS = ("bleex", "cuhk")

WHO = ("leg", "wearer", "joint")
OWN = ("RMS [N·m]", "error [N·m]", "NRMSE", "largest", "noise alone", "unfiltered", "CAD", "in band [%]", "worn [%]")
"""Columns: NRMSE against the truth behind the same filter, its largest of all seeds, the part that the noise of the
torque sensor alone has, and NRMSE against the truth unfiltered."""

Array = NDArray[np.float64]


def torques(name: str, seeds: list[int]) -> list[tuple[str, ...]]:
    """Error and coverage of the torque of active and passive wearers, one row a kind and joint."""
    one = machine(name)
    trained = alone(one, seeds)
    estimates = [exoid.identify(one.plant.leg, log(trained, k), one.terms) for k in range(len(seeds))]
    limb = Wearer.build(one.plant.leg)
    runs = {"active": active(one, seeds), "passive": passive(one, seeds, limb, 30.0, motion=gait(one, seeds))}
    rows = []
    for kind, run in runs.items():
        each = [_own(one, estimate, run, k) for k, estimate in enumerate(estimates)]
        for j, joint in enumerate(one.plant.leg.joint_labels):
            figures = {key: np.array([found[key][j] for found in each]) for key in each[0]}
            rows.append((name, kind, joint, *_cells(figures)))
    return rows


def _own(one: Machine, estimate: exoid.Estimate, run: Run, k: int) -> dict[str, Array]:
    """Figures of one log behind the filter of the estimate, (n,) each."""
    recording, whole = log(run, k), run.interaction[..., k]
    found = exoid.interaction(estimate, recording)
    truth = at(estimate, recording, whole, found.time)
    noise = one.noise * np.sqrt(estimate.preparation.independent_fraction(recording.sample_rate))
    return {
        "RMS [N·m]": np.sqrt((truth**2).mean(axis=0)),
        "error [N·m]": np.sqrt(((found.torque - truth) ** 2).mean(axis=0)),
        "NRMSE": nrmse(found.torque, truth),
        "largest": nrmse(found.torque, truth),
        "noise alone": noise / truth.std(axis=0),
        "unfiltered": nrmse(found.torque, at_samples(recording, whole, found.time)),
        "CAD": nrmse(cad_torque(one, estimate, recording, found.time), truth),
        "in band [%]": 100.0 * (np.abs(found.torque - truth) <= found.band).mean(axis=0),
        "worn [%]": np.full(len(one.noise), 100.0 * bool(found.worn)),
    }


def _cells(figures: dict[str, Array]) -> list[str]:
    """Write the mean of each figure over the seeds, and the largest where asked for."""
    digits = {"in band [%]": 1, "worn [%]": 0, "CAD": 2, "cut-off [Hz]": 1}
    return [
        f"{(values.max() if key == 'largest' else values.mean()):.{digits.get(key, 3)}f}"
        for key, values in figures.items()
    ]


def parts(name: str, seeds: list[int]) -> list[tuple[str, ...]]:
    """Error of the torque with exact sensors, with true parameters, and with both, one row a kind and joint [N·m]."""
    one, rows = machine(name), []
    trained, limb = alone(one, seeds), Wearer.build(one.plant.leg)
    estimates = [exoid.identify(one.plant.leg, log(trained, k), one.terms) for k in range(len(seeds))]
    for kind, run in (
        ("active", active(one, seeds)),
        ("passive", passive(one, seeds, limb, 30.0, motion=gait(one, seeds))),
    ):
        exact = replace(run, q_measured=run.q, tau_measured=run.tau)
        each = []
        for k, estimate in enumerate(estimates):
            true = replace(estimate, values=true_values(one, estimate.names))
            errors = []
            for source, model in ((run, estimate), (exact, estimate), (run, true), (exact, true)):
                found = exoid.interaction(model, log(source, k))
                truth = at(estimate, log(run, k), run.interaction[..., k], found.time)
                errors.append(np.sqrt(((found.torque - truth) ** 2).mean(axis=0)))
            noise = one.noise * np.sqrt(estimate.preparation.independent_fraction(1.0 / np.diff(run.time).mean()))
            each.append([*errors, noise])
        mean = np.mean(each, axis=0).T
        rows += [
            (name, kind, joint, *(f"{x:.3f}" for x in of_joint))
            for joint, of_joint in zip(one.plant.leg.joint_labels, mean, strict=True)
        ]
    return rows


def unworn(seeds: int) -> list[tuple[str, ...]]:
    """False alarms on the rig, and with friction of other forms at once and twice the speed of the training."""
    rows = []
    for name in LEGS:
        one, numbers = machine(name), list(range(seeds))
        trained, again = alone(one, numbers), alone(one, [100 + k for k in numbers], draw=4)
        walk = alone(one, numbers, 30.0, motion=gait(one, numbers), draw=5)
        estimates = [exoid.identify(one.plant.leg, log(trained, k), one.terms) for k in numbers]
        for kind, run in (("rig, other harmonics", again), ("rig, gait", walk)):
            found = [exoid.interaction(e, log(run, k)) for k, e in enumerate(estimates)]
            rows.append(_alarms(f"{name}, {kind}", found))
        leg = one.cad
        for form in FORMS:
            models = [exoid.identify(leg, log_of_form(leg, form, 0.1, seed)) for seed in range(min(seeds, 5))]
            for times in (1.0, 2.0):
                tests = [log_of_form(leg, form, 0.1 * times, 100 + seed) for seed in range(len(models))]
                found = [exoid.interaction(model, one_log) for model, one_log in zip(models, tests, strict=True)]
                rows.append(_alarms(f"{name}, {form}, {times:g} × speed", found))
    return rows


def _alarms(label: str, found: list[exoid.Interaction]) -> tuple[str, ...]:
    """Label, number of logs, false alarms, torque over the smallest that is noticed, largest share outside the band."""
    ratios = [np.std(each.torque[:, j]) / action.least for each in found for j, action in enumerate(each.actions)]
    return (
        label,
        str(len(found)),
        str(sum(bool(each.worn) for each in found)),
        f"{np.mean(ratios):.2f}",
        f"{np.max(ratios):.2f}",
        f"{100.0 * np.max([(np.abs(each.torque - each.mean) > each.band).mean(axis=0) for each in found]):.1f}",
    )


def main() -> None:
    """Read the options and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--parts", action="store_true", help="parts of the error instead")
    parser.add_argument("--unworn", action="store_true", help="false alarms instead")
    options = parser.parse_args()
    seeds = list(range(options.seeds))
    if options.unworn:
        headers, rows = (
            ("logs", "number", "called worn", "mean torque / least", "largest", "outside [%]"),
            unworn(options.seeds),
        )
    elif options.parts:
        headers = (*WHO, "error [N·m]", "exact sensors", "true parameters", "both", "noise alone")
        rows = [row for name in LEGS for row in parts(name, seeds)]
    else:
        print("Both torques behind the filter of the estimate")
        headers, rows = (*WHO, *OWN), [row for name in LEGS for row in torques(name, seeds)]
    print(to_text(make_table(headers, rows)))


if __name__ == "__main__":
    main()
