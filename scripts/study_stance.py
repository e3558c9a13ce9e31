"""What do swing, stance and walking tell of BLEEX, over many seeds? Figures of docs/replays.md.

    python scripts/study_stance.py                       # 16 seeds, about ten minutes on two cores
    python scripts/study_stance.py --seeds 2 --jobs 1
    python scripts/study_stance.py --walk                # the walk alone, with the true friction and rotors: a minute
    python scripts/study_stance.py --walkers             # walkers drawn by seeds from 1000 on, on five kinds of ground
    python scripts/study_stance.py --faults --seeds 5    # the same walkers, with faults and mistakes

Each seed is one `exoid reproduce stance`: other motions, noise and bias of the IMU. Errors are the 95 % quantile over
the seeds of the largest one of a seed; coverage is that of 95 % intervals of all parameters.
"""

from __future__ import annotations

import argparse
import re
import warnings
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import chain
from typing import NamedTuple

import numpy as np
import scipy
from joblib import Parallel, delayed

from exoid import BaseMotion, ExoidError, Leg, Recording, ground_forces, identify, load_exo, load_leg, validate
from exoid.estimate.ground_prediction import level_wrench
from exoid.experiments.ground import Stance, bleex_machine, single_support, stance_motion, swing, walking
from exoid.experiments.ground.machines import RESISTANCES
from exoid.experiments.ground.planned_motion import follow
from exoid.experiments.ground.stance import GAINS, HAND_RAIL
from exoid.lab.reproduce import StanceExtent, reproduce_stance
from exoid.lab.reproduce.stance import SIDES, TERMS, WALKING, StanceReplay, relative_error, swinging_leg, true_values
from exoid.lab.reproduce.stance_logs import FORCE_BIAS, GYRO_BIAS, SENSORS
from exoid.lab.reproduce.stance_report import walk_error
from exoid.rig.ground import GroundPlant, GroundRun, Sole, mujoco_model

LIMITS = {
    "no plates: M [%]": 0.5,
    "no plates: X [%]": 0.5,
    "no plates: J [%]": 3.0,
    "plates: M [%]": 0.2,
    "vertical force [% of weight]": 0.5,
    "centre of pressure [mm]": 5.0,
    "swing rows of a walk: X [%]": 0.5,
    "swing rows of a walk: J [%]": 3.0,
    "wrong labels: moved [std]": 1.0,
    "slipping: moved [std]": 1.0,
}
"""Largest values that the project asks for."""


def figures(replay: StanceReplay) -> dict[str, float]:
    """Figures of one seed."""
    found = {
        f"{way}: {symbol} [%]": 100.0 * replay.largest(way, symbol)
        for way in replay.estimates
        for symbol in "MXJ"
        if not np.isnan(replay.largest(way, symbol))
    }
    found |= {f"{way}: in 95 % interval [%]": 100.0 * replay.coverage(way) for way in replay.estimates}
    found["vertical force [% of weight]"] = 100.0 * max(each.relative for each in replay.forces)
    found["vertical force [N]"] = max(each.force for each in replay.forces)
    found["centre of pressure [mm]"] = 1e3 * max(each.pressure for each in replay.forces)
    found["vertical force within band [%]"] = 100.0 * float(np.mean([each.inside for each in replay.forces]))
    for symbol in "XJ":
        found[f"swing rows of a walk: {symbol} [%]"] = 100.0 * max(
            _walk_error(replay, side, symbol) for side in replay.walk.estimates
        )
        found[f"walk alone: {symbol} [%]"] = 100.0 * walk_error(replay, symbol)
    found["walk alone: M [%]"] = 100.0 * walk_error(replay, "M")
    found["fixed torso: errors found"] = float(sum(finding.severity == "error" for finding in replay.walk.fixed))
    for name, each in (("wrong labels", replay.wrong), ("slipping", replay.slipping)):
        found[f"{name}: moved [std]"], found[f"{name}: reported [%]"] = each.moved, 100.0 * each.share
    return found


def _walk_error(replay: StanceReplay, side: str, symbol: str) -> float:
    """Largest relative error of X or J of one leg from its swing in a walk."""
    estimate = replay.walk.estimates[side]
    values = {f"{name}_{side}": estimate[name].value for name in estimate.names if name[0] == symbol}
    differences = np.array([value - replay.truth[name] for name, value in values.items()])
    return relative_error(tuple(values), differences, replay.truth, symbol)


