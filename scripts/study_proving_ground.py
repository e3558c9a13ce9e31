"""What exoid makes of machines that nobody tuned it for: tests/proving_ground, a population of them.

    python scripts/study_proving_ground.py                                # 40 machines of seeds from 1000 on
    python scripts/study_proving_ground.py --seeds 0:20 --features doctor # those to tune on are below 1000
    python scripts/study_proving_ground.py --keep figures.jsonl           # a line for each machine; resumes

MuJoCo simulates the machines. Each is identified from one motion with the URDF of its wrong CAD, and judged on another
kind of motion against the torques that it truly had. Prints a line for each machine and the tables of the docs.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from proving_ground.machine import Machine, draw
from proving_ground.population import ESTIMATORS, MISTAKES, Outcome, best_for_all, forms, population

REPORTED = 1000
"""First seed whose figures are reported: nothing is tuned on it."""

SHOWN = 1.1
"""Growth of the residual of some joint from which on a mistake is said to show in the log."""


def line(outcome: Outcome) -> str:
    """One machine in one line."""
    errors = {name: outcome.nrmse.get(name, np.nan) for name in ("default", "joint by joint", "true form")}
    texts = [*(f"{name} {x:.4f}" for name, x in errors.items()), f"best of all {best_for_all(outcome):.4f}"]
    texts += [f"false {kind} ({severity})" for severity, kind in outcome.false]
    texts += [f"silent: {name}" for name, named in outcome.named.items() if not named]
    texts += [f"refused {name}: {reason}" for name, reason in outcome.refused.items()]
    return f"{outcome.machine}\n    {'; '.join(texts)}"


def table(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Markdown."""
    return "\n".join(f"| {' | '.join(row)} |" for row in (headers, ["---"] * len(headers), *rows)) + "\n"


def errors_of_models(outcomes: Sequence[Outcome]) -> str:
    """NRMSE of each model for all joints, and of selection, over that of the true form."""
    rows, best = [], "best of these for each machine"
    for name in (*forms(), best, "joint by joint", "true form"):
        mine = np.array([best_for_all(o) if name == best else o.nrmse.get(name, np.nan) for o in outcomes])
        ratio = mine / [o.nrmse.get("true form", np.nan) for o in outcomes]
        known = np.isfinite(ratio)
        if known.any():
            figures = np.median(mine[known]), np.exp(np.log(ratio[known]).mean()), ratio[known].max()
            seconds = max((o.seconds.get(name, 0.0) for o in outcomes), default=0.0)
            time = "" if name == best else f"{seconds:.1f} s"
            rows.append((name, str(known.sum()), *(f"{x:.3f}" for x in figures), time))
    return table(("model", "machines", "median NRMSE", "over the true form, mean", "worst", "longest time"), rows)


def selection(outcomes: Sequence[Outcome]) -> str:
    """How selection joint by joint compares with the better of itself and of one model for all joints."""
    both = [o for o in outcomes if {"joint by joint", "default"} <= {*o.nrmse}]
    mine = np.array([o.nrmse["joint by joint"] for o in both])
    ratio = np.maximum(1.0, mine / [best_for_all(o) for o in both])
    defaults = mine / [o.nrmse["default"] for o in both]
    if not both:
        return ""
    rows = [
        ("over the better of it and one model for all joints, geometric mean", f"{np.exp(np.log(ratio).mean()):.3f}"),
        ("worst", f"{ratio.max():.3f}"),
        ("machines beyond 1.02", f"{(ratio > 1.02).sum()} of {len(ratio)}"),
        ("worse than the default terms", f"{(defaults > 1.0).sum()} of {len(defaults)}"),
    ]
    knowing = [o.nrmse["Y known"] / o.nrmse["joint by joint"] for o in both if "Y known" in o.nrmse]
    if knowing:
        name = f"with every Y known, over that without, geometric mean of {len(knowing)} planar machines"
        rows += [(name, f"{np.exp(np.log(knowing).mean()):.3f}"), ("worst", f"{max(knowing):.3f}")]
    return table(("selection joint by joint", "NRMSE"), rows)


def counted(named: int, count: int, shown: int) -> str:
    """How many mistakes are named, of all and of those that show in the log."""
    return f"{named} of {count} named" + f"; {named} of {shown} that show" * bool(count - shown)


def doctor(outcomes: Sequence[Outcome]) -> str:
    """Mistakes that are named, and findings on logs without mistakes."""
    rows, total = [], np.zeros(3, dtype=int)  # that are named, all, and those that show
    for mistake in (each for each in MISTAKES if any(each in o.named for o in outcomes)):
        named = [o.named[mistake] for o in outcomes if mistake in o.named]
        unseen = sum(o.shown.get(mistake, SHOWN) < SHOWN for o in outcomes)
        counts = np.array([sum(named), len(named), len(named) - unseen])
        rows.append((mistake, counted(*counts)))
        total += counts
    rows += [("all mistakes", counted(*total))] * bool(total.any())
    judged = [o for o in outcomes if "checked, wls" in o.nrmse]
    for severity in ("error", "warning"):
        false = [o for o in judged if severity in {s for s, _ in o.false}]
        kinds = Counter(kind for o in judged for s, kind in o.false if s == severity)
        text = ", ".join(f"{kind} {count}" for kind, count in kinds.most_common())
        rows.append((f"no mistake: {severity} that nothing explains", f"{len(false)} of {len(judged)} logs; {text}"))
    return table(("log", "findings"), rows)


