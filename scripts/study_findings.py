"""Which faults of a log does exoid find, how often does it find one in a log without any, and do intervals hold?

Four tables:

* corruptions: faults in three sizes. A log counts where the fault moves some parameter by more than its 95 % interval;
  then the share of logs is printed in which the right kind was found at the right joint.
* clean: share of logs without faults in which something is found.
* real: findings in the real recordings of ``$EXOID_DATA_DIR``.
* disturbances: share of true parameters inside the 95 % intervals of the default estimate, of all parameters and of
  those that are called "well" identified, and shares of logs with any finding and with the right one.

    OMP_NUM_THREADS=1 python scripts/study_findings.py                                      # a few minutes
    OMP_NUM_THREADS=1 python scripts/study_findings.py corruptions --seeds 20 --workers 8
    OMP_NUM_THREADS=1 python scripts/study_findings.py clean --seeds 170 --workers 8
    OMP_NUM_THREADS=1 python scripts/study_findings.py disturbances --seeds 200 --workers 8 --legs bleex
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
from fault_lists import CORRUPTIONS, DISTURBANCES, Corruption
from faulty_logs import LEGS, Log, clean_log
from joblib import Parallel, delayed

import exoid
from exoid.errors import ExoidError
from exoid.estimate.finding import Finding

TABLES = ("corruptions", "clean", "real", "disturbances")


class Outcome(NamedTuple):
    """One log: whether a parameter moved out of its interval, whether the kind was found, and the joint named."""

    moved: bool
    found: bool
    named: bool
    kinds: tuple[str, ...]


class Coverage(NamedTuple):
    """One estimate: parameters inside their intervals, of all and of those called "well", and what was found."""

    inside: float
    inside_well: float
    well: float
    warned: bool
    named: bool
    kinds: tuple[str, ...]


def corrupted(leg: str, which: int, size: float, seed: int) -> Outcome | None:
    """Corrupt a log, and say whether it matters and whether it is found; None where there is no such corruption."""
    corruption, rng = CORRUPTIONS[which], np.random.default_rng([seed, which])
    log = clean_log(leg, seed)
    try:
        bad = corruption.apply(log, size, rng)
    except ExoidError:
        return None
    findings = exoid.check(bad.leg, bad.recordings)
    kind = any(finding.kind in corruption.kinds for finding in findings)
    return Outcome(_moved(log, bad), kind, _is_named(log, corruption, findings), _summary(findings))


def disturbed(leg: str, which: int, size: float, seed: int) -> Coverage:
    """Identify from a disturbed log, and count which intervals contain the truth."""
    disturbance, rng = DISTURBANCES[which], np.random.default_rng([seed, which])
    log = clean_log(leg, 1000 + seed, sharpness=0.02)
    bad = disturbance.apply(log, size, rng)
    try:
        estimate = exoid.identify(bad.leg, bad.recordings)
    except ExoidError:
        return Coverage(np.nan, np.nan, 0.0, True, True, ("refused",))
    truth = np.array([log.truth.get(name, 0.0) for name in estimate.names])
    low, high = estimate.interval().T
    inside = (low <= truth) & (truth <= high)
    well = np.array([word == "well" for word in estimate.identifiability])
    found = estimate.findings
    warned = any(finding.severity != "info" for finding in found)
    of_well = float(np.mean(inside[well])) if well.any() else np.nan
    named = _is_named(log, disturbance, found)
    return Coverage(float(np.mean(inside)), of_well, float(np.mean(well)), warned, named, _summary(found))


def alarms(leg: str, seed: int) -> tuple[str, ...]:
    """Findings in a clean log."""
    log = clean_log(leg, 100_000 + seed)
    return _summary(exoid.check(log.leg, log.recordings))


def _is_named(log: Log, corruption: Corruption, findings: Sequence[Finding]) -> bool:
    """Whether the right kind was found at the right joint."""
    joint = None if corruption.joint is None else log.leg.joint_names[corruption.joint]
    return any(finding.kind in corruption.kinds and joint in (None, finding.joint) for finding in findings)


def _summary(findings: Sequence[Finding]) -> tuple[str, ...]:
    """Kinds and joints of findings that are more than information."""
    return tuple(f"{finding.kind}:{finding.joint}" for finding in findings if finding.severity != "info")


def _moved(log: Log, bad: Log) -> bool:
    """Whether a corruption moves a parameter out of its interval; data that occur twice only narrow intervals."""
    if len(bad.recordings) > len(log.recordings):
        return True
    before = _identified(log.leg, log.recordings)
    try:
        after = exoid.identify(bad.leg, bad.recordings, check=False)
    except ExoidError:
        return True
    low, high = before.interval().T
    return bool(((after.values < low) | (after.values > high)).any())


@lru_cache(maxsize=32)
def _identified(leg: exoid.Leg, recordings: tuple[exoid.Recording, ...]) -> exoid.Estimate:
    """Identify from a log without faults, of which many are made with one."""
    return exoid.identify(leg, recordings, check=False)


class Study(NamedTuple):
    """What the command line asks for."""

    seeds: int
    legs: tuple[str, ...]
    only: str
    workers: int
    verbose: bool
    sizes: tuple[float, ...] = ()

    def each(self, function: Callable, *lists: Sequence) -> list:
        """Call a function for each leg, each combination of some lists, and each seed."""
        jobs = product(self.legs, *lists, range(self.seeds))
        return list(Parallel(n_jobs=self.workers)(delayed(function)(*job) for job in jobs))

    def chosen(self, faults: Sequence[Corruption]) -> Iterator[tuple[int, Corruption]]:
        """Faults whose name contains what was asked for."""
        chosen = ((which, fault) for which, fault in enumerate(faults) if self.only in fault.name)
        return ((which, fault._replace(sizes=self.sizes or fault.sizes)) for which, fault in chosen)


def corruptions(study: Study) -> None:
    """Print how often each corruption matters and is found."""
    print(f"{study.seeds} logs for each leg ({', '.join(study.legs)}) and size")
    print(f"{'corruption':44} {'size':>6} {'logs':>5} {'moves':>6} {'kind':>6} {'joint':>6}   (of those that it moves)")
    total = right = 0
    for which, corruption in study.chosen(CORRUPTIONS):
        for size in corruption.sizes:
            done = [one for one in study.each(corrupted, [which], [size]) if one is not None]
            matter = [one for one in done if one.moved]
            found, named = sum(one.found for one in matter), sum(one.named for one in matter)
            total, right = total + len(matter), right + named
            shares = (_share(len(matter), len(done)), _share(found, len(matter)), _share(named, len(matter)))
            print(f"{corruption.name:44} {size:6g} {len(done):5d} {'{:>6} {:>6} {:>6}'.format(*shares)}", flush=True)
            for one in matter if study.verbose else ():
                if not one.named:
                    print("    missed:", *(one.kinds or ("nothing found",)))
    print(f"all: {right}/{total} ({_share(right, total)})")


def clean(study: Study) -> None:
    """Print the share of false alarms."""
    for leg in study.legs:
        found = study._replace(legs=(leg,)).each(alarms)
        wrong = [one for one in found if one]
        print(f"false alarms, {leg}: {len(wrong)}/{len(found)}", *wrong[:10], flush=True)


def real(study: Study) -> None:
    """Print findings in the real recordings."""
    for name, load in (("dfki_double_pendulum", _double_pendulum), ("teststand_leg", _teststand_leg)):
        if study.only not in name:
            continue
        try:
            leg, log = load()
        except (ExoidError, OSError) as error:
            print(f"{name}: not there ({error})")
            continue
        print(f"{name}:")
        for finding in exoid.check(leg, log):
            print(f"    {finding}")


def _double_pendulum() -> tuple[exoid.Leg, exoid.Recording]:
    """Leg and training part of the DFKI recording."""
    data = exoid.datasets.dfki_double_pendulum()
    return data.leg, data.train


def _teststand_leg() -> tuple[exoid.Leg, exoid.Recording]:
    """Two joints, whose foot is pressed and pulled by hand."""
    folder = Path(os.environ.get("EXOID_DATA_DIR", ".")) / "teststand_leg"
    q, tau = (np.loadtxt(folder / f"dg_hopper_teststand-joint_{name}.dat") for name in ("positions", "torques"))
    _, first, second = np.intersect1d(q[:, 0], tau[:, 0], return_indices=True)
    q, tau = q[first], tau[second]
    leg = exoid.Leg.from_urdf(folder / "teststand.urdf", ("HFE", "KFE"))
    time = (q[:, 0] - q[0, 0]) / 1000.0
    return leg, exoid.Recording(time=time, q=q[:, 1:], tau=tau[:, 1:], joint_names=("HFE", "KFE"))


def disturbances(study: Study) -> None:
    """Print coverage of intervals, and the share of estimates with a finding."""
    print(f"{study.seeds} logs for each leg ({', '.join(study.legs)}) and size; nominal coverage 95 %")
    print(f"{'disturbance':34} {'size':>6} {'inside':>7} {'of well':>8} {'well':>6} {'finding':>8} {'right':>6}")
    for which, disturbance in study.chosen(DISTURBANCES):
        for size in disturbance.sizes:
            done = study.each(disturbed, [which], [size])
            cells = [
                _percent([one.inside for one in done]),
                _percent([one.inside_well for one in done]),
                _percent([one.well for one in done]),
                _percent([one.warned for one in done]),
                _percent([one.named for one in done]) if disturbance.kinds else "",
            ]
            print(f"{disturbance.name:34} {size:6g} {'{:>7} {:>8} {:>6} {:>8} {:>6}'.format(*cells)}", flush=True)
            if study.verbose:
                for one in done:
                    print("   ", *(one.kinds or ("nothing found",)))


def _share(part: int, whole: int) -> str:
    return f"{part / whole:.0%}" if whole else "-"


def _percent(values: Sequence[float]) -> str:
    known = np.array(values, dtype=np.float64)
    known = known[np.isfinite(known)]
    return f"{known.mean():.0%}" if len(known) else "-"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the tables that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tables", nargs="*", default=[], help=f"any of {', '.join(TABLES)}; all by default")
    parser.add_argument("--seeds", type=int, default=2, help="logs for each fault, size and leg")
    parser.add_argument("--legs", default=",".join(LEGS))
    parser.add_argument("--only", default="", help="faults whose name contains this")
    parser.add_argument("--sizes", default="", help="sizes of these faults, such as 1,2,3, instead of the usual ones")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--verbose", action="store_true", help="say what was found instead")
    given = parser.parse_args(arguments)
    unknown = set(given.tables) - set(TABLES)
    if unknown:
        parser.error(f"no table {', '.join(sorted(unknown))}")
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    sizes = tuple(float(size) for size in given.sizes.split(",") if size)
    study = Study(given.seeds, tuple(given.legs.split(",")), given.only, given.workers, given.verbose, sizes)
    for table, show in zip(TABLES, (corruptions, clean, real, disturbances), strict=True):
        if table in (given.tables or TABLES):
            show(study)


if __name__ == "__main__":
    main()
