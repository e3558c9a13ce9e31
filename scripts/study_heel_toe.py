"""What does a walk on heel, sole and toe tell of BLEEX? Figures of docs/ground.md.

    python scripts/study_heel_toe.py                   # 16 seeds from 1000, a quarter of an hour on one core
    python scripts/study_heel_toe.py --step 1.25e-4    # on a rig with a quarter of the usual step
    python scripts/study_heel_toe.py --seconds 120     # a longer walk

One simulated walk in a harness whose force is measured, with other noise and another bias of the IMU for each
seed. Friction and rotors are unknown, and nothing but the walk is known. "down" has one switch for each foot; "heel and
toe" two, on soles with edges of 5 mm (those of the rig) and of 0.5 mm.
"""

from __future__ import annotations

import argparse
import re
import warnings
from dataclasses import replace
from functools import partial

import numpy as np

import exoid
from exoid.estimate import Estimate
from exoid.experiments.ground import bleex_machine, planned_motion, walking
from exoid.lab.reproduce.stance import TERMS, WALKING, relative_error, true_values
from exoid.lab.reproduce.stance_logs import FORCE_BIAS, GYRO_BIAS, SENSORS
from exoid.rig import Rates
from exoid.rig.ground import GroundPlant, GroundRun, Sole, simulate_on_ground
from exoid.torques.contacts import split


def switches(run: GroundRun) -> dict[str, np.ndarray]:
    """Switches below heel and toe."""
    found = {}
    for name, foot in run.feet.items():
        place = np.einsum("nij,ni->nj", foot.rotation, np.nan_to_num(foot.centre_of_pressure) - foot.position)[:, 0]
        loaded = foot.force[:, 2] > SENSORS.switch_force
        for edge, side in (("heel", place < 0.0), ("toe", place > 0.0)):
            found[f"{name}_{edge}"] = loaded & ((foot.points == 2) | side)
    return found


def machine(plant: GroundPlant) -> exoid.Leg:
    """BLEEX whose heels and toes are known: the middle of their edges."""
    places = {
        f"{foot}_{edge}": tuple(np.add(point, (0.0, 0.0, sole.radius)))
        for foot, sole in plant.soles.items()
        for edge, point in zip(("heel", "toe"), sole.points, strict=True)
    }
    exo = exoid.load_exo("bleex", base="floating")
    return exoid.Leg.from_description(exo.description, exo.joint_names, base="floating", contacts=places)


def used(leg: exoid.Leg, log: exoid.Recording, estimate: Estimate) -> float:
    """Share of the samples of stance that count."""
    wrong = {
        re.findall("samples with (.*) do not fit", each.message)[0]: float(each.value)
        for each in estimate.findings
        if each.kind == "wrong-contact" and "do not fit" in each.message
    }
    parts = ((" and ".join(part.links), np.asarray(part.recording.mask)) for part in split(leg, log, WALKING).stretches)
    count = sum(np.count_nonzero(mask) * (1.0 - wrong.get(links, 0.0)) for links, mask in parts if links)
    return count / np.count_nonzero(np.any(list(log.contacts.values()), axis=0))


def figures(leg: exoid.Leg, run: GroundRun, seed: int, *, kinds: bool, known: bool) -> dict[str, float]:
    """Figures of one seed."""
    log, truth = run.recording(SENSORS, seed, wrenches=("torso",)), true_values(run.plant)
    sizes = np.repeat([GYRO_BIAS, FORCE_BIAS], 3) * np.random.default_rng([seed, 99]).standard_normal(6)
    gyro, force = log.base.angular_velocity, log.base.specific_force
    biased = replace(log.base, angular_velocity=gyro + sizes[:3], specific_force=force + sizes[3:])
    log = replace(log, base=replace(log.base, calibrated=True) if known else biased)
    log = replace(log, contacts=switches(run)) if kinds else log
    found = exoid.identify(leg, log, TERMS, preparation=WALKING, check=False)
    true = np.array([truth[name] for name in found.names])
    low, high = found.interval(0.95).T
    share = {symbol: 100.0 * relative_error(found.names, found.values - true, truth, symbol) for symbol in "MXJ"}
    inside = 100.0 * float(np.mean((low <= true) & (true <= high)))
    return {**share, "in 95 %": inside, "used": 100.0 * used(leg, log, found)}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--first", type=int, default=1000, help="first seed; tune below 1000")
    parser.add_argument("--step", type=float, default=5e-4, help="step of the simulation [s]")
    parser.add_argument("--seconds", type=float, default=120.0, help="length of the walk [s]")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rates = Rates(control=1.0 / options.step, log=500.0, step=options.step)
    planned_motion.simulate_on_ground = partial(simulate_on_ground, rates=rates)
    title = f"{options.seeds} seeds from {options.first}, {options.seconds:g} s in steps of {1e3 * options.step:g} ms"
    print(f"{title}: P95 of the largest error [%], means of the others [%]")
    print(f"{'':44s} {'M':>7} {'X':>7} {'J':>7} {'in 95 %':>8} {'used':>6}")
    for radius, cases in ((0.005, ((False, True), (False, False), (True, True))), (0.0005, ((True, True),))):
        plant = bleex_machine()
        plant = replace(plant, soles={name: Sole(sole.points, radius) for name, sole in plant.soles.items()})
        run, leg = walking(plant, options.seconds), machine(plant)
        for kinds, known in cases:
            seeds = range(options.first, options.first + options.seeds)
            each = [figures(leg, run, seed, kinds=kinds, known=known) for seed in seeds]
            p95 = [f"{np.quantile([one[key] for one in each], 0.95):7.3f}" for key in "MXJ"]
            mean = [float(np.mean([one[key] for one in each])) for key in ("in 95 %", "used")]
            what = f"{'heel and toe' if kinds else 'down'}, edges {1e3 * radius:g} mm"
            title = f"{what}, bias {'known' if known else 'unknown'}"
            print(f"{title:44s} {' '.join(p95)} {mean[0]:8.1f} {mean[1]:6.1f}", flush=True)


if __name__ == "__main__":
    main()
