"""Report of what a wearer feels: what limits the amplification, and the felt torque of each model."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from exoid.tools.json_values import attributes, named
from exoid.tools.tables import DataTable
from exoid.view.colours import CAD, IDENTIFIED, MEASURED, RESIDUAL
from exoid.view.style import COLUMN, decorate_column

from .report import LABELS, Drawing, ReplayReport
from .wear_study import MARGIN, WearStudy

COLOURS = {"off": RESIDUAL, "cad": CAD, "identified": IDENTIFIED, "truth": MEASURED}
"""Colour of each model."""


def wear_report(study: WearStudy) -> ReplayReport:
    """Report the study: notes, a table of the felt torque, and the felt torque over a stride.

    Args:
        study: The study.

    Returns:
        The report.
    """
    height = (0.4 + 1.3 * len(study.joint_names)) / COLUMN
    caption = "Torque of the wearer on the leg over one stride"
    drawing = Drawing(caption, lambda figure: _draw_torque(figure, study), height, width=2.0)
    return ReplayReport(
        title=f"What the wearer of {study.name} feels (seed {study.seed})",
        about="",
        findings=[_findings(study)],
        tables=[_table(study)],
        data={
            "felt_rms": {name: each.rms_of_all for name, each in study.felt.items()},
            "felt_rms_by_joint": {name: named(study.joint_names, each.rms) for name, each in study.felt.items()},
            "floor_rms": study.floor_of_all,
            "amplification": {name: each.amplification for name, each in study.felt.items() if name != "off"},
            "largest_amplification": {name: min(each.largest, each.most) for name, each in study.largest.items()},
            "largest_tried": study.largest["identified"].most,
            **attributes(study, "period", "seed"),
        },
        drawings={"felt_torque": drawing},
    )


def _table(study: WearStudy) -> DataTable:
    """Felt torque, one line a model."""
    rows = []
    for name, felt in study.felt.items():
        largest, stable = study.largest.get(name), ""
        if largest is not None:
            stable = f"{largest.largest:.3g}" if np.isfinite(largest.largest) else f"above {largest.most:g}"
        amplification = "" if felt.amplification is None else f"{felt.amplification:.3g}"
        torques = (f"{x:.3g}" for x in (*felt.rms, felt.rms_of_all))
        rows.append((LABELS.get(name, name), stable, amplification, *torques))
    headers = ("controller knows", "largest α", "α used", *(f"{each} [N·m]" for each in (*study.joint_names, "all")))
    title = f"RMS torque between wearer and {study.name}, stride of {study.period:g} s; largest stable α"
    return DataTable(title, headers, rows)


def _findings(study: WearStudy) -> list[str]:
    """Say what the table means."""
    felt = {name: each.rms_of_all for name, each in study.felt.items()}
    used = max(each.amplification for each in study.felt.values() if each.amplification is not None)
    notes = [
        f"The identified model leaves {100.0 * felt['identified'] / felt['cad']:.0f} % of what is felt with CAD, and "
        f"{felt['identified'] / felt['truth']:.2f} times what is felt with the true model.",
        f"1/α of inertia and friction alone are {study.floor_of_all:.3g} N·m, without lag, noise and model error: "
        f"{100.0 * study.floor_of_all / felt['cad']:.0f} % of what is felt with CAD.",
        f"α is {MARGIN:g} of the largest stable one, at most {used:.3g}; 95 % of the distribution of the identified "
        "model are stable.",
    ]
    identified = study.largest["identified"]
    if np.isinf(identified.largest):
        notes.append(f"Nothing limits that of the identified model up to {identified.most:g}.")
    return notes


def _draw_torque(figure: Figure, study: WearStudy) -> None:
    """Draw the felt torque of each model over the last stride, one axes a joint."""
    axes = figure.subplots(len(study.joint_names), 1, sharex=True, squeeze=False)[:, 0]
    for name, felt in study.felt.items():
        run, exact, label = felt.run, name == "truth", LABELS.get(name, name)
        assert run.interaction is not None
        last = run.time >= run.time[-1] - study.period
        style: dict[str, Any] = {"color": COLOURS[name], "lw": 2.0 if exact else 1.0, "zorder": 1 if exact else 2}
        if felt.amplification is not None:
            label = f"{label}, α = {felt.amplification:.3g}"
        for ax, torque in zip(axes, run.interaction[last].T, strict=True):
            ax.plot(run.time[last] - run.time[last][0], torque, label=label, **style)
    decorate_column(list(axes), [f"{joint}\ntorque [N·m]" for joint in study.joint_names], columns=4)
    axes[-1].set_xlabel("time in the stride [s]")
