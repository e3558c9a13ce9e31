"""What do swing, stance and walking tell of BLEEX, over many seeds? Figures of docs/replays.md.

    python scripts/study_stance.py                       # 16 seeds, about ten minutes on two cores
    python scripts/study_stance.py --seeds 2 --jobs 1
    python scripts/study_stance.py --walk                # the walk alone, with the true friction and rotors: a minute

Each seed is one `exoid reproduce stance`: other motions, noise and bias of the IMU. Errors are the 95 % quantile over
the seeds of the largest one of a seed; coverage is that of 95 % intervals of all parameters.
"""

from __future__ import annotations

import argparse
import warnings
from functools import cache

import numpy as np
from joblib import Parallel, delayed

from exoid import identify, load_leg
from exoid.experiments.ground import bleex_machine, walking
from exoid.lab.reproduce import StanceExtent, reproduce_stance
from exoid.lab.reproduce.stance import SIDES, TERMS, WALKING, StanceReplay, relative_error, swinging_leg, true_values
from exoid.lab.reproduce.stance_report import walk_error

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


def main() -> None:
    """Read the options and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=15.0, help="of each log of swing and stance")
    parser.add_argument("--walking", type=float, default=80.0, help="seconds of the walk")
    parser.add_argument("--walk", action="store_true", help="only the walk, with known friction and rotors")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
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
