"""Figures of the documents, drawn from the data of the replays."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from exoid.experiments import healthy_gait
from exoid.signals import Approaches, FiniteDifference
from exoid.view import (
    paper,
    plot_approaches,
    plot_friction,
    plot_inertial_torque,
    plot_reference,
    plot_stiffness,
    plot_torques,
)
from exoid.view.colours import CAD, IDENTIFIED
from exoid.view.style import COLUMN

from .bleex import SideReplay
from .cuhk import CuhkReplay
from .sequential.bleex import MIN_SPEED, document_model
from .sequential.rows import rows_in_motion
from .torque_error import by_name, predicted_torque, validation_rows

KNEE, ANKLE = 1, 2
MIDDLE = 2
"""Index of the middle frequency, 0.6 Hz."""

SHOWN = 8.0
"""Longest part of a motion that is drawn [s]."""


def bleex_figures(side: SideReplay) -> dict[str, Figure]:
    """Draw figures 3 to 7 of document 1.

    Args:
        side: Replay of one leg.

    Returns:
        Figures by name.
    """
    with paper():
        return {
            "doc1_fig3_static_friction": _static_friction(side),
            "doc1_fig4_stiffness": _stiffness(side),
            "doc1_fig5_inertia": _inertia(side),
            "doc1_fig6_kinetic_friction": _kinetic_friction(side),
            "doc1_fig7_validation": _validation(side),
        }


def cuhk_figures(replay: CuhkReplay) -> dict[str, Figure]:
    """Draw figures 3 and 6 of document 2.

    Args:
        replay: Replay of document 2.

    Returns:
        Figures by name.
    """
    with paper():
        return {"doc2_fig3_validation": _cuhk_validation(replay), "doc2_fig6_reference": _gait()}


def _static_friction(side: SideReplay) -> Figure:
    """First set of ankle poses, with constant θ123."""
    count = int((side.data.sets.ankle_set == 0).sum())
    both = Approaches(*(poses.take(slice(count)) for poses in (side.data.upright.below, side.data.upright.above)))
    figure = _figure(0.7)
    plot_approaches(figure.add_subplot(), both, ANKLE, "ankle")
    return figure


def _stiffness(side: SideReplay) -> Figure:
    sets = side.data.sets
    totals = [np.rad2deg(sets.ankle[sets.ankle_set == k].sum(axis=1)[0]) for k in np.unique(sets.ankle_set)]
    ankle = side.data.upright.averaged.take(slice(len(sets.ankle)))
    figure = _figure(0.7)
    plot_stiffness(figure.add_subplot(), ankle, sets.ankle_set, np.array(totals), ANKLE, "ankle")
    return figure


def _inertia(side: SideReplay) -> Figure:
    """Both sides of doc. 1, eq. (29): ankle torque proportional to the knee acceleration, and measured torque."""
    model, recording = document_model(side.leg), side.data.swings[KNEE][MIDDLE].resampled()
    values = np.array([side.sequential.as_dict().get(name, 0.0) for name in model.names])
    values[model.names.index("c0_ankle")] = 0.0  # neglected as in the step for J3
    q, v, a, valid = FiniteDifference().kinematics(recording)
    still = (model.regressor(q, v, np.zeros_like(a)) @ values)[valid, ANKLE]
    inertial = (model.regressor(q, v, a) @ values)[valid, ANKLE] - still
    time = recording.time[valid] - recording.time[valid][0]
    shown = time < 0.5 * SHOWN
    figure = _figure(0.7)
    measured = np.asarray(recording.tau)[valid, ANKLE] - still
    plot_inertial_torque(figure.add_subplot(), time[shown], measured[shown], inertial[shown], "ankle")
    return figure


def _kinetic_friction(side: SideReplay) -> Figure:
    """Doc. 1, eq. (33) with the opposite sign, without samples near the reversals."""
    values = side.sequential.as_dict()
    recordings = [side.data.swings[ANKLE][MIDDLE]]
    rows = rows_in_motion(document_model(side.leg), recordings, ANKLE, FiniteDifference())
    rows = rows.where(np.abs(rows.v) > MIN_SPEED)
    figure = _figure(0.7)
    friction = rows.tau - rows.explained(values, without=("c0_ankle",))
    plot_friction(figure.add_subplot(), rows.v, friction, values["c0_ankle"], "ankle")
    return figure


def _validation(side: SideReplay) -> Figure:
    model = side.joint.model
    rows = validation_rows(model, side.data.validation)
    shown = rows.time - rows.time[0] < SHOWN
    predictions = [
        (name, predicted_torque(model, values, rows)[shown], colour)
        for name, values, colour in (("CAD", side.cad, CAD), ("identified", by_name(side.joint), IDENTIFIED))
    ]
    figure = _figure(1.4)
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
    figure = _figure(0.7)
    plot_reference(figure.add_subplot(), time, q, ("hip", "knee"))
    return figure


def _figure(aspect: float) -> Figure:
    return Figure(figsize=(COLUMN, aspect * COLUMN))