def one(seed: int, seconds: float, walk: float) -> dict[str, float]:
    """Run one seed with swing and stance of so many seconds, and such a walk."""
    warnings.simplefilter("ignore")
    return figures(reproduce_stance(seed, extent=StanceExtent(stance=seconds, swing=seconds, walking=walk)))


@cache
def _walk(seconds: float):  # noqa: ANN202 - a run, which is the same for all seeds
    return walking(bleex_machine(), seconds)


def one_walk(seed: int, seconds: float) -> dict[str, float]:
    """Identify both legs from the swing of a walk with noise; friction and rotors are known."""
    warnings.simplefilter("ignore")
    run, largest = _walk(seconds), {"X": 0.0, "J": 0.0}
    truth, log = true_values(run.plant), run.recording(seed=seed, wrenches=("torso",))
    for side in SIDES:
        leg = load_leg("bleex", side=side)
        names = [(symbol, label) for symbol in ("c0", "d", "Ia") for label in leg.joint_labels]
        known = {f"{symbol}_{label}": truth[f"{symbol}_{side}_{label}"] for symbol, label in names}
        swing = swinging_leg(log, leg, side)
        found = identify(leg, swing, TERMS, known=known, preparation=WALKING, check=False)
        own = tuple(name for name in leg.parameter_names if name[0] in "XJ")
        errors = np.array([found[name].value - truth[f"{name}_{side}"] for name in own])
        sided = [f"{name}_{side}" for name in own]
        largest = {key: max(value, relative_error(sided, errors, truth, key)) for key, value in largest.items()}
    return {f"swing rows of a walk: {symbol} [%]": 100.0 * value for symbol, value in largest.items()}


GROUNDS = ("level", "leans", "rocks", "soft", "slides")
"""Grounds of the walkers, by turns of seeds. One leans by up to 3°; ridges under soles lift heel or toe 2 to 6 mm."""

WAYS = {"neither": (False, False), "plates": (True, False), "IMU": (False, True), "both": (True, True)}
"""Sensors on the ground: force plates, and an IMU with a bias. The swing before has its IMU in all of them."""


class Walked(NamedTuple):
    """What was found of one walker with some sensors."""

    errors: np.ndarray  # relative errors of M, X and J, without the torso's, (K,)
    inside: np.ndarray  # whether M, X and J are within their 95 % intervals
    deviations: np.ndarray  # errors over standard deviations
    force: float  # share of samples of an unseen squat whose vertical forces are within their 95 % band
    torque: np.ndarray  # the same of the torque of each joint, (n,)
    findings: frozenset[str]  # kinds of warnings and errors


def draw_walker(seed: int) -> tuple[str, GroundPlant, float]:
    """Draw a walker and its ground: legs unequal, hips apart, masses ±30 %. Its contacts' time constant is the last."""
    rng, kind = np.random.default_rng(seed), GROUNDS[seed % len(GROUNDS)]
    tree = ET.fromstring(re.sub(r"<\?xml.*?\?>", "", load_exo("bleex").description.text))
    for joint in tree.iter("joint"):
        origin = joint.find("origin")
        if origin is None or joint.get("type") == "fixed":
            continue
        place = np.array(origin.get("xyz", "").split(), dtype=float)
        hip, limit = joint.get("name", "").endswith("hip"), joint.find("limit")
        if limit is not None and joint.get("name", "").endswith("ankle"):
            limit.set("lower", "-1.1"), limit.set("upper", "1.1")  # a short leg on a slope bends its ankle far
        place = place + rng.uniform(-0.03, 0.03, 3) * [1.0, 0.0, 0.7] if hip else place * rng.uniform(0.97, 1.05)
        origin.set("xyz", " ".join(map(repr, place.tolist())))
    for body in tree.iter("inertial"):
        mass, inertia, (factor, turn) = body.find("mass"), body.find("inertia"), rng.uniform(0.7, 1.3, 2)
        mass.set("value", str(factor * float(mass.get("value"))))
        for name in tuple(inertia.attrib):
            inertia.set(name, str(factor * (0.6 + 0.4 * turn) * float(inertia.get(name))))
    text = ET.tostring(tree, encoding="unicode")
    leg = Leg.from_description(replace(load_exo("bleex").description, text=text), base="floating")
    values = {
        f"{symbol}_{label}": each[k % 3] * rng.uniform(0.5, 1.5)
        for symbol, each in RESISTANCES.items()
        for k, label in enumerate(leg.joint_labels)
    }
    soles = {}
    for side, y in (("left", -0.1), ("right", 0.1)):
        points = Sole.flat(-0.075, 0.13, -0.115, side=y).points
        lower = np.array([[0.03, y, -0.115 - rng.uniform(0.001, 0.003)]])
        soles[f"{side}_foot"] = Sole(np.vstack([points, lower]) if kind == "rocks" else points)
    lean, soft, friction = np.deg2rad(rng.uniform(-3.0, 3.0)), rng.uniform(0.02, 0.08), rng.uniform(0.022, 0.05)
    plant = GroundPlant.build(leg, soles, values, ground_friction=friction if kind == "slides" else 0.8)
    return kind, replace(plant, ground_lean=lean if kind == "leans" else 0.0), soft if kind == "soft" else 0.015


