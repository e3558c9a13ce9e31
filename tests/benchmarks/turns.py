"""Times that can be compared: several works in one process, in turns, the best of each.

An alarm rings at two thirds of the worst ratio that any machine has shown: caches alone move ratios by a third.
"""

import gc
import math
import time
import tracemalloc
from collections.abc import Callable, Iterable, Mapping

import numpy as np
import pinocchio as pin
from threadpoolctl import threadpool_limits

TURN = 0.1
"""A turn takes at least so long [s]: what is short is repeated, or it alone would find a quiet moment."""


def best_of_turns(works: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Processor time of each work [s], the best of so many rounds.

    In each round every work has its turn, so that other load on the machine meets all alike. One thread each.
    """
    with threadpool_limits(1):
        for work in works.values():
            work()  # imports, caches
        repeats = {name: math.ceil(TURN / seconds(work, 1)) for name, work in works.items()}
        gc.collect()
        gc.disable()
        try:
            turns = [[seconds(work, repeats[name]) for name, work in works.items()] for _ in range(rounds)]
        finally:
            gc.enable()
    return dict(zip(works, np.min(turns, axis=0).tolist(), strict=True))


def seconds(work: Callable[[], object], repeats: int) -> float:
    """Processor time of one of several runs, on average [s]."""
    start = time.process_time()
    for _ in range(repeats):
        work()
    return (time.process_time() - start) / repeats


def looped(model: pin.Model, motion: Iterable[np.ndarray], out: np.ndarray | None = None) -> np.ndarray | None:
    """Pinocchio's regressor sample by sample: kept in ``out``, (N, rows, 10 bodies), or thrown away."""
    data = model.createData()
    for k, (q, v, a) in enumerate(zip(*motion, strict=True)):
        found = pin.computeJointTorqueRegressor(model, data, q, v, a)
        if out is not None:
            out[k] = found
    return out


def with_memory(work: Callable[[], object]) -> tuple[object, int]:
    """What a work returns, and the most memory that it takes [bytes]."""
    gc.collect()
    tracemalloc.start()
    try:
        return work(), tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def show(title: str, best: Mapping[str, float], baseline: str) -> None:
    """Print times, and their ratios to that of the baseline."""
    print(f"\n{title}")
    for name, seconds in best.items():
        ratio = "" if name == baseline else f"{seconds / best[baseline]:8.2f} ×"
        print(f"  {name:58s} {1e3 * seconds:9.4g} ms {ratio}")
