"""Workers that run the chunks: this process, several on this machine, or a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from typing import NamedTuple

from joblib import Parallel, delayed
from joblib.externals.loky import get_reusable_executor

from exoid.errors import ExoidError
from exoid.signals.cluster import connect

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
    return Done(number, run_chunk(study, number))


def dask_cluster(address: str) -> Workers:
    """Run chunks on an existing Dask cluster; its workers need exoid installed, but no shared disk.

    Args:
        address: Address of the scheduler, ``tcp://host:port``.

    Returns:
        Function that runs the chunks.

    Raises:
        ExoidError: (When used) Dask is not installed, the scheduler does not answer, or workers die repeatedly.
    """

    def work(study: Study, numbers: Sequence[int]) -> Iterator[Done]:
        """Yield chunks as they are done."""
        with connect(address) as client:
            import distributed  # noqa: PLC0415 - an extra, which connect() requires

            futures = {client.submit(run_chunk, study, number, pure=False): number for number in numbers}
            for future in distributed.as_completed(futures):
                try:
                    yield Done(futures[future], future.result())
                except distributed.KilledWorker as error:
                    raise ExoidError(
                        "workers of the cluster died repeatedly", where=address, remedy="give them more memory"
                    ) from error

    return work
