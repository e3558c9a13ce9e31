"""Stance law with the truth, the identified model and CAD on the rig with ground. Figures of docs/stance-control.md.

    python scripts/study_on_ground.py                       # 16 seeds from 1000 of both machines
    python scripts/study_on_ground.py --seeds 2 --machine bleex

The truth of each seed has the mass of every link drawn (± 8 %, one standard deviation) and friction (± 20 %). The
identified model is that of logs with noise: squats, both single supports and swing of BLEEX; of CUHK-EXO a swing in a
stand whose force is measured. CAD is the model of the package without friction. All laws follow the same reference,
planned with the truth, at 500 Hz, and read noisy encoders, IMU and switches.
"""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from dataclasses import replace

import numpy as np
import pinocchio as pin
from joblib import Parallel, delayed

import exoid
from exoid._typing import FloatArray
from exoid.control.ground import SOLES, GroundLoop, share_course, stance
from exoid.errors import ExoidError
from exoid.experiments import ground
from exoid.experiments.ground.planned_motion import follow, knots, planned_motion, wave
from exoid.experiments.ground.posture import planar_legs
from exoid.experiments.ground.stance import CLAMP, SWING_GAINS
from exoid.rig.ground import GroundMotion, GroundPlant, GroundReading, GroundRun, GroundSensors, simulate_on_ground
from exoid.rig.simulate import Rates

RATES = Rates(control=500.0, log=500.0, step=5e-4)
TERMS = (exoid.Coulomb(smoothing=0.02), exoid.Viscous(), exoid.Armature())
ONE_FOOT = ground.Stance(squat=0.03, shift=0.01, bow=0.05, swing=0.22)
CUHK_FRICTION = {"c0": (1.445, 0.593), "d": (0.038, 0.192), "Ia": (0.8, 0.8)}
SENSORS = GroundSensors(angle_noise=3e-5)  # encoders of 65 536 counts
LIFT, DOWN = 1.5, 3.0
"""Times at which the right foot of BLEEX leaves the ground and is planned to be back [s]."""


def drawn(leg: exoid.Leg, rng: np.random.Generator) -> exoid.Leg:
    """Draw the masses of all links."""
    model = leg.model.copy()
    for j, inertia in enumerate(model.inertias):
        f = np.exp(0.08 * rng.standard_normal())
        model.inertias[j] = pin.Inertia(f * inertia.mass, inertia.lever, f * inertia.inertia)
    return replace(leg, model=model)


def truth_of(machine: str, rng: np.random.Generator) -> GroundPlant:
    """Draw a machine."""
    table = ground.machines.RESISTANCES if machine == "bleex" else CUHK_FRICTION
    leg = drawn(exoid.load_exo(machine, "identified" if machine == "bleex" else None, base="floating"), rng)
    sizes = {name: table[name.split("_")[0]] for name in (f"{s}_{x}" for s in table for x in leg.joint_labels)}
    each = len(next(iter(table.values())))
    values = {name: row[k % each] * np.exp(0.2 * rng.standard_normal()) for k, (name, row) in enumerate(sizes.items())}
    return GroundPlant.build(leg, SOLES[machine], values)


def identified(machine: str, truth: GroundPlant, seed: int) -> exoid.Estimate:
    """Identify a machine from logs with noise."""
    if machine == "cuhk":
        rng, t = np.random.default_rng(seed), knots(15.0)
        q = np.array([0.3, 0.8, 0.3, 0.8]) + np.column_stack([wave(t, 0.35, f, rng) for f in (0.6, 0.72, 0.66, 0.8)])
        base = np.column_stack([0.0 * t, 1.4 + wave(t, 0.03, 0.8, rng), wave(t, 0.15, 0.5, rng)])
        run = follow(truth, planned_motion(truth, t, q, base, {}), SWING_GAINS_CUHK, spring=CLAMP)
        log = run.recording(replace(SENSORS, torque_noise=(0.5, 0.4)), seed)
        return exoid.identify(exoid.load_exo("cuhk", base="floating"), log, TERMS, check=False)
    runs = {
        "squats": ground.squats_and_shifts(truth, 10.0, seed=seed),
        "left": ground.single_support(truth, 10.0, standing=0, stance=ONE_FOOT, seed=seed + 1),
        "right": ground.single_support(truth, 10.0, standing=1, stance=ONE_FOOT, seed=seed + 2),
        "swing": ground.swing(truth, 10.0, scale=0.85, seed=seed + 3),
    }
    logs = [run.recording(seed=seed + k, wrenches=set(run.wrenches) & {"torso"}) for k, run in enumerate(runs.values())]
    return exoid.identify(exoid.load_exo("bleex", base="floating"), logs, TERMS, check=False)