def walker_runs(seed: int, seconds: float) -> tuple[str, GroundPlant, list[GroundRun]]:
    """Let a walker squat, stand on each foot, swing in a stand, and squat once more, unseen by identification."""
    kind, plant, contact = draw_walker(seed)
    mujoco_model.SOLE_SOLREF = [contact, 1.0]
    rest = replace(plant, ground_lean=0.0)
    firm = replace(plant, ground_friction=0.8)  # on one foot nobody stands on ice
    # on soft ground the foot that stands sinks in
    one_foot = Stance(height=0.885 if kind == "soft" else 0.875, squat=0.03, shift=0.01, bow=0.05, swing=0.15)
    both, rail = Stance(height=0.85), HAND_RAIL if kind == "rocks" else None  # no foot that rocks balances
    squats, unseen = (
        follow(plant, stance_motion(plant, duration, stance=both, seed=10 * seed + k), GAINS, spring=rail)
        for k, duration in ((0, seconds), (4, 0.5 * seconds))
    )
    feet = [single_support(firm, seconds, stance=one_foot, standing=k, seed=10 * seed + 1 + k) for k in range(2)]
    return kind, plant, [squats, *feet, swing(rest, seconds, scale=0.85, seed=10 * seed + 3), unseen]


def walker_log(runs: list[GroundRun], seed: int, number: int, *, plates: bool, imu: bool) -> Recording:
    """Log one run of a walker with some sensors; its IMU has a bias."""
    bias = np.repeat([GYRO_BIAS, FORCE_BIAS], 3) * np.random.default_rng([seed, 99]).standard_normal(6)
    # plates are left out of the same readings: the load cell at the torso has the same noise in all ways
    read = runs[number].recording(SENSORS, np.random.default_rng([seed, number]))
    held = {link: wrench for link, wrench in read.wrenches.items() if link == "torso" or plates}
    base = read.base
    moved = BaseMotion(base.angular_velocity + bias[:3], base.specific_force + bias[3:], base.position)
    return replace(read, base=moved if imu else None, wrenches=held)


FAULTS = {
    "torque-scale": ("tau", 1.1, 0.0),
    "angle-offset": ("q", 1.0, np.deg2rad(3.0)),
    "torque-offset": ("tau", 1.0, 6.0),
}
"""Faults of one joint by the finding that names them: factor and offset of a quantity."""

IMU_LATE = 0.03
"""Time by which an IMU reads late [s]."""


def _halved(number: int, log: Recording) -> Recording:
    """Halve all torques of the second log."""
    return replace(log, tau=0.5 * log.tau) if number == 1 else log


def _knees_swapped(_: int, log: Recording) -> Recording:
    """Interchange the angles of the knees."""
    return replace(log, q=log.q[:, [0, 4, 2, 3, 1, 5]])


def _feet_swapped(_: int, log: Recording) -> Recording:
    """Interchange the switches of the feet."""
    left, right = log.contacts.get("left_foot"), log.contacts.get("right_foot")
    return log if left is None or right is None else replace(log, contacts={"left_foot": right, "right_foot": left})


def _imu(change: np.ndarray, late: float = 0.0) -> Callable[[int, Recording], Recording]:
    """Turn the axes of the IMU, or let it read late; of a swing, too."""

    def of(_: int, log: Recording) -> Recording:
        assert log.base is not None
        rows = np.maximum(np.arange(len(log)) - round(late * log.sample_rate), 0)
        columns = (x[rows] @ change for x in (log.base.angular_velocity, log.base.specific_force))
        return replace(log, base=BaseMotion(*columns, log.base.position))

    return of


