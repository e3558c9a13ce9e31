"""Replicates of one chunk of a study: recording and identification."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from exoid._typing import FloatArray
from exoid.experiments import Bench
from exoid.experiments.bench import run_motion, stiff_servo
from exoid.identification import identify
from exoid.rig import IdealTorque, Plant, Rates, Sensors
from exoid.signals import Recording

from .design import Chunk, Study

CONTROL, STEP = 500.0, 2e-3
"""Rate of the servo of the rigs [Hz], and step of the simulation [s]."""


class Outcomes(NamedTuple):
    """Results of the replicates of a chunk; E estimators, R replicates, P parameters."""

    values: FloatArray  # estimates, (E, R, P)
    std: FloatArray  # standard deviations that the estimates state, (E, R, P)
    inside: NDArray[np.bool_]  # whether 95 % intervals contain the truth, (E, R, P)


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
    return Outcomes(values, std, inside)


def _recorded(study: Study, chunk: Chunk) -> Iterator[list[Recording]]:
    """Recordings of each replicate."""
    noise = study.noises[chunk.noise]
    clean = _by_rig(study, chunk) if study.followed == "by a rig" else _exactly(study, chunk)
    for replicate in range(chunk.replicates):
        rng = np.random.default_rng([study.seed, chunk.protocol, chunk.noise, chunk.first + replicate])
        noisy = []
        for of_motion in clean:
            recording = of_motion[replicate % len(of_motion)]
            assert recording.tau is not None
            noisy.append(replace(recording, tau=recording.tau + noise.draw(rng, len(recording), study.rate)))
        yield noisy


def _exactly(study: Study, chunk: Chunk) -> list[list[Recording]]:
    """One recording without noise of each motion, for all replicates."""
    protocol, model, clean = study.protocols[chunk.protocol], study.model, []
    for k in range(len(protocol.motions)):
        states, torso = protocol.states(k, study.rate), protocol.torso(k)
        tau = model.regressor(*states, torso) @ np.array(study.truth)
        time = np.arange(len(states.q)) / study.rate
        clean.append([Recording(time, *states, tau, joint_names=model.leg.joint_names, torso=torso)])
    return clean


def _by_rig(study: Study, chunk: Chunk) -> list[list[Recording]]:
    """Recordings of each motion by rigs in parallel, one for each replicate, with slightly different initial states."""
    protocol, model, clean = study.protocols[chunk.protocol], study.model, []
    named = dict(zip(model.names, study.truth, strict=True))
    offset = [named.pop(f"offset_{label}", 0.0) for label in model.leg.joint_labels]
    bench = Bench(
        stiff_servo(Plant.build(model.leg, named)),
        IdealTorque(),
        Sensors(angle_noise=np.pi / Sensors.encoder_counts, torque_offset=offset),
        Rates(control=CONTROL, log=study.rate, step=STEP),
    )
    rng = np.random.default_rng([study.seed, chunk.protocol, chunk.noise, chunk.first, 1])
    for k, motion in enumerate(protocol.motions):
        plant = Plant.build(model.leg, named, pitch=protocol.pitches[k]).repeat(chunk.replicates)
        run = run_motion(plant, motion, bench, protocol.seconds, rng)
        clean.append([run.recording(rig) for rig in range(chunk.replicates)])
    return clean
