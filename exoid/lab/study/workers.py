"""Workers that run the chunks: this process, several on this machine, or those of joblib's backend."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from typing import NamedTuple

from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky import get_reusable_executor

from exoid.errors import ExoidError

from .design import Study
from .replicates import Outcomes, run_chunk

ATTEMPTS = 5
"""Number of times in a row that all workers may die before a chunk is finished."""


class Done(NamedTuple):
    """A finished chunk.

    Attributes:
        number: Number of the chunk.
        outcomes: Results of its replicates.
    """

    number: int
    outcomes: Outcomes


Workers = Callable[[Study, Sequence[int]], Iterator[Done]]
"""Function that runs chunks of a study by their numbers, in any order."""


def run_serially(study: Study, numbers: Sequence[int]) -> Iterator[Done]:
    """Run chunks in this process, one after the other.

    Args:
        study: The study.
        numbers: Numbers of the chunks.

    Yields:
        Each chunk as it is finished.
    """
    for number in numbers:
        yield Done(number, run_chunk(study, number))


def processes(count: int) -> Workers:
    """Run chunks in several processes on this machine; a killed one is replaced, and its chunk repeated.

    joblib keeps the processes for the next study of the same interpreter, and stops idle ones after five minutes.

    Args:
        count: Number of processes.

    Returns:
        Function that runs the chunks.

    Raises:
        ExoidError: The number is not positive, or (when used) the processes die repeatedly.
    """
    if count < 1:
        raise ExoidError(f"{count} workers", remedy="ask for at least one")

    def work(study: Study, numbers: Sequence[int]) -> Iterator[Done]:
        """Yield chunks as they are done."""
        left, failures = set(numbers), 0
        while left:
            parallel = Parallel(min(count, len(left)), "loky", return_as="generator_unordered", batch_size=1)
            try:
                for done in parallel(delayed(_done)(study, number) for number in sorted(left)):
                    left.remove(done.number)
                    failures = 0
                    yield done
            except BrokenProcessPool:
                failures += 1
                if failures >= ATTEMPTS:
                    raise ExoidError(
                        f"workers died {failures} times without finishing a chunk",
                        remedy="give the study more memory, or fewer workers",
                    ) from None
            except BaseException:  # Ctrl-C, SIGTERM, or a caller that wants no more chunks
                get_reusable_executor().shutdown(wait=False, kill_workers=True)
                raise

    return work


def _done(study: Study, number: int) -> Done:
    with parallel_config("sequential"):  # a chunk is not distributed again
        return Done(number, run_chunk(study, number))


def joblib_backend(study: Study, numbers: Sequence[int]) -> Iterator[Done]:
    """Run chunks on the workers of joblib's backend, such as those of a Dask cluster.

    Args:
        study: The study.
        numbers: Numbers of the chunks.

    Yields:
        Each chunk as it is finished.

    Example:
        >>> with distributed.Client("tcp://host:8786"), joblib.parallel_config("dask"):  # doctest: +SKIP
        ...     run_study(study, workers=joblib_backend)
    """
    parallel = Parallel(return_as="generator_unordered", batch_size=1)
    yield from parallel(delayed(_done)(study, number) for number in numbers)
