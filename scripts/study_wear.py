"""What a wearer feels of both legs over seeds: with CAD, identified and true model, and which amplification is stable.

The limits are those of the project: with the identified model at most 20 % of what is felt with CAD, and at most 1.3
times what is felt with the truth.

    OMP_NUM_THREADS=1 python scripts/study_wear.py --seeds 16
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np

from exoid import load_leg, reproduce
from exoid.lab.reproduce.wear_models import worn_models
from exoid.lab.stability import Amplification

TRUE_BODIES = {"bleex": "identified", "cuhk": "nominal"}
"""Inertia set of the rig's bodies."""


def main() -> None:
    """Print a line a leg and stride: medians, and the worst of the seeds."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--legs", default="bleex,cuhk")
    parser.add_argument("--periods", type=_numbers, default=[2.5, 4.0], help="strides [s]")
    parser.add_argument("--bandwidths", type=_numbers, default=[50.0], help="bandwidths of the motion filter [Hz]")
    parser.add_argument("--exact-bodies", action="store_true", help="CAD with the true bodies, without friction")
    options = parser.parse_args()
    print(
        "leg    stride [s]  filter [Hz]  off    CAD    identified  truth  1/α [N·m]   over CAD (worst)  "
        "over truth (worst)  1/α over CAD  α of CAD"
    )
    for leg in options.legs.split(","):
        runs = list(itertools.product(options.periods, options.bandwidths))
        found: dict[tuple[float, float], list[dict[str, Any]]] = {run: [] for run in runs}
        for seed in range(options.seeds):
            models = worn_models(leg, seed, lambda _: None)
            if options.exact_bodies:
                models = models._replace(cad=load_leg(leg, inertias=TRUE_BODIES[leg]))
            largest: dict[float, Mapping[str, Amplification]] = {}
            for period, bandwidth in runs:
                study = reproduce.wear(
                    models, period=period, bandwidth=bandwidth, largest=largest.get(bandwidth), seed=seed
                )
                largest[bandwidth] = study.largest
                found[period, bandwidth].append(reproduce.wear_report(study).data)
        for run, each in found.items():
            print(_line(leg, *run, each), flush=True)


def _numbers(text: str) -> list[float]:
    return [float(each) for each in text.split(",")]


def _line(leg: str, period: float, bandwidth: float, found: list[dict[str, Any]]) -> str:
    """Write medians and worst ratios of all seeds."""
    names = ("off", "cad", "identified", "truth")
    table = np.array([[*(each["felt_rms"][name] for name in names), each["floor_rms"]] for each in found])
    middle = np.median(table, axis=0)
    by_cad, by_truth, floor = table[:, 2] / table[:, 1], table[:, 2] / table[:, 3], table[:, 4] / table[:, 1]
    largest = np.median([each["largest_amplification"]["cad"] for each in found])
    return (
        f"{leg:6s} {period:10g}  {bandwidth:11g}  {middle[0]:5.2f}  {middle[1]:5.2f}  {middle[2]:10.3f}  "
        f"{middle[3]:5.3f}  {middle[4]:9.3f}   {np.median(by_cad):8.3f} ({by_cad.max():.3f})  "
        f"{np.median(by_truth):10.3f} ({by_truth.max():.3f})  {np.median(floor):12.3f}  {largest:8.3g}"
    )


if __name__ == "__main__":
    main()
