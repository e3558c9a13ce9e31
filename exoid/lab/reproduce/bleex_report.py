"""Report of a replay of document 1: its findings, figures 3 to 7, and Tables I to V."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from exoid.signals import Approaches, FiniteDifference
from exoid.tools.json_values import json_value, named
from exoid.tools.tables import DataTable
from exoid.view.colours import CAD, IDENTIFIED, PREDICTED
from exoid.view.experiments import plot_approaches, plot_stiffness, plot_torques
from exoid.view.fit import plot_friction_fit

from .bleex import BleexReplay, SideReplay
from .report import LABELS, Drawing, ReplayReport, errors_table, estimate_cells, estimate_json
from .sequential.bleex import ANKLE, KNEE, MIN_SPEED, document_model
from .sequential.estimate import rows_in_motion
from .torque_error import joint_errors, predicted_torque, validation_rows

JOINTS = ("hip", "knee", "ankle")

SHOWN = 8.0
"""Longest part of a motion that is drawn [s]."""


def bleex_report(replay: BleexReplay) -> ReplayReport:
    """Report a replay of document 1: findings and tables of both legs, figures of the left one.

    Args:
        replay: Replay of document 1.

    Returns:
        The report.
    """
    sides = {"Left": replay.left, "Right": replay.right}
    figures = {
        "3_static_friction": ("torque that holds the ankle, reached from below and from above", _draw_static_friction),
        "4_stiffness": ("ankle torque over ankle angle where gravity is the same", _draw_stiffness),
        "5_inertia": ("ankle torque in proportion to the knee's acceleration", _draw_inertia),
        "6_kinetic_friction": ("ankle friction over velocity", _draw_kinetic_friction),
        "7_validation": ("measured and predicted torque of the validation motion", _draw_validation),
    }
    return ReplayReport(
        title=f"BLEEX, document 1 replayed (seed {replay.seed})",
        about="The experiments of document 1 on a virtual rig with known parameters, identified by its procedure and "
        "by one joint estimate.",
        findings=[_findings(name, side) for name, side in sides.items()],
        tables=[table for name, side in sides.items() for table in _tables(name, side)],
        data={"left": _side_json(replay.left), "right": _side_json(replay.right), "seed": replay.seed},
        drawings={
            f"doc1_fig{name}": Drawing(
                f"Fig. {name[0]}, left leg: {caption}", partial(draw, side=replay.left), 1.4 if name[0] == "7" else 0.7
            )
            for name, (caption, draw) in figures.items()
        },
    )


def _findings(title: str, side: SideReplay) -> list[str]:
    """Compare CAD and both estimates, and explain the errors of document 1's procedure."""
    truth, sequential = side.truth, side.sequential.as_dict()
    one_sided, coarse = side.one_sided.as_dict(), side.coarse.as_dict()
    change = {name: one_sided[name] - sequential[name] for name in ("b0_knee", "b0_ankle")}

    def error(values: Mapping[str, float], name: str) -> str:
        """Relative error of a parameter in percent."""
        return f"{100.0 * (values[name] / truth[name] - 1.0):+.0f} %"

    return [
        f"{title} leg. On the validation motion the NRMSE (hip / knee / ankle) is {joint_errors(side.nrmse['cad'])} "
        f"with CAD, {joint_errors(side.nrmse['sequential'])} by the document's procedure, and "
        f"{joint_errors(side.nrmse['joint'])} by one joint estimate.",
        f"J3 {error(sequential, 'J3')}: the held ankle sticks, and static friction balances the inertial torque.",
        f"X1 {error(sequential, 'X1')}: the hip has stiffness, but the document takes it as zero.",
        f"Without averaging A⁺ and A⁻, b0 of knee and ankle change by {change['b0_knee']:+.2f} and "
        f"{change['b0_ankle']:+.2f} N·m: they absorb the friction.",
        "With 2¹² counts a turn, the noise of second differences shrinks "
        f"J1 ({error(coarse, 'J1')}) and J2 ({error(coarse, 'J2')}).",
        f"Hip stiffness is not identifiable upright: condition number {side.upright_condition:.0f}, "
        f"with torso tilts {side.joint.condition_number:.0f}.",
    ]


