"""Run of a study to its end, from its finished chunks, by joblib: here, in several processes, or by Dask."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

import numpy as np
from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky import get_reusable_executor
from threadpoolctl import threadpool_limits

from exoid.errors import BadArgumentError, NotSupportedError

from .design import Study
from .folder import Folder
from .replicates import Outcomes, run_chunk
from .result import Combination, StudyResult

ATTEMPTS = 5
"""Number of times in a row that all workers may die before a chunk is finished."""


def run_study(
    study: Study,
    folder: str | Path | None = None,
    workers: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> StudyResult:
    """Run the chunks of a study that are not finished, and combine all in the order of their numbers.

    The result is bit-identical for any workers, any order of the chunks, and after any interruption.

    Args:
        study: The study.
        folder: Folder of finished chunks; None to keep none.
        workers: Number of processes on this machine; None for joblib's backend, which is this process unless
            ``joblib.parallel_config`` names another, such as "dask".
        progress: Function that receives the completed share, 0 to 1.

    Returns:
        Statistics of all combinations.

    Raises:
        ExoidError: The folder holds another study, or workers fail.
    """
    if workers is not None and workers < 1:
        raise BadArgumentError(f"{workers} workers", remedy="ask for at least one")
    kept = None if folder is None else Folder(Path(folder), study)
    chunks: dict[int, Outcomes] = {}
    for number in range(len(study.chunks)):
        found = kept.read(number) if kept is not None else None
        if found is not None:
            chunks[number] = found
    left = [number for number in range(len(study.chunks)) if number not in chunks]
    report = progress or (lambda _: None)
    report(len(chunks) / len(study.chunks))
    for number, outcomes in run_chunks(study, left, workers):
        if kept is not None:
            kept.write(number, outcomes)
        chunks[number] = outcomes
        report(len(chunks) / len(study.chunks))
    with threadpool_limits(limits=1):  # as for the chunks
        return StudyResult(study, tuple(_combinations(study, chunks)))


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
                raise NotSupportedError(
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