MISTAKES = {
    "one log halved": (_halved, "torque-scale: all torques of a recording of"),
    "knees swapped": (_knees_swapped, "the angles of left_knee and right_knee were interchanged"),
    "feet swapped": (_feet_swapped, "the log says that"),
    "IMU turned": (_imu(np.diag([-1.0, -1.0, 1.0])), "-x, -y, z|turned by 180°"),
    "IMU mirrored": (_imu(np.diag([-1.0, 1.0, 1.0])), "against the vertical of its accelerometer"),
    "IMU 30 ms late": (_imu(np.eye(3), IMU_LATE), "imu-delay"),
}
"""Mistakes of whole logs with an IMU, and what names them: a pattern of a kind and message, or of an error."""


def faulty_walker(seed: int, seconds: float) -> list[tuple[str, str, str, bool]]:
    """Plant each fault at each joint: the way, fault and joint, and whether it is named; "none" if nothing is."""
    warnings.simplefilter("ignore")
    try:
        _, plant, runs = walker_runs(seed, seconds)
    except ExoidError:
        return []
    found = []
    for way in ("neither", "IMU"):
        logs = [walker_log(runs, seed, k, plates=False, imu=k == 3 or way == "IMU") for k in range(4)]
        told = [one.kind for one in identify(plant.leg, logs, TERMS).findings]
        found.append((way, "none", "", bool({*told} & {*FAULTS, "imu-delay"})))
        for kind, (quantity, factor, offset) in FAULTS.items():
            for joint, name in enumerate(plant.leg.joint_names):
                own = np.arange(6) == joint
                changed = (np.where(own, factor, 1.0) * getattr(log, quantity) + offset * own for log in logs)
                spoilt = [replace(log, **{quantity: x}) for log, x in zip(logs, changed, strict=True)]
                try:
                    told = [(one.kind, one.joint) for one in identify(plant.leg, spoilt, TERMS).findings]
                except ExoidError:
                    told = [(kind, name)]  # refused
                found.append((way, kind, name.split("_")[1], (kind, name) in told))
        for name, (mistake, said) in MISTAKES.items() if way == "IMU" else ():
            try:
                spoilt = [mistake(k, log) for k, log in enumerate(logs)]
                told = [f"{one.kind}: {one.message}" for one in identify(plant.leg, spoilt, TERMS).findings]
            except ExoidError as error:
                told = [str(error)]
            found.append((way, name, "", any(re.search(said, one) for one in told)))
    return found


def print_faulty(every: list[tuple[str, str, str, bool]]) -> None:
    """Print how many planted faults are named."""
    for fault in dict.fromkeys(each[1:3] for each in every):
        cells = []
        for way in ("neither", "IMU"):
            named = [is_named for one, *rest, is_named in every if one == way and tuple(rest) == fault]
            cells += [f"{way} {sum(named)} of {len(named)}"] * bool(named)
        print(f"{' '.join(fault):20s} named: {'; '.join(cells)}")


def one_walker(seed: int, seconds: float) -> tuple[str, dict[str, Walked | str]]:
    """Identify a walker with each set of sensors; what was said where that is refused."""
    warnings.simplefilter("ignore")
    try:
        kind, plant, runs = walker_runs(seed, seconds)
    except ExoidError as error:  # such as a foot that would swing into the ground
        return draw_walker(seed)[0], dict.fromkeys(WAYS, str(error))
    truth, found = true_values(plant), dict[str, Walked | str]()
    for way, (plates, imu) in WAYS.items():
        try:
            logs = [walker_log(runs, seed, k, plates=plates, imu=imu or k == 3) for k in range(4)]
            estimate = identify(plant.leg, logs, TERMS)
            forces = ground_forces(estimate, walker_log(runs, seed, 4, plates=False, imu=imu))
            torque = validate(estimate, walker_log(runs, seed, 4, plates=plates, imu=imu)).coverage
        except ExoidError as error:
            found[way] = str(error)
            continue
        chosen = [k for k, name in enumerate(estimate.names) if name[0] in "MXJ" and name not in ("X0", "J0")]
        true = np.array([truth[name] for name in estimate.names])
        low, high = estimate.interval(0.95).T
        inside = []
        for link, force in forces.items():
            rows = np.searchsorted(runs[4].time, force.time)
            real = level_wrench(plant.leg, runs[4].q, link, runs[4].wrench(link), rows)
            inside.append(np.abs(force.force - real.force)[:, 2] <= force.force_half[:, 2])
        found[way] = Walked(
            errors=np.abs(estimate.values / true - 1.0)[chosen],
            inside=((low <= true) & (true <= high))[chosen],
            deviations=((estimate.values - true) / estimate.std)[chosen],
            force=float(np.mean(np.concatenate(inside))),
            torque=torque,
            findings=frozenset(one.kind for one in estimate.findings if one.severity != "info"),
        )
    return kind, found


