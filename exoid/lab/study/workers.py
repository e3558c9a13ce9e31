"""Workers that run the chunks, by joblib: this process, several on this machine, or those of joblib's backend."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool

from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky import get_reusable_executor

from exoid.errors import ExoidError

from .design import Study
from .replicates import Outcomes, run_chunk

ATTEMPTS = 5
"""Number of times in a row that all workers may die before a chunk is finished."""


def run_chunks(study: Study, numbers: Sequence[int], workers: int | None = None) -> Iterator[tuple[int, Outcomes]]:
    """Run chunks by their numbers, in any order; a process that is killed is replaced, and its chunk repeated."""
    left, failures = set(numbers), 0
    backend = {} if workers is None else {"n_jobs": min(workers, len(left)), "backend": "loky"}
    while left:
        parallel = Parallel(return_as="generator_unordered", batch_size=1, **backend)
        try:
            for number, outcomes in parallel(delayed(_run)(study, number) for number in sorted(left)):
                left.remove(number)
                failures = 0
                yield number, outcomes
        except BrokenProcessPool:
            failures += 1
            if failures >= ATTEMPTS:
                raise ExoidError(
                    f"workers died {failures} times without finishing a chunk",
                    remedy="give the study more memory, or fewer workers",
                ) from None
        except BaseException:  # Ctrl-C, SIGTERM, or a caller that wants no more chunks
            if workers is not None:
                get_reusable_executor().shutdown(wait=False, kill_workers=True)
            raise


def _run(study: Study, number: int) -> tuple[int, Outcomes]:
    with parallel_config("sequential"):  # a chunk is not distributed again
        return number, run_chunk(study, number)