def _tables(title: str, side: SideReplay) -> tuple[DataTable, DataTable]:
    """Torque errors on the validation motion; parameters of Tables I to V, whose hip resistances are taken as zero."""
    known = side.sequential.names
    rows = [
        (
            name,
            side.joint[name].unit,
            f"{true:.4g}",
            *(estimate_cells(side.sequential, name, true) if name in known else ("0", "–", f"{-true:+.3g}")),
            *estimate_cells(side.joint, name, true),
            f"{side.cad[name]:.4g}" if name in side.cad else "–",
        )
        for name, true in side.truth.items()
    ]
    compared = (header for name in ("sequential", "joint") for header in (LABELS.get(name, name), "± std", "error"))
    headers = ("parameter", "unit", "truth", *compared, LABELS["cad"])
    caption = f"{title} leg, Tables I to V: truth of the rig, the document's sequential estimate, one joint estimate"
    motion = f"the validation motion (Fig. 7), {title.lower()} leg"
    return errors_table(motion, side.nrmse, JOINTS), DataTable(caption, headers, rows)


def _side_json(side: SideReplay) -> dict[str, Any]:
    return {
        "truth": dict(side.truth),
        "sequential": estimate_json(side.sequential),
        "joint": estimate_json(side.joint, "condition_number"),
        "cad": dict(side.cad),
        "nrmse": json_value(side.nrmse),
        "one_sided": estimate_json(side.one_sided),
        "coarse_encoder": estimate_json(side.coarse),
        "upright_condition_number": side.upright_condition,
    }


def _draw_static_friction(figure: Figure, side: SideReplay) -> None:
    """First set of ankle poses, with constant θ123."""
    count = int((side.data.sets.ankle_set == 0).sum())
    both = Approaches(*(poses.take(slice(count)) for poses in (side.data.upright.below, side.data.upright.above)))
    plot_approaches(figure.add_subplot(), both, ANKLE, "ankle")


def _draw_stiffness(figure: Figure, side: SideReplay) -> None:
    sets = side.data.sets
    totals = [np.rad2deg(sets.ankle[sets.ankle_set == k].sum(axis=1)[0]) for k in np.unique(sets.ankle_set)]
    ankle = side.data.upright.averaged.take(slice(len(sets.ankle)))
    plot_stiffness(figure.add_subplot(), ankle, sets.ankle_set, np.array(totals), ANKLE, "ankle")


def _draw_inertia(figure: Figure, side: SideReplay) -> None:
    """Both sides of doc. 1, eq. (29): ankle torque proportional to the knee acceleration, and measured torque."""
    model, recording = document_model(side.leg), side.data.swings[KNEE][2].resampled()  # at 0.6 Hz
    values = np.array([side.sequential.as_dict().get(name, 0.0) for name in model.names])
    values[model.names.index("c0_ankle")] = 0.0  # neglected as in the step for J3
    q, v, a, valid = FiniteDifference().kinematics(recording)
    still = (model.regressor(q, v, np.zeros_like(a)) @ values)[valid, ANKLE]
    inertial = (model.regressor(q, v, a) @ values)[valid, ANKLE] - still
    time = recording.time[valid] - recording.time[valid][0]
    shown = time < 0.5 * SHOWN
    measured = np.asarray(recording.tau)[valid, ANKLE] - still
    fitted = [(f"{LABELS['sequential']} estimate", inertial[shown, np.newaxis], PREDICTED)]
    plot_torques([figure.add_subplot()], time[shown], measured[shown, np.newaxis], fitted, ["inertial ankle"])


def _draw_kinetic_friction(figure: Figure, side: SideReplay) -> None:
    """Doc. 1, eq. (33) with the opposite sign, without samples near the reversals."""
    values = side.sequential.as_dict()
    recordings = [side.data.swings[ANKLE][2]]  # at 0.6 Hz
    rows = rows_in_motion(document_model(side.leg), recordings, ANKLE, FiniteDifference())
    rows = rows.where(np.abs(rows.v) > MIN_SPEED)
    friction = rows.tau - rows.explained(values, without=("c0_ankle",))
    plot_friction_fit(figure.add_subplot(), rows.v, friction, values["c0_ankle"] * np.sign(rows.v), "ankle")


def _draw_validation(figure: Figure, side: SideReplay) -> None:
    model = side.joint.model
    rows = validation_rows(model, side.data.validation)
    shown = rows.time - rows.time[0] < SHOWN
    joint = named(model.names, side.joint.values)
    predictions = [
        (name, predicted_torque(model, values, rows)[shown], colour)
        for name, values, colour in ((LABELS["cad"], side.cad, CAD), ("joint estimate", joint, IDENTIFIED))
    ]
    axes = figure.subplots(3, 1, sharex=True)
    plot_torques(axes, rows.time[shown] - rows.time[0], rows.tau[shown], predictions, JOINTS)
