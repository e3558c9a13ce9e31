"""Times that can be compared: several works in one process, in turns, the best of each."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping

import numpy as np
from threadpoolctl import threadpool_limits


def best_of_turns(works: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Processor time of each work [s], the best of so many rounds.

    In each round every work has its turn, so that other load on the machine meets all alike. One thread each.
    """
    best = dict.fromkeys(works, np.inf)
    with threadpool_limits(1):
        for work in works.values():
            work()  # imports, caches
        gc.collect()
        gc.disable()
        try:
            for _ in range(rounds):
                for name, work in works.items():
                    start = time.process_time()
                    work()
                    best[name] = min(best[name], time.process_time() - start)
        finally:
            gc.enable()
    return best


def show(title: str, best: Mapping[str, float], ours: str) -> None:
    """Print times and what they are to ours."""
    print(f"\n{title}")
    for name, seconds in best.items():
        ratio = "" if name == ours else f"{seconds / best[ours]:8.2f} ×"
        print(f"  {name:58s} {1e3 * seconds:9.1f} ms {ratio}")
