"""Run of a study by joblib: here, in several processes, or by Dask."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

import numpy as np
from joblib import Parallel, delayed, parallel_config
from threadpoolctl import threadpool_limits

from exoid.errors import BadArgumentError

from .design import Study
from .replicates import Outcomes, run_chunk
from .result import Combination, StudyResult


def run_study(
    study: Study,
    workers: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> StudyResult:
    """Run the chunks of a study, and combine them in the order of their numbers.

    The result is bit-identical for any workers and any order of the chunks.

    Args:
        study: The study.
        workers: Number of processes on this machine; None for joblib's backend, which is this process unless
            ``joblib.parallel_config`` names another, such as "dask".
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        Statistics of all combinations.

    Raises:
        ExoidError: The number of workers is below one.
    """
    if workers is not None and workers < 1:
        raise BadArgumentError(f"{workers} workers", remedy="ask for at least one")
    chunks: dict[int, Outcomes] = {}
    backend = {} if workers is None else {"n_jobs": workers, "backend": "loky"}
    parallel = Parallel(return_as="generator_unordered", batch_size=1, **backend)
    for number, outcomes in parallel(delayed(_run)(study, number) for number in range(len(study.chunks))):
        chunks[number] = outcomes
        if progress is not None:
            progress(len(chunks) / len(study.chunks))
    with threadpool_limits(limits=1):  # as for the chunks
        return StudyResult(study, tuple(_combinations(study, chunks)))


def _run(study: Study, number: int) -> tuple[int, Outcomes]:
    with parallel_config("sequential"):  # a chunk is not distributed again
        return number, run_chunk(study, number)


def _combinations(study: Study, chunks: dict[int, Outcomes]) -> Iterator[Combination]:
    """Statistics of each protocol, noise and estimator, all chunks combined."""
    for p, n in itertools.product(range(len(study.protocols)), range(len(study.noises))):
        own = [chunks[k] for k, chunk in enumerate(study.chunks) if (chunk.protocol, chunk.noise) == (p, n)]
        values, std, inside = (np.concatenate(parts, axis=1) for parts in zip(*own, strict=True))
        bound, truth = study.bound(p, n), np.array(study.truth)
        for e, name in enumerate(study.estimators):
            errors = values[e] - truth
            yield Combination(
                protocol=study.protocols[p].name,
                noise=study.noises[n].name,
                estimator=name,
                names=study.model.names,
                units=study.model.units,
                bias=errors.mean(axis=0),
                std=errors.std(axis=0, ddof=1),
                stated=np.sqrt((std[e] ** 2).mean(axis=0)),
                coverage=inside[e].mean(axis=0),
                bound=bound,
                replicates=len(errors),
            )
