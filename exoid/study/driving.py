"""Laws that know what a chunk of a study identified, on the leg as it truly is."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.control import ControlModel, Law, SideBySide, Tracking, simulate_many
from exoid.control.track import SENSORS
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.rig import Plant, Sensors

from .design import BLIND, TRUTH, Chunk, Driver, Study
from .tracking_task import TrackingTask

MEASURES = ("rms_deg", "peak_deg", "rms_torque")
"""Of :class:`exoid.control.Tracking`, by joint."""

Laws = Sequence[Law | None]
"""One a replicate; None where there is none, as for an estimate that no leg can have."""


def drive(study: Study, chunk: Chunk, estimates: Mapping[str, Sequence[Estimate]]) -> FloatArray:
    """Let each driver follow the course in each replicate; D drivers, R replicates, n joints.

    The virtual leg is the true one. An offset is torque that the joint needs, on the scale of the sensor that it was
    identified with. All drivers of a replicate meet the same sensor noise.

    Args:
        study: With a course.
        chunk: Whose replicates.
        estimates: By estimator, one a replicate.

    Returns:
        MEASURES of each run, (D, R, 3, n); NaN where it diverged.
    """
    course = study.course
    assert course is not None
    truth = ControlModel.of_parameters(study.model, np.array(study.truth))
    known = {name: [ControlModel.of(estimate) for estimate in each] for name, each in estimates.items()}
    exact = [truth] * chunk.replicates
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of friction that noise made negative: results show what it does
        laws = [_laws(course, driver, known.get(driver.knows, exact)) for driver in study.drivers]
    seed = (study.seed, chunk.protocol, chunk.noise, chunk.first, 2)
    return np.array(_runs(truth.plant(), course, laws, seed))


def _laws(course: TrackingTask, driver: Driver, known: Sequence[ControlModel]) -> Laws:
    """Laws of one driver; those that know the same are one."""
    if driver.law == BLIND or driver.knows == TRUTH:
        return (course.law(driver.law, known[0]),) * len(known)
    laws: list[Law | None] = []
    for model in known:
        try:
            laws.append(course.law(driver.law, model))
        except ExoidError:
            laws.append(None)
    return laws


def _runs(plant: Plant, course: TrackingTask, laws: Sequence[Laws], seed: tuple[int, ...]) -> list[FloatArray]:
    """Run all drivers side by side; where one diverges each by itself, and its replicates one by one.

    Each by itself meets the same noise still; replicates one by one have noise of their own.
    """
    if plant.leg.chain is not None and all(law is not None for each in laws for law in each):
        try:
            return _side_by_side(plant, course, laws, seed)
        except ExoidError:  # diverged, as everything else was refused when the study was made
            pass
    if len(laws) > 1:
        return [run for each in laws for run in _runs(plant, course, [each], seed)]
    return [np.array([_alone(plant, course, law, (*seed, k)) for k, law in enumerate(laws[0])])]


def _side_by_side(plant: Plant, course: TrackingTask, laws: Sequence[Laws], seed: tuple[int, ...]) -> list[FloatArray]:
    every = tuple(law for each in laws for law in each if law is not None)
    runs = _simulate(plant, course, every, len(laws), seed)
    figures = np.array([_figures(run) for run in runs])
    return list(figures.reshape(len(laws), -1, *figures.shape[1:]))


def _alone(plant: Plant, course: TrackingTask, law: Law | None, seed: tuple[int, ...]) -> FloatArray:
    try:
        return _figures(_simulate(plant, course, (law,), 1, seed)[0]) if law is not None else _lost(plant)
    except ExoidError:
        return _lost(plant)


def _simulate(
    plant: Plant, course: TrackingTask, laws: tuple[Law, ...], alike: int, seed: tuple[int, ...]
) -> tuple[Tracking, ...]:
    noise = Sensors(SENSORS.encoder_counts, SENSORS.angle_noise, SENSORS.velocity_noise, noise_blocks=alike)
    return simulate_many(
        plant.repeat(len(laws)),
        SideBySide(laws),
        course.motion,
        course.seconds,
        sensors=noise,
        settle=course.period,
        seed=np.random.default_rng(seed),
    )


def _figures(run: Tracking) -> FloatArray:
    return np.array([getattr(run, name) for name in MEASURES])


def _lost(plant: Plant) -> FloatArray:
    return np.full((len(MEASURES), plant.n), np.nan)
