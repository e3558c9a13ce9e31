"""Running a study to its end, from wherever it stands."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from .design import TRUTH, Driver, Study
from .folder import Folder
from .law_figures import LawFigures
from .replicates import Outcomes
from .result import Combination, StudyResult
from .workers import Workers, run_serially


def run_study(
    study: Study,
    folder: str | Path | None = None,
    workers: Workers = run_serially,
    progress: Callable[[float], None] | None = None,
) -> StudyResult:
    """Do what is left of a study, and put all chunks together in the order of their numbers.

    The result is the same, bit for bit, whoever does the chunks, in whatever order, and however often it was killed.

    Args:
        study: What to do.
        folder: Where finished chunks are kept; None for nowhere.
        workers: Who does the chunks.
        progress: Told the share that is done.

    Raises:
        ExoidError: The folder holds another study, or workers fail.
    """
    kept = None if folder is None else Folder(Path(folder), study)
    chunks: dict[int, Outcomes] = {}
    for number in range(len(study.chunks)):
        found = kept.read(number) if kept is not None else None
        if found is not None:
            chunks[number] = found
    left = [number for number in range(len(study.chunks)) if number not in chunks]
    told = progress or (lambda _: None)
    told(len(chunks) / len(study.chunks))
    for done in workers(study, left) if left else ():
        if kept is not None:
            kept.write(done.number, done.outcomes)
        chunks[done.number] = done.outcomes
        told(len(chunks) / len(study.chunks))
    with threadpool_limits(limits=1):  # as for the chunks
        return StudyResult(study, tuple(_combinations(study, chunks)), tuple(_laws(study, chunks)))


def _combinations(study: Study, chunks: dict[int, Outcomes]) -> list[Combination]:
    combinations = []
    for p, protocol in enumerate(study.protocols):
        for n, noise in enumerate(study.noises):
            values, std, inside, _ = _together(study, chunks, p, n)
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


def _laws(study: Study, chunks: dict[int, Outcomes]) -> list[LawFigures]:
    laws = []
    for p, protocol in enumerate(study.protocols):
        for n, noise in enumerate(study.noises):
            driven = _together(study, chunks, p, n).driven
            for driver, runs in zip(study.drivers, driven, strict=True):
                told = Driver(driver.law, TRUTH)
                best = driven[study.drivers.index(told)] if told in study.drivers else None
                about = (protocol.name, noise.name, *driver, study.model.leg.joint_labels)
                laws.append(LawFigures(*about, runs, best))
    return laws


def _together(study: Study, chunks: dict[int, Outcomes], protocol: int, noise: int) -> Outcomes:
    """Put the chunks of one protocol under one noise together."""
    numbers = [k for k, chunk in enumerate(study.chunks) if (chunk.protocol, chunk.noise) == (protocol, noise)]
    return Outcomes(*(np.concatenate(parts, axis=1) for parts in zip(*(chunks[k] for k in numbers), strict=True)))