SWING_GAINS_CUHK = replace(SWING_GAINS, stiffness=(600.0, 400.0), damping=(30.0, 20.0))


def cuhk_motion(truth: GroundPlant, seed: int) -> GroundMotion:
    """Plan squats of CUHK-EXO with one foot 0.3 m before the other; its ankles are points."""
    rng, t = np.random.default_rng(seed), knots(5.0)
    x, z = wave(t, 0.02, 0.6, rng), 0.76 + wave(t, 0.03, 0.5, rng)
    pitch, q = wave(t, 0.06, 0.42, rng) - 0.05, []
    for foot in (0.15, -0.15):
        way, upper, lower = foot - x - 1j * z, 0.4165, 0.4182  # down is −i, forward 1
        knee = np.arccos((np.abs(way) ** 2 - upper**2 - lower**2) / (2.0 * upper * lower))
        thigh = np.angle(way) - np.angle(upper + lower * np.exp(-1j * knee)) + np.pi / 2
        q += [thigh - pitch, knee]
    base = np.column_stack([x, z, pitch])
    return planned_motion(truth, t, np.column_stack(q), base, {})


def step_motion(truth: GroundPlant) -> GroundMotion:
    """Plan one step of BLEEX in place: the right foot rises by 6 cm and comes back, 2 mm too deep for 0.6 s."""
    t = knots(5.0)
    motion = ground.stance_motion(truth, 5.0, stance=ground.Stance(squat=0.0, shift=0.0, bow=0.0))
    up = share_course((t - LIFT) / 0.5) - share_course((t - DOWN + 1.0) / 1.0)
    deep = share_course((t - DOWN + 0.3) / 0.3) - share_course((t - DOWN - 0.6) / 0.3)
    q, leg = motion.q.copy(), planar_legs(truth)[1]
    height = 0.06 * up - 0.002 * deep
    q[:, leg.joints] = leg.angles(motion.base, 1j * height, np.zeros(len(t)))
    return replace(motion, q=q)


def step_shares(now: float) -> dict[str, float]:
    """Share of the right foot: none while it is up."""
    going = 1.0 - float(share_course((now - LIFT + 0.5) / 0.5))
    return {"right_foot": going if now < DOWN - 0.4 else 1.0}


class Probe(GroundLoop):
    """Loop that notes by how much a change of contacts alone moves the torque, in the same state."""

    own: float = 0.0

    def __call__(self, reading: GroundReading) -> FloatArray:
        """Compute the torque, and again with the contacts of the last sample where they have changed."""
        before, torque = self.state, super().__call__(reading)
        now = self.state
        if reading.time > 0.0 and before and now and now.contacts and set(before.contacts) ^ set(now.contacts):
            same = now._replace(contacts=before.contacts, shares=before.shares)
            self.own = max(self.own, float(np.abs(torque - self.law.torque(same, self.target(reading.time))).max()))
        return torque


