"""Thousands of virtual identifications: bias, standard deviation, coverage of intervals, and efficiency.

``python scripts/study_virtual_legs.py cuhk --replicates 1000 --noise 0.3`` prints a table of every motion, noise and
estimator.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

from threadpoolctl import threadpool_limits

import exoid
from exoid.experiments.excitation import MotionLimits, plan_excitation
from exoid.experiments.excitation.scales import Scales, TorqueNoise
from exoid.lab.study import LegText, Noise, Protocol, Study, document, planned, plausible_truth, run_study
from exoid.torques import DEFAULT_TERMS, TorqueModel

COLOURS = {"white": 0.0, "correlated": 1.0, "mixed": 0.8}
"""Correlated share of the variance."""


def main() -> None:
    """Run a study, and print its tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("leg", choices=("bleex", "cuhk"))
    parser.add_argument("--protocols", default="planned", help="motions: planned, document")
    parser.add_argument("--colours", default="mixed", help="noise: white, correlated, mixed")
    parser.add_argument("--estimators", default="wls")
    parser.add_argument("--noise", help="standard deviation at each joint [N·m]; default 2 %% of its torque")
    parser.add_argument("--memory", type=float, default=0.05, help="correlation time of correlated noise [s]")
    parser.add_argument("--replicates", type=int, default=100)
    parser.add_argument("--duration", type=float, default=60.0, help="duration of each motion [s]")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--parameters", action="store_true", help="print a line for each parameter, too")
    given = parser.parse_args()
    leg = exoid.load_leg(given.leg)
    model = TorqueModel(leg, DEFAULT_TERMS)
    scales = Scales.of(model, MotionLimits.of(leg))
    size = None if given.noise is None else [float(part) for part in given.noise.split(",")]
    std = TorqueNoise.of(size, scales.typical_torque).std

    def plan() -> Protocol:
        """Plan with few starts, because a good motion is enough."""
        with threadpool_limits(limits=1):  # the same bits on any number of processors
            return planned(plan_excitation(leg, criterion="d", starts=2, noise=std, duration=given.duration))

    motions: dict[str, Callable[[], Protocol]] = {"planned": plan, "document": lambda: document(leg, given.duration)}
    study = Study(
        leg=LegText.of(leg),
        terms=DEFAULT_TERMS,
        truth=plausible_truth(model, scales.typical_torque),
        protocols=tuple(motions[name]() for name in given.protocols.split(",")),
        noises=tuple(Noise(name, std, COLOURS[name], given.memory) for name in given.colours.split(",")),
        estimators=tuple(given.estimators.split(",")),
        replicates=given.replicates,
        seed=given.seed,
    )
    result = run_study(study, None if given.workers == 1 else given.workers)
    print(result)
    for combination in result.combinations if given.parameters else ():
        print(f"\n{combination}")


if __name__ == "__main__":
    main()
