"""Who does the chunks: this process, several on this machine, or a Dask cluster."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import NamedTuple

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

    Args:
        count: Number of processes.

    Raises:
        ExoidError: There is none, or (when used) they die again and again.
    """
    if count < 1:
        raise ExoidError(f"{count} workers", remedy="ask for at least one")

    def work(study: Study, numbers: Sequence[int]) -> Iterator[Done]:
        left, failures = list(numbers), 0
        while left:
            try:
                for done in _with_pool(count, study, tuple(left)):
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


def _with_pool(count: int, study: Study, numbers: Sequence[int]) -> Iterator[Done]:
    context = multiprocessing.get_context("spawn")  # as on every platform, and safe beside threads
    with ProcessPoolExecutor(min(count, len(numbers)), mp_context=context) as pool:
        futures = {pool.submit(run_chunk, study, number): number for number in numbers}
        try:
            for future in as_completed(futures):
                yield Done(futures[future], future.result())
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


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
