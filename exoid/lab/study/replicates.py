"""Replicates of one chunk of a study: recording and identification."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from exoid._typing import BoolArray, FloatArray
from exoid.identification import identify
from exoid.signals import Recording

from .design import Chunk, Study

Outcomes = tuple[FloatArray, FloatArray, BoolArray]
"""Estimates, standard deviations that they state, and whether 95 % intervals contain the truth, (E, R, P) each.

E estimators, R replicates, P parameters.
"""


def run_chunk(study: Study, number: int) -> Outcomes:
    """Record and identify the replicates of a chunk; the result is bit-identical in any process."""
    chunk, truth, model = study.chunks[number], np.array(study.truth), study.model
    shape = (len(study.estimators), chunk.replicates, len(truth))
    values, std, inside = np.empty(shape), np.empty(shape), np.empty(shape, dtype=np.bool_)
    with threadpool_limits(limits=1):
        for k, recordings in enumerate(_recorded(study, chunk)):
            for e, name in enumerate(study.estimators):
                estimate = identify(model.leg, recordings, study.terms, name, cutoff=study.cutoff, check=False)
                low, high = estimate.interval(0.95).T  # probability level of the intervals
                values[e, k], std[e, k] = estimate.values, estimate.std
                inside[e, k] = (low <= truth) & (truth <= high)
    return values, std, inside


def _recorded(study: Study, chunk: Chunk) -> Iterator[list[Recording]]:
    """Recordings of each replicate."""
    noise, protocol = study.noises[chunk.noise], study.protocols[chunk.protocol]
    clean, model = [], study.model
    for k in range(len(protocol.motions)):
        states = protocol.states(k, study.rate)
        time, tau = np.arange(len(states.q)) / study.rate, model.regressor(*states) @ np.array(study.truth)
        clean.append((Recording(time, *states, tau, joint_names=model.leg.joint_names), tau))
    for replicate in range(chunk.replicates):
        rng = np.random.default_rng([study.seed, chunk.protocol, chunk.noise, chunk.first + replicate])
        yield [replace(log, tau=tau + noise.draw(rng, len(log), study.rate)) for log, tau in clean]
