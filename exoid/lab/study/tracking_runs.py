"""Tracking by controllers that use the estimates of a chunk of a study, on the true leg."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence

import numpy as np

from exoid._typing import FloatArray
from exoid.control import ControlModel, SideBySide, simulate_many
from exoid.control.law import AnyLaw
from exoid.control.model import ModelSource
from exoid.control.standard_laws import SENSORS
from exoid.errors import ExoidError
from exoid.estimate import Estimate
from exoid.rig import Plant, Sensors

from .design import TRUTH, WITHOUT_MODEL, Chunk, Study, TrackingCase
from .tracking_task import TrackingTask

MEASURES = ("rms_deg", "peak_deg", "rms_torque")
"""Metrics of :class:`exoid.control.Tracking`, by joint."""

Laws = Sequence[AnyLaw | None]
"""One controller for each replicate; None if it cannot be made, as from an estimate that is not physical."""


def track_cases(study: Study, chunk: Chunk, estimates: Mapping[str, Sequence[Estimate]]) -> FloatArray:
    """Run the tracking task for each case and replicate: D cases, R replicates, n joints."""
    # The virtual leg is the true one. An offset is torque that the joint needs, on the scale of the sensor of the
    # identification. All cases of a replicate have the same sensor noise.
    course = study.course
    assert course is not None
    truth = ControlModel.of_parameters(study.model, np.array(study.truth))
    exact = [truth] * chunk.replicates
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # about negative friction due to noise
        laws = [_laws(course, case, estimates.get(case.knows, exact)) for case in study.tracking_cases]
    seed = (study.seed, chunk.protocol, chunk.noise, chunk.first, 2)
    return np.array(_runs(truth.plant(), course, laws, seed))


def _laws(course: TrackingTask, case: TrackingCase, known: Sequence[ModelSource]) -> Laws:
    """Make the controllers of one case; replicates with the same parameters share one."""
    if case.law == WITHOUT_MODEL or case.knows == TRUTH:
        return (course.law(case.law, known[0]),) * len(known)
    laws: list[AnyLaw | None] = []
    for model in known:
        try:
            laws.append(course.law(case.law, model))
        except ExoidError:
            laws.append(None)
    return laws


def _runs(plant: Plant, course: TrackingTask, laws: Sequence[Laws], seed: tuple[int, ...]) -> list[FloatArray]:
    """Run all cases in parallel; if one diverges, run each case separately, and its replicates one by one."""
    # Cases that run separately have the same noise; replicates that run one by one have different noise.
    if plant.leg.chain is not None and all(law is not None for each in laws for law in each):
        try:
            runs = _simulate(plant, course, tuple(law for each in laws for law in each), len(laws), seed)
            return list(runs.reshape(len(laws), -1, *runs.shape[1:]))
        except ExoidError:  # diverged: all other errors are raised when the study is made
            pass
    if len(laws) > 1:
        return [run for each in laws for run in _runs(plant, course, [each], seed)]
    return [np.array([_alone(plant, course, law, (*seed, k)) for k, law in enumerate(laws[0])])]


def _alone(plant: Plant, course: TrackingTask, law: AnyLaw | None, seed: tuple[int, ...]) -> FloatArray:
    """Metrics of one replicate; NaN if it diverges, or if it has no controller."""
    lost = np.full((len(MEASURES), plant.n), np.nan)
    try:
        return lost if law is None else _simulate(plant, course, (law,), 1, seed)[0]
    except ExoidError:
        return lost


def _simulate(
    plant: Plant, course: TrackingTask, laws: tuple[AnyLaw | None, ...], alike: int, seed: tuple[int, ...]
) -> FloatArray:
    """Metrics of each controller, (L, 3, n)."""
    made = tuple(law for law in laws if law is not None)
    noise = Sensors(SENSORS.encoder_counts, SENSORS.angle_noise, SENSORS.velocity_noise, noise_blocks=alike)
    runs = simulate_many(
        plant.repeat(len(made)),
        SideBySide(made),
        course.motion,
        course.seconds,
        sensors=noise,
        settle=course.period,
        seed=np.random.default_rng(seed),
    )
    return np.array([[getattr(run, name) for name in MEASURES] for run in runs])
