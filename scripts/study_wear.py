"""What a wearer feels of both legs over seeds: with CAD, identified and true model, and which amplification is stable.

The limits are those of the project: with the identified model at most 20 % of what is felt with CAD, and at most 1.3
times what is felt with the truth.

    OMP_NUM_THREADS=1 python scripts/study_wear.py --seeds 16
"""

from __future__ import annotations

import argparse

import numpy as np

from exoid import reproduce


def main() -> None:
    """Print a line a leg and stride: medians, and the worst of the seeds."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--legs", default="bleex,cuhk")
    parser.add_argument("--periods", default="4", help="strides [s]")
    options = parser.parse_args()
    print("leg    stride [s]  off    CAD    identified  truth [N·m]   over CAD (worst)  over truth (worst)  α of CAD")
    for leg in options.legs.split(","):
        for period in map(float, options.periods.split(",")):
            felt, largest = [], []
            for seed in range(options.seeds):
                found = reproduce.wear_json(reproduce.wear(leg, period=period, seed=seed))
                felt.append([found["felt_rms"][name] for name in ("off", "cad", "identified", "truth")])
                largest.append(found["largest_amplification"]["cad"])
            table = np.array(felt)
            middle = np.median(table, axis=0)
            by_cad, by_truth = table[:, 2] / table[:, 1], table[:, 2] / table[:, 3]
            print(
                f"{leg:6s} {period:10g}  {middle[0]:5.2f}  {middle[1]:5.2f}  {middle[2]:10.3f}  {middle[3]:11.3f}   "
                f"{np.median(by_cad):14.3f} ({by_cad.max():.3f})  {np.median(by_truth):6.3f} ({by_truth.max():.3f})  "
                f"{np.median(largest):14.3g}",
                flush=True,
            )


if __name__ == "__main__":
    main()
