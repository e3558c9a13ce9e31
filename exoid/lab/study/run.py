"""Run of a study to its end, from its finished chunks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from exoid.errors import BadArgumentError

from .design import TRUTH, Study, TrackingCase
from .folder import Folder
from .replicates import Outcomes
from .result import Combination, StudyResult
from .tracking_statistics import TrackingStatistics
from .workers import run_chunks


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
        Statistics of all combinations and controllers.

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
        return StudyResult(study, tuple(_combinations(study, chunks)), tuple(_laws(study, chunks)))


def _combinations(study: Study, chunks: dict[int, Outcomes]) -> list[Combination]:
    combinations = []
    for p, protocol in enumerate(study.protocols):
        for n, noise in enumerate(study.noises):
            values, std, inside, _ = _combined(study, chunks, p, n)
            bound, truth = study.bound(p, n), np.array(study.truth)
            for e, name in enumerate(study.estimators):
                errors = values[e] - truth
                combinations.append(
                    Combination(
                        protocol=protocol.name,
                        noise=noise.name,
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
                )
    return combinations


def _laws(study: Study, chunks: dict[int, Outcomes]) -> list[TrackingStatistics]:
    laws = []
    for p, protocol in enumerate(study.protocols):
        for n, noise in enumerate(study.noises):
            tracking, cases = _combined(study, chunks, p, n).tracking, study.tracking_cases
            for case, runs in zip(cases, tracking, strict=True):
                exact = TrackingCase(case.law, TRUTH)
                best = tracking[cases.index(exact)] if exact in cases else None
                about = (protocol.name, noise.name, *case, study.model.leg.joint_labels)
                laws.append(TrackingStatistics(*about, runs, best))
    return laws


def _combined(study: Study, chunks: dict[int, Outcomes], protocol: int, noise: int) -> Outcomes:
    """Combine the chunks of one protocol and noise."""
    numbers = [k for k, chunk in enumerate(study.chunks) if (chunk.protocol, chunk.noise) == (protocol, noise)]
    return Outcomes(*(np.concatenate(parts, axis=1) for parts in zip(*(chunks[k] for k in numbers), strict=True)))