def print_walkers(every: list[tuple[str, dict[str, Walked | str]]]) -> None:
    """Print a line for each ground and set of sensors, and the paired comparison of sensors."""
    print("ground sensors  walkers   error  largest    XJM   rms  force  torque  least  findings")
    for kind in GROUNDS:
        for way in WAYS:
            told = [found[way] for ground, found in every if ground == kind]
            known = [one for one in told if isinstance(one, Walked)]
            for one in told:
                if isinstance(one, str):
                    print(f"{kind:7}{way:9} refused: {one}")
            if not known:
                continue
            errors, inside, std = (np.concatenate([one[k] for one in known]) for k in range(3))
            named = Counter(name for one in known for name in one.findings)
            torques = 100 * np.array([one.torque for one in known])
            print(
                f"{kind:7}{way:9}{len(known):7}{100 * np.median(errors):8.2f}{100 * errors.max():9.2f}"
                f"{100 * inside.mean():7.1f}{np.sqrt(np.mean(std**2)):6.2f}"
                f"{100 * np.mean([one.force for one in known]):7.1f}{torques.mean():8.1f}{torques.min():7.1f}  "
                + ", ".join(f"{name} {count}" for name, count in sorted(named.items())),
            )
    for less, more in (("neither", "plates"), ("neither", "IMU"), ("plates", "both"), ("IMU", "both")):
        pairs = [
            [np.sqrt(np.mean(found[way].errors ** 2)) for way in (less, more)]
            for _, found in every
            if isinstance(found[less], Walked) and isinstance(found[more], Walked)
        ]
        if not pairs:
            continue
        ratio = np.array([after / before for before, after in pairs])
        worse = scipy.stats.wilcoxon(np.log(ratio), alternative="greater").pvalue
        print(
            f"{more} beside {less}: error x {np.exp(np.mean(np.log(ratio))):.3f} (geometric mean), worse in "
            f"{np.sum(ratio > 1.0)} of {len(ratio)}, largest x {ratio.max():.2f}; p of worse {worse:.3f} (Wilcoxon)"
        )


def main() -> None:
    """Read the options and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--first", type=int, help="first seed; default 0, of walkers 1000")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=15.0, help="of each log of swing and stance")
    parser.add_argument("--walking", type=float, default=80.0, help="seconds of the walk")
    parser.add_argument("--walk", action="store_true", help="only the walk, with known friction and rotors")
    parser.add_argument("--walkers", action="store_true", help="drawn walkers, on five kinds of ground")
    parser.add_argument("--faults", action="store_true", help="walkers with faults of a joint, or mistakes in logs")
    options = parser.parse_args()
    first = (1000 if options.walkers or options.faults else 0) if options.first is None else options.first
    seeds = range(first, first + options.seeds)
    if options.faults:
        each = Parallel(n_jobs=options.jobs)(delayed(faulty_walker)(seed, options.seconds) for seed in seeds)
        return print_faulty([*chain(*each)])
    if options.walkers:
        work = (delayed(one_walker)(seed, options.seconds) for seed in seeds)
        return print_walkers(Parallel(n_jobs=options.jobs)(work))
    if options.walk:
        tasks = [delayed(one_walk)(seed, options.walking) for seed in seeds]
    else:
        tasks = [delayed(one)(seed, options.seconds, options.walking) for seed in seeds]
    found = Parallel(n_jobs=1 if options.walk else options.jobs)(tasks)  # one simulated walk serves all seeds
    print(f"{options.seeds} seeds {'P95':>38} {'median':>8} {'mean':>8} {'least':>8} {'limit':>8}")
    for name in found[0]:
        values = np.array([each[name] for each in found])
        limit = f"{LIMITS[name]:8.3g}" if name in LIMITS else ""
        p95 = np.quantile(values, 0.95)
        print(f"{name:40s} {p95:8.3g} {np.median(values):8.3g} {values.mean():8.3g} {values.min():8.3g} {limit}")


if __name__ == "__main__":
    main()