def coverage(outcomes: Sequence[Outcome]) -> str:
    """Share of the 95 % intervals of the rigid bodies that contain the truth, by kind of machine and by estimator."""
    kinds: dict[str, Callable[[Machine], bool]] = {
        "all": lambda m: True,
        "with a passive joint": lambda m: any(j.passive for j in m.joints),
        "with elastic joints": lambda m: any(j.spring for j in m.joints),
        "with a floating base": lambda m: m.floating,
        "torque by command": lambda m: m.sensing.torque == "command",
        "coloured noise": lambda m: m.sensing.colour == "coloured",
    }
    groups = [(name, "wls", belongs) for name, belongs in kinds.items()]
    groups += [
        (f"{name}, {est}", est, kinds[name]) for est in ESTIMATORS[1:] for name in ("all", "with a passive joint")
    ]
    rows = []
    for name, estimator, belongs in groups:
        chosen = [o for o in outcomes if belongs(o.machine) and len(o.inside.get(estimator, ()))]
        if chosen:
            judged = [(o.inside[estimator], ~o.doubtful[estimator]) for o in chosen]
            shares = [np.mean(held) for held, _ in judged]
            sure = [np.mean(held[certain]) for held, certain in judged if certain.any()]
            figures = (f"{f(x):.2f}" if x else "" for x in (shares, sure) for f in (np.mean, np.min))
            rows.append((name, str(len(chosen)), *figures, f"{worst_by_chance([len(held) for held, _ in judged]):.2f}"))
    headers = (
        "machines",
        "number",
        "intervals that hold",
        "worst machine",
        "not doubtful",
        "worst machine",
        "by chance",
    )
    return table(headers, rows)


def torque_bands(outcomes: Sequence[Outcome]) -> str:
    """Share of measured torques within their 95 % band on motion unlike the training's."""
    rows = []
    for name, floating in (("a fixed base", False), ("a floating base", True)):
        judged = [band for o in outcomes if o.machine.floating == floating for band in o.bands]
        if judged:
            share, warned = (np.array(x) for x in zip(*judged, strict=True))
            narrow = share < 0.9
            least = f"{share[~warned].min():.2f}" if not warned.all() else ""
            figures = f"{share.mean():.2f}", str(narrow.sum()), str((narrow & ~warned).sum()), least
            rows.append((name, str(len(judged)), *figures))
    headers = "machines with", "joints", "mean share within", "below 0.90", "below without a finding", "least of these"
    return table(headers, rows)


def worst_by_chance(counts: Sequence[int]) -> float:
    """Median share of the worst of machines with so many intervals, if each held in 95 % by itself."""
    held = np.random.default_rng(0).binomial(counts, 0.95, (10_000, len(counts)))
    return float(np.median((held / counts).min(axis=1)))


def refusals(outcomes: Sequence[Outcome]) -> str:
    """What was refused."""
    reasons = Counter(" ".join(reason.split()[:8]) for o in outcomes for reason in o.refused.values())
    return table(("refused", "times"), [(reason, str(count)) for reason, count in reasons.most_common()])


def to_json(outcome: Outcome) -> str:
    """Write the figures of a machine."""
    numbers = {
        name: getattr(outcome, name)
        for name in ("nrmse", "seconds", "false", "true", "named", "bands", "shown", "refused")
    }
    numbers |= {name: {e: x.tolist() for e, x in getattr(outcome, name).items()} for name in ("inside", "doubtful")}
    return json.dumps({"seed": outcome.machine.seed, **numbers})


def from_json(text: str) -> Outcome:
    """Read them."""
    numbers = json.loads(text)
    numbers |= {name: {e: np.array(x) for e, x in numbers[name].items()} for name in ("inside", "doubtful")}
    found = {name: [(a, b) for a, b in numbers.pop(name)] for name in ("false", "true")}
    return Outcome(draw(numbers.pop("seed")), **found, **numbers)


def main() -> None:
    """Read options and run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default=f"{REPORTED}:{REPORTED + 40}", help="first:last + 1")
    parser.add_argument("--features", default="fit,select,check,doctor", help="of these")
    parser.add_argument("--mistakes", default="", help="only mistakes whose name has one of these texts")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--keep", type=Path, help="file with a line of JSON for each machine")
    given = parser.parse_args()
    seeds = range(*map(int, given.seeds.split(":")))
    known = given.keep.read_text(encoding="utf-8").splitlines() if given.keep and given.keep.exists() else []
    outcomes = {outcome.machine.seed: outcome for outcome in map(from_json, known)}
    missing, features = [seed for seed in seeds if seed not in outcomes], given.features.split(",")
    mistakes = [each for each in MISTAKES if any(text in each for text in given.mistakes.split(","))]
    for outcome in population(missing, workers=given.workers, features=features, mistakes=mistakes):
        outcomes[outcome.machine.seed] = outcome
        print(line(outcome), file=sys.stderr, flush=True)
        if given.keep:
            with given.keep.open("a", encoding="utf-8") as file:
                file.write(to_json(outcome) + "\n")
    ours = [outcomes[seed] for seed in seeds]
    for show in (errors_of_models, selection, doctor, coverage, torque_bands, refusals):
        print(show(ours))


if __name__ == "__main__":
    main()
