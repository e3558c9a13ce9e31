"""The documents' figures, drawn from the replay's data."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from exoid._typing import FloatArray
from exoid.experiments.gait import healthy_gait
from exoid.files import write_bytes
from exoid.identification.rows import make_rows
from exoid.identification.sequential.bleex import FASTER_THAN, document_model
from exoid.identification.sequential.rows import JointRows, dynamic_rows
from exoid.signals import Approaches, FiniteDifference, Poses
from exoid.view import (
    paper,
    plot_approaches,
    plot_friction,
    plot_inertial_torque,
    plot_reference,
    plot_stiffness,
    plot_torques,
)
from exoid.view.style import CAD, COLUMN, IDENTIFIED

from .bleex import VALIDATION_FILTER, SideReplay
from .cuhk import CuhkReplay

KNEE, ANKLE = 1, 2
MIDDLE = 2
"""Of the five frequencies: 0.6 Hz."""
SHOWN = 8.0
"""Of a motion [s], at most."""


def write_bleex_figures(side: SideReplay, folder: str | Path) -> list[Path]:
    """Write figures 3 to 7 of document 1 as PNG files.

    Raises:
        ExoidError: The folder cannot be written.
    """
    figures = {
        "doc1_fig3_static_friction": _static_friction,
        "doc1_fig4_stiffness": _stiffness,
        "doc1_fig5_inertia": _inertia,
        "doc1_fig6_kinetic_friction": _kinetic_friction,
        "doc1_fig7_validation": _validation,
    }
    return _write({name: partial(draw, side) for name, draw in figures.items()}, folder)


def write_cuhk_figures(replay: CuhkReplay, folder: str | Path) -> list[Path]:
    """Write figures 3 and 6 of document 2 as PNG files.

    Raises:
        ExoidError: The folder cannot be written.
    """
    return _write({"doc2_fig3_validation": partial(_cuhk_validation, replay), "doc2_fig6_reference": _gait}, folder)


def _static_friction(side: SideReplay) -> Figure:
    both, count = side.data.upright, len(side.data.sets.ankle)
    ankle = Approaches(_first(both.below, count // 3), _first(both.above, count // 3))
    figure = _figure(0.75)
    plot_approaches(figure.add_subplot(), ankle, ANKLE, "ankle")
    return figure


def _stiffness(side: SideReplay) -> Figure:
    sets, poses = side.data.sets, side.data.upright.averaged
    totals = [np.rad2deg(sets.ankle[sets.ankle_set == k].sum(axis=1)[0]) for k in np.unique(sets.ankle_set)]
    figure = _figure(0.75)
    ankle = _first(poses, len(sets.ankle))
    plot_stiffness(figure.add_subplot(), ankle, sets.ankle_set, np.array(totals), ANKLE, "ankle")
    return figure


def _inertia(side: SideReplay) -> Figure:
    recording = side.data.swings[KNEE][MIDDLE]
    rows, values = _ankle_rows(side, KNEE), side.sequential.as_dict()
    rest = rows.tau - _explained(rows, values, without=("J3", "c0_ankle"))
    time = recording.time[1:-1] - recording.time[0]
    shown = time < 0.5 * SHOWN
    figure = _figure(0.75)
    plot_inertial_torque(
        figure.add_subplot(), time[shown], rest[shown], rows.columns["J3"][shown] * values["J3"], "ankle"
    )
    return figure


def _kinetic_friction(side: SideReplay) -> Figure:
    rows, values = _ankle_rows(side, ANKLE), side.sequential.as_dict()
    friction = rows.tau - _explained(rows, values, without=("c0_ankle",))
    velocity = rows.v[:, ANKLE]
    fast = np.abs(velocity) > FASTER_THAN
    figure = _figure(0.75)
    plot_friction(figure.add_subplot(), velocity[fast], friction[fast], values["c0_ankle"], "ankle")
    return figure


def _validation(side: SideReplay) -> Figure:
    model = side.joint.model
    rows = make_rows(model, side.data.validation, VALIDATION_FILTER)
    identified = dict(zip(model.names, side.joint.values, strict=True))
    shown = rows.time - rows.time[0] < SHOWN
    predictions = [
        (name, rows.W[shown] @ np.array([values.get(parameter, 0.0) for parameter in model.names]), colour)
        for name, values, colour in (("CAD", side.cad, CAD), ("identified", identified, IDENTIFIED))
    ]
    figure = _figure(1.5)
    axes = figure.subplots(3, 1, sharex=True)
    plot_torques(axes, rows.time[shown] - rows.time[0], rows.tau[shown], predictions, ("hip", "knee", "ankle"))
    return figure


def _cuhk_validation(replay: CuhkReplay) -> Figure:
    figure = _figure(1.1)
    axes = figure.subplots(2, 1, sharex=True)
    time = np.arange(len(replay.measured)) / replay.validation.sample_rate
    shown = time < 2.0 * SHOWN
    identified = ("identified", replay.predicted[shown], IDENTIFIED)
    plot_torques(axes, time[shown], replay.measured[shown], [identified], ("hip", "knee"))
    return figure


def _gait() -> Figure:
    motion, time = healthy_gait(), np.linspace(0.0, 20.0, 600)
    q = np.array([motion.at(t).q[:, 0] for t in time])
    figure = _figure(0.75)
    plot_reference(figure.add_subplot(), time, q, ("hip", "knee"))
    return figure


def _ankle_rows(side: SideReplay, moving: int) -> JointRows:
    """The ankle's equation while one joint swings, by the document's finite differences."""
    model = document_model(side.leg)
    return dynamic_rows(model, [side.data.swings[moving][MIDDLE]], ANKLE, FiniteDifference())


def _explained(rows: JointRows, values: Mapping[str, float], without: tuple[str, ...]) -> FloatArray:
    """Torque that the known parameters explain, some of them left out [N·m], (M,)."""
    return np.asarray(
        np.sum([rows.columns[name] * value for name, value in values.items() if name not in without], axis=0)
    )


def _first(poses: Poses, count: int) -> Poses:
    return Poses(poses.q[:count], poses.tau[:count], poses.joint_names)


def _figure(aspect: float) -> Figure:
    return Figure(figsize=(COLUMN, aspect * COLUMN))


def _write(draw: Mapping[str, Callable[[], Figure]], folder: str | Path) -> list[Path]:
    written = []
    for name, make in draw.items():
        with paper():
            figure = make()
            image = io.BytesIO()
            figure.savefig(image, format="png")
        path = Path(folder) / f"{name}.png"
        write_bytes(path, [image.getvalue()])
        written.append(path)
    return written