def figures(loop: Probe, run: GroundRun) -> dict[str, float]:
    """Figures of one run."""
    wanted = [loop.target(t) for t in run.time]
    pitch = np.arctan2(run.rotation[:, 2, 0], run.rotation[:, 0, 0])
    q = 1e3 * (run.q - np.array([t.q for t in wanted]))
    out = {"joints [mrad]": float(np.sqrt((q**2).mean())), "largest joint [mrad]": float(np.abs(q).max())}
    out["torso [mrad]"] = 1e3 * float(np.sqrt(np.mean((pitch - [t.pitch for t in wanted]) ** 2)))
    changes, tipped, slipped, used = np.zeros(len(run.time), dtype=bool), 0, 0, 0.0
    for link, foot in run.feet.items():
        settled = np.convolve(foot.touching, np.ones(101), "same") > 100.5  # 0.1 s around touch-down and lift-off
        tipped += int(np.count_nonzero(settled & (foot.points < len(run.plant.soles[link].points))))
        slipped += int(np.count_nonzero(settled & (foot.slip > 0.005)))
        loaded = settled & (foot.force[:, 2] > 20.0)
        used = max(used, float((np.abs(foot.force[loaded, 0]) / foot.force[loaded, 2]).max(initial=0.0)))
        change = np.flatnonzero(np.diff(foot.touching))
        changes[(change[:, None] + np.arange(-10, 11)).clip(0, len(changes) - 1)] = True
    out |= {"samples tipped": tipped, "samples slipped": slipped, "friction used, of 0.8": used}
    steps = np.abs(np.diff(run.tau, axis=0))[changes[1:]]
    out["step by change of contact [N·m]"] = loop.own
    out["step by change of contact [% of range]"] = 100.0 * loop.own / float(np.ptp(run.tau, axis=0).max())
    out["step at changes [N·m]"] = float(steps.max()) if len(steps) else 0.0
    out["step at changes [% of range]"] = 100.0 * float((steps / np.ptp(run.tau, axis=0)).max()) if len(steps) else 0.0
    out["infeasible [%]"] = 100.0 * float(np.mean([not (c and c.feasible) for c in loop.commands]))
    return out


def one(machine: str, seed: int) -> dict[tuple[str, str, str], float]:
    """All figures of a seed, by motion, model and name."""
    warnings.simplefilter("ignore")
    rng = np.random.default_rng(seed)
    truth = truth_of(machine, rng)
    models = {"truth": truth, "identified": identified(machine, truth, 10 * seed)}
    models["CAD"] = exoid.load_exo(machine, base="floating")
    if machine == "bleex":
        motions = {"squats": (ground.stance_motion(truth, 5.0, seed=seed), None)}
        motions["step"] = step_motion(truth), step_shares
    else:
        motions = {"squats": (cuhk_motion(truth, seed), None)}
    out = {}
    for motion, (reference, shares) in motions.items():
        for model, source in models.items():
            loop = Probe(stance(source), reference, shares)
            try:
                run = simulate_on_ground(truth, reference, loop, rates=RATES, sensors=SENSORS, seed=seed)
            except ExoidError:
                out[motion, model, "falls"] = 1.0
                continue
            found = figures(loop, run)
            found["falls"] = float(found["largest joint [mrad]"] > 500.0)
            out |= {(motion, model, name): value for name, value in found.items()}
    return out


def main() -> None:
    """Read the options and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--first", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--machine", choices=("bleex", "cuhk"), default=None)
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    for machine in (options.machine,) if options.machine else ("bleex", "cuhk"):
        begun = time.perf_counter()
        found = []
        for each in Parallel(n_jobs=options.jobs, return_as="generator")(delayed(one)(machine, s) for s in seeds):
            found.append(each)
            print(f"{machine}: {len(found)} of {options.seeds} seeds", file=sys.stderr)
        print(f"{machine}: {options.seeds} seeds from {options.first}; mean and worst of each model")
        for motion, name in dict.fromkeys((m, n) for m, _, n in (key for each in found for key in each)):
            cells = []
            for model in ("truth", "identified", "CAD"):
                values = np.array([each[motion, model, name] for each in found if (motion, model, name) in each])
                cells.append(f"{values.mean():9.3g} {values.max():9.3g}" if len(values) else " " * 19)
            print(f"{motion:7s} {name:38s}" + "  |".join(cells))
        for motion in dict.fromkeys(m for m, _, _ in found[0]):
            for name in ("joints [mrad]", "torso [mrad]"):
                rows = [
                    [each.get((motion, model, name), np.nan) for model in ("truth", "identified", "CAD")]
                    for each in found
                ]
                truth, identified, cad = np.array(rows).T
                print(
                    f"{motion:7s} {name:38s} identified/truth {np.nanmax(identified / truth):.3f} (worst), "
                    f"identified/CAD {np.nanmax(identified / cad):.3f} (worst)"
                )
        print(f"{time.perf_counter() - begun:.0f} s")


if __name__ == "__main__":
    main()
