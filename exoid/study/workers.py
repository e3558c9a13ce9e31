"""Who does the chunks: this process, several on this machine, or a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from typing import NamedTuple

from joblib import Parallel, delayed

from exoid.errors import ExoidError
from exoid.signals.cluster import connect

from .design import Study
from .replicates import Outcomes, run_chunk

ATTEMPTS = 5
"""Times in a row that all workers may die before a chunk is done."""


class Done(NamedTuple):
    """A chunk that is finished."""

    number: int
    outcomes: Outcomes


Workers = Callable[[Study, Sequence[int]], Iterator[Done]]
"""Do chunks of a study by their numbers, in any order."""


def run_serially(study: Study, numbers: Sequence[int]) -> Iterator[Done]:
    """Do them in this process, one after the other."""
    for number in numbers:
        yield Done(number, run_chunk(study, number))


def processes(count: int) -> Workers:
    """Use so many processes on this machine; one that is killed is replaced, and its chunk done again.

    joblib keeps the processes for the next study of the same interpreter, and stops idle ones after five minutes.

    Args:
        count: Number of processes.

    Returns:
        What does the chunks.

    Raises:
        ExoidError: There is none, or (when used) they die again and again.
    """
    if count < 1:
        raise ExoidError(f"{count} workers", remedy="ask for at least one")

    def work(study: Study, numbers: Sequence[int]) -> Iterator[Done]:
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

    return work


def _done(study: Study, number: int) -> Done:
    return Done(number, run_chunk(study, number))


def dask_cluster(address: str) -> Workers:
    """Use an existing Dask cluster; its workers need exoid installed, but no shared disk.

    Args:
        address: Of the scheduler, ``tcp://host:port``.

    Raises:
        ExoidError: Dask is not installed, or (when used) nobody answers, or workers die again and again.
    """

    def work(study: Study, numbers: Sequence[int]) -> Iterator[Done]:
        with connect(address) as client:
            import distributed  # noqa: PLC0415 - an extra, which is there

            futures = {client.submit(run_chunk, study, number, pure=False): number for number in numbers}
            for future in distributed.as_completed(futures):
                try:
                    yield Done(futures[future], future.result())
                except distributed.KilledWorker as error:
                    raise ExoidError(
                        "workers of the cluster died again and again", where=address, remedy="give them more memory"
                    ) from error

    return work
